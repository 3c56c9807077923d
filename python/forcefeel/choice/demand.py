"""What releases ask of the valve: peak current, flow and load pressure as shares of their limits."""

from dataclasses import dataclass
from math import ceil, pi
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from forcefeel.laws.law import Law
from forcefeel.loader.loader import FEEL_SETTING, Loader
from forcefeel.simulation import Scenario, simulate_batch
from forcefeel.simulation.inputs import Release
from forcefeel.units import PERCENT

_PERIODS = 2
"""Programmed periods of a run: the column, let go, is fastest in the first."""

_SAMPLE_S = 1e-3
_PEAKS = ("peak_current_a", "peak_flow_m3_per_s", "peak_pressure_pa")


@dataclass(frozen=True)
class Demand:
    """Largest demand on the valve, as shares of what it has; not numbers where no run ends.

    Attributes:
        current: Of the amplifier's limit; of the valve's rated current where there is none.
        flow: Of the spool's limit at no load; of the rated flow where there is none.
        pressure: Load pressure, of the supply's.
    """

    current: Annotated[float, PERCENT]
    flow: Annotated[float, PERCENT]
    pressure: Annotated[float, PERCENT]


def largest_demand(loader: Loader, laws: Law, feel: NDArray[np.float64], angle_rad: float) -> Demand:
    """The largest peaks over releases at settings I, B, G, a row each, of equal natural frequency.

    Args:
        loader: The loader.
        laws: The law of each setting, stable.
        feel: I, B, G.
        angle_rad: Where the grip is let go.
    """
    slowest = 2 * pi * float(np.sqrt(feel[:, 0] / feel[:, 2]).max())
    duration = ceil(_PERIODS * slowest / _SAMPLE_S) * _SAMPLE_S
    scenario = Scenario(Release(angle_rad), duration, sample_s=_SAMPLE_S)
    runs = simulate_batch(loader, scenario, loader.rows(FEEL_SETTING, feel), laws)
    peaks = np.array([runs[name].values for name in _PEAKS])
    known = np.isfinite(peaks).all(axis=0)
    shares = peaks[:, known] / limits(loader)[:, None]
    return Demand(*shares.max(axis=1).tolist()) if known.any() else Demand(np.nan, np.nan, np.nan)


def of_all(found: list[Demand]) -> Demand:
    """The largest of several; not numbers where there are none."""
    shares = np.array([[one.current, one.flow, one.pressure] for one in found])
    known = np.isfinite(shares).all(axis=1) if len(found) else np.zeros(0, dtype=bool)
    return Demand(*shares[known].max(axis=0).tolist()) if known.any() else Demand(np.nan, np.nan, np.nan)


def limits(loader: Loader) -> NDArray[np.float64]:
    """Largest current in A, flow in m^3/s and load pressure in Pa that a loader has."""
    pairs = (
        ("amplifier.current_limit", "valve.rated_current"),
        ("valve.flow_limit", "valve.rated_flow"),
    )
    first = [loader[limit] if np.isfinite(loader[limit]) else loader[rated] for limit, rated in pairs]
    return np.array([*first, loader["valve.supply_pressure"]])
