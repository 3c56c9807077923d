"""Demand of releases on the drive: peak current, flow and load pressure, or current and voltage, as shares of their limits."""

from dataclasses import dataclass, fields
from math import ceil, nan, pi
from types import MappingProxyType
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from forcefeel.laws.law import Law
from forcefeel.loader.loader import FEEL_SETTING, Loader
from forcefeel.loader.parameters import ELECTRIC, HYDRAULIC
from forcefeel.simulation import Scenario
from forcefeel.simulation.demanded import peaks
from forcefeel.simulation.engine import batch_outputs
from forcefeel.simulation.inputs import Release
from forcefeel.units import PERCENT

_PERIODS = 2
"""Duration of a run in programmed periods: a released column is fastest in the first."""

_SAMPLE_S = 1e-3


@dataclass(frozen=True)
class Demand:
    """Largest demand on the valve, as shares of its limits; NaN if all runs diverge.

    Attributes:
        current: Share of the amplifier's limit; without a limit, of the valve's rated current.
        flow: Share of the spool's limit at no load; without a limit, of the rated flow.
        pressure: Load pressure as a share of the supply pressure.
    """

    current: Annotated[float, PERCENT]
    flow: Annotated[float, PERCENT]
    pressure: Annotated[float, PERCENT]


@dataclass(frozen=True)
class MotorDemand:
    """Largest demand on the motor, as shares of its limits; zero without a limit.

    Attributes:
        current: Share of the amplifier's limit.
        voltage: Share of the supply voltage.
    """

    current: Annotated[float, PERCENT]
    voltage: Annotated[float, PERCENT]


AnyDemand = Demand | MotorDemand
"""Demand on either drive."""

KINDS = MappingProxyType({HYDRAULIC: Demand, ELECTRIC: MotorDemand})
"""Demand type by drive; its fields are the shares of ``demanded.peaks``, in the same order."""


def unknown(drive: str) -> AnyDemand:
    """Demand if all runs diverge: NaN."""
    demand: AnyDemand = KINDS[drive](*(nan for _ in peaks(drive)))
    return demand


def demand_shares(demand: AnyDemand) -> dict[str, float]:
    """The shares by name: ``current``, ``flow``, ..."""
    return {row.name: getattr(demand, row.name) for row in fields(demand)}


def largest_demand(loader: Loader, laws: Law, feel: NDArray[np.float64], angle_rad: float) -> AnyDemand:
    """Largest peaks over releases at settings of similar natural frequency.

    Args:
        loader: The loader.
        laws: Stable law of each setting.
        feel: I, B, G in SI units, (settings, 3).
        angle_rad: Release angle.
    """
    slowest = 2 * pi * float(np.sqrt(feel[:, 0] / feel[:, 2]).max())
    duration = ceil(_PERIODS * slowest / _SAMPLE_S) * _SAMPLE_S
    scenario = Scenario(Release(angle_rad), duration, sample_s=_SAMPLE_S)
    runs = batch_outputs(loader, scenario, loader.rows(FEEL_SETTING, feel), laws)
    currents = np.array([runs[row.peak] for row in peaks(loader.drive)])
    known = np.isfinite(currents).all(axis=0)
    of_limits = currents[:, known] / limits(loader)[:, None]
    return KINDS[loader.drive](*of_limits.max(axis=1).tolist()) if known.any() else unknown(loader.drive)


def of_all(demands: list[AnyDemand], drive: str = HYDRAULIC) -> AnyDemand:
    """Largest of several demands on a drive; NaN for an empty list."""
    table = np.array([list(demand_shares(demand).values()) for demand in demands])
    known = np.isfinite(table).all(axis=1) if len(demands) else np.zeros(0, dtype=bool)
    return KINDS[drive](*table[known].max(axis=0).tolist()) if known.any() else unknown(drive)


def limits(loader: Loader) -> NDArray[np.float64]:
    """Limits of a loader for ``demanded.peaks``, in SI units."""
    return np.array([row.most(loader) for row in peaks(loader.drive)])
