"""Demands of a run on the drive: outputs, ratings and limits."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import isfinite
from types import MappingProxyType

from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ELECTRIC, HYDRAULIC


@dataclass(frozen=True)
class Demanded:
    """One limited quantity of a drive.

    Attributes:
        output: Its name in a history.
        peak: The measure of its largest magnitude; empty if it has no such measure.
        title: Its title.
        whole: Row of the loader with its rating.
        whole_name: Name of the rating with its article: ``the rated flow``.
        limit: Row of the limit that the drive enforces.
        limit_name: Name of the limit.
        ends: Whether the limit cannot be exceeded; a relief valve opens with a delay, so its pressure can.
    """

    output: str
    peak: str
    title: str
    whole: str
    whole_name: str
    limit: str
    limit_name: str
    ends: bool = True

    def known(self, loader: Loader) -> bool:
        """Whether the loader states the rating."""
        return isfinite(loader[self.whole])

    def most(self, loader: Loader) -> float:
        """Largest possible value in a run: the limit, or else the rating; may be infinite."""
        limit = loader[self.limit]
        return limit if self.ends and isfinite(limit) else loader[self.whole]


DEMANDED: Mapping[str, tuple[Demanded, ...]] = MappingProxyType(
    {
        HYDRAULIC: (
            Demanded(
                "valve_current_a",
                "peak_current_a",
                "Current",
                "valve.rated_current",
                "the rated current",
                "amplifier.current_limit",
                "amplifier's limit",
            ),
            Demanded(
                "actuator_flow_m3_per_s",
                "peak_flow_m3_per_s",
                "Flow",
                "valve.rated_flow",
                "the rated flow",
                "valve.flow_limit",
                "spool's limit, no load",
            ),
            Demanded(
                "load_pressure_pa",
                "peak_pressure_pa",
                "Pressure",
                "valve.supply_pressure",
                "the supply pressure",
                "actuator.relief_pressure",
                "relief",
                ends=False,
            ),
        ),
        ELECTRIC: (
            Demanded(
                "motor_current_a",
                "peak_current_a",
                "Current",
                "current_loop.current_limit",
                "the largest current",
                "current_loop.current_limit",
                "amplifier's limit",
            ),
            Demanded(
                "motor_voltage_v",
                "peak_voltage_v",
                "Voltage",
                "current_loop.voltage_limit",
                "the largest voltage",
                "current_loop.voltage_limit",
                "supply",
            ),
            Demanded(
                "winding_temperature_degc",
                "",
                "Temperature",
                "thermal.winding_limit",
                "the winding's limit",
                "thermal.derating_from",
                "derating",
            ),
        ),
    }
)
"""The limited quantities of each drive."""


def peaks(drive: str) -> tuple[Demanded, ...]:
    """Limited quantities of a drive with a peak among the measures of a run."""
    return tuple(row for row in DEMANDED[drive] if row.peak)


def demanded(loader: Loader) -> tuple[Demanded, ...]:
    """Limited quantities of a loader's drive whose rating it states."""
    return tuple(row for row in DEMANDED[loader.drive] if row.known(loader))
