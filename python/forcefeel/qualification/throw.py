"""The throw of a control to either side, and its source."""

from dataclasses import dataclass
from math import isfinite, radians
from typing import Annotated

from forcefeel.errors import InputError
from forcefeel.loader.loader import Loader
from forcefeel.qualification import Rules
from forcefeel.units import ANGLE, UnitSystem, show, to_text

USUAL_RAD = radians(20.0)
"""Default throw to either side: slightly above the 18 deg to which the report's largest force, 96 lb at the grip, moves the
elevator's spring."""

_LARGEST_RAD = radians(90.0)


@dataclass(frozen=True)
class Throw:
    """Ends of a control's travel.

    Attributes:
        low_rad, high_rad: Ends to either side of neutral, below and above 0.
        source: Source of the ends.
    """

    low_rad: Annotated[float, ANGLE]
    high_rad: Annotated[float, ANGLE]
    source: str

    def __post_init__(self) -> None:
        ends = self.low_rad, self.high_rad
        if not (all(map(isfinite, ends)) and -_LARGEST_RAD <= self.low_rad < 0 < self.high_rad <= _LARGEST_RAD):
            came = " to ".join(f"{to_text(ANGLE.from_si(end, UnitSystem.SI))}" for end in ends)
            raise InputError(f"throw: expected ends to either side of neutral, up to 90 deg from it, got {came} deg")

    @classmethod
    def of(cls, loader: Loader, given_rad: float | None = None) -> "Throw":
        """The stated throw, else the loader's end stops, else its feel's hard stops, else the default.

        Raises:
            InputError: If an end is at or beyond neutral, or more than 90 deg from it.
        """
        if given_rad is not None:
            if not (isfinite(given_rad) and given_rad > 0):
                raise InputError(f"throw: expected an angle above 0, got {show(given_rad)} rad")
            return cls(-given_rad, given_rad, "as requested")
        for part, name in (("column.stop", "the end stops of the column"), ("feel.hard_stop", "the feel's hard stops")):
            low, high = loader[f"{part}_low"], loader[f"{part}_high"]
            if isfinite(low) and isfinite(high):
                return cls(low, high, name)
        return cls(-USUAL_RAD, USUAL_RAD, "assumed, because the loader has no stops and no throw is stated")

    @property
    def travel_rad(self) -> float:
        """Travel from end to end."""
        return self.high_rad - self.low_rad

    def end(self, sign: int) -> float:
        """The end above (+1) or below (-1) neutral."""
        return self.high_rad if sign > 0 else self.low_rad

    def release_rad(self, rules: Rules) -> float:
        """Angle of a release: the rule's largest share of the shorter side."""
        return rules.release.deflection[1] * min(self.high_rad, -self.low_rad)
