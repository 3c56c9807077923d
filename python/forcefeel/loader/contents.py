"""What a loader file holds, and what of it does not go together."""

from collections.abc import Mapping
from dataclasses import dataclass

from forcefeel.errors import InputError
from forcefeel.loader import consistency
from forcefeel.loader.bus import Bus, check_drive
from forcefeel.loader.curves import Curve
from forcefeel.loader.parameters import ELECTRIC, HYDRAULIC
from forcefeel.loader.tolerances import Tolerance
from forcefeel.loader.tolerances import check as check_tolerances
from forcefeel.printable import unprintable


@dataclass(frozen=True)
class Contents:
    """What a loader file holds.

    Attributes:
        name, source: Of the loader.
        values: SI values by ``part.name``, of the rows that its drive has.
        curves: Curves by name, SI units.
        tolerances: Tolerances by ``part.name``, SI units.
        bus: Where its drive is, if it says.
    """

    name: str
    source: str
    values: Mapping[str, float]
    curves: Mapping[str, Curve]
    tolerances: Mapping[str, Tolerance]
    bus: Bus | None = None

    @property
    def drive(self) -> str:
        """What moves the linkage."""
        return ELECTRIC if "motor.torque_constant" in self.values else HYDRAULIC


def misfits(contents: Contents) -> list[str]:
    """A line for each thing that is good by itself, but does not go with the rest."""
    return [
        *_unprintable(contents),
        *consistency.complaints(contents.values),
        *check_tolerances(contents.tolerances, contents.values),
        *_for_another_drive(contents),
    ]


def _for_another_drive(contents: Contents) -> list[str]:
    """A line where the bus is for another drive."""
    try:
        if contents.bus is not None:
            check_drive(contents.bus.kind, contents.drive)
    except InputError as error:
        return [f"bus: {error}"]
    return []


def _unprintable(contents: Contents) -> list[str]:
    """A line for a name or a source that would steer a terminal."""
    characters = (
        (key, unprintable(getattr(contents, key), allowed)) for key, allowed in (("name", ""), ("source", "\n\t"))
    )
    return [
        f"{key}: has the control character U+{ord(c):04X}; expected text that prints; take it out"
        for key, c in characters
        if c
    ]
