"""What a run asks of the drive: which outputs, and what is all that there is of each."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import isfinite
from types import MappingProxyType

from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ELECTRIC, HYDRAULIC


@dataclass(frozen=True)
class Demanded:
    """One quantity of a drive.

    Attributes:
        output: Its name in a history.
        peak: The measure that is its largest magnitude; empty where there is none.
        title: What it is called.
        whole: Row of the loader that is all there is of it.
        whole_name: In words, with its article: ``the rated flow``.
        limit: Row of a limit that the drive keeps by itself.
        limit_name: In words.
        ends: Whether the limit, where there is one, is the end of it: a relief opens in time, and is none.
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
        """Whether the loader says how much there is."""
        return isfinite(loader[self.whole])

    def most(self, loader: Loader) -> float:
        """The largest that a run can ask for: the limit, or all there is where that is none; may be infinite."""
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
"""The quantities of each drive that have an end."""


def peaks(drive: str) -> tuple[Demanded, ...]:
    """Those of a drive that have a largest magnitude among the measures of a run."""
    return tuple(row for row in DEMANDED[drive] if row.peak)


def demanded(loader: Loader) -> tuple[Demanded, ...]:
    """Those of a loader's drive of which it says how much there is."""
    return tuple(row for row in DEMANDED[loader.drive] if row.known(loader))
