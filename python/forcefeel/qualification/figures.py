"""A measured figure and how well it is known."""

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Figure:
    """A figure with its standard uncertainty.

    Attributes:
        value: The figure, in ``unit``; not a number if there is none.
        uncertainty: Its standard uncertainty (one standard deviation), in ``unit``.
        unit: SI unit; empty for a number.
    """

    value: float
    uncertainty: float
    unit: str

    @property
    def known(self) -> bool:
        """Whether there is a figure."""
        return math.isfinite(self.value)

    def less(self, other: "Figure") -> "Figure":
        """The difference of two figures that are known independently of each other."""
        return Figure(self.value - other.value, math.hypot(self.uncertainty, other.uncertainty), self.unit)


def combined(*parts: float) -> float:
    """Standard uncertainty of a sum of parts that are independent of each other; what is not known adds nothing."""
    return math.hypot(*(part for part in parts if math.isfinite(part)))
