"""What a console shows of a flight, and which levers it moves."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

from forcefeel.units import AIRSPEED, ALTITUDE, ANGLE, LOAD_FACTOR, Unit

READINGS = {
    "calibrated_airspeed": ("airspeed", AIRSPEED),
    "altitude": ("altitude", ALTITUDE),
    "load_factor": ("load factor", LOAD_FACTOR),
    "pitch_attitude": ("pitch", ANGLE),
}
"""Quantities of a flight on the page: label, unit."""


@dataclass(frozen=True)
class Lever:
    """A lever or wheel of the aircraft beside the loader's control.

    Attributes:
        label: Displayed name.
        unit: Unit.
        low, high: Range in SI units.
    """

    label: str
    unit: Unit
    low: float
    high: float


class FlightControls(Protocol):
    """A flight beside a running loop; thread-safe."""

    levers: Mapping[str, Lever]

    def readings(self) -> dict[str, float]:
        """Quantities of ``READINGS`` and positions of the levers, SI units; ``refused``: 1 where the loader refused the flight."""
        ...

    def set_lever(self, name: str, position: float) -> None:
        """Move a lever.

        Raises:
            InputError: If the aircraft has no such lever, or the position is out of its range.
        """
        ...

    def restart(self) -> None:
        """Return to the trimmed flight."""
        ...
