"""What releases ask of the drive: peak current, flow and load pressure, or current and voltage, as shares of their limits."""

from dataclasses import dataclass, fields
from math import ceil, nan, pi
from types import MappingProxyType
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from forcefeel.laws.law import Law
from forcefeel.loader.loader import FEEL_SETTING, Loader
from forcefeel.loader.parameters import ELECTRIC, HYDRAULIC
from forcefeel.simulation import Scenario, simulate_batch
from forcefeel.simulation.demanded import peaks
from forcefeel.simulation.inputs import Release
from forcefeel.units import PERCENT

_PERIODS = 2
"""Programmed periods of a run: the column, let go, is fastest in the first."""

_SAMPLE_S = 1e-3


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


@dataclass(frozen=True)
class MotorDemand:
    """Largest demand on the motor, likewise; zero where there is no limit.

    Attributes:
        current: Of the amplifier's limit.
        voltage: Of the supply's.
    """

    current: Annotated[float, PERCENT]
    voltage: Annotated[float, PERCENT]


AnyDemand = Demand | MotorDemand
"""Of either drive."""

KINDS = MappingProxyType({HYDRAULIC: Demand, ELECTRIC: MotorDemand})
"""By drive; their shares are those of ``demanded.peaks``, in that order."""


def unknown(drive: str) -> AnyDemand:
    """The demand where no run ends: not numbers."""
    demand: AnyDemand = KINDS[drive](*(nan for _ in peaks(drive)))
    return demand


def demand_shares(demand: AnyDemand) -> dict[str, float]:
    """The shares by what they are of: ``current``, ``flow``, ..."""
    return {row.name: getattr(demand, row.name) for row in fields(demand)}


def largest_demand(loader: Loader, laws: Law, feel: NDArray[np.float64], angle_rad: float) -> AnyDemand:
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
    currents = np.array([runs[row.peak].values for row in peaks(loader.drive)])
    known = np.isfinite(currents).all(axis=0)
    of_limits = currents[:, known] / limits(loader)[:, None]
    return KINDS[loader.drive](*of_limits.max(axis=1).tolist()) if known.any() else unknown(loader.drive)


def of_all(demands: list[AnyDemand], drive: str = HYDRAULIC) -> AnyDemand:
    """The largest of several of a drive; not numbers where there are none."""
    table = np.array([list(demand_shares(demand).values()) for demand in demands])
    known = np.isfinite(table).all(axis=1) if len(demands) else np.zeros(0, dtype=bool)
    return KINDS[drive](*table[known].max(axis=0).tolist()) if known.any() else unknown(drive)


def limits(loader: Loader) -> NDArray[np.float64]:
    """The largest of each of ``demanded.peaks`` that a loader has, in SI units."""
    return np.array([row.most(loader) for row in peaks(loader.drive)])
