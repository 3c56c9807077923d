"""A measured figure and its uncertainty."""

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Figure:
    """A figure with its standard uncertainty.

    Attributes:
        value: The figure, in ``unit``; NaN if it could not be measured.
        uncertainty: Its standard uncertainty (one standard deviation), in ``unit``.
        unit: SI unit; empty for a number.
    """

    value: float
    uncertainty: float
    unit: str

    @property
    def known(self) -> bool:
        """Whether the figure was measured."""
        return math.isfinite(self.value)

    def less(self, other: "Figure") -> "Figure":
        """The difference of two independent figures."""
        return Figure(self.value - other.value, math.hypot(self.uncertainty, other.uncertainty), self.unit)


def combined(*parts: float) -> float:
    """Standard uncertainty of a sum of independent parts; parts that are not finite are omitted."""
    return math.hypot(*(part for part in parts if math.isfinite(part)))
