"""Axes of a flight schedule, such as dynamic pressure, trim or flaps."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from forcefeel.errors import InputError
from forcefeel.units import show, to_text

MOST_AXES = 3
"""Largest number of axes of a schedule."""

_NAME = re.compile(r"[A-Za-z][A-Za-z0-9]*(?:[ _][A-Za-z0-9]+)*")
_TAKEN = ("at_s", "fade_s")
"""Arguments of ``FlightSchedule.change``."""


@dataclass(frozen=True)
class ScheduleAxis:
    """One axis of a schedule.

    Attributes:
        name: Its name, such as ``dynamic pressure``; words of letters and digits.
        unit: Unit of its values as text, such as ``lb/ft^2``, displayed but not converted; empty for none.
        values: Values at the knots, rising; at least two.

    Raises:
        InputError: If the name has other characters, or there are fewer than two finite, rising values.

    Example:
        >>> ff.flight_schedule.ScheduleAxis("dynamic pressure", "lb/ft^2", (50, 100, 200)).values
        (50.0, 100.0, 200.0)
    """

    name: str
    unit: str
    values: tuple[float, ...]

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or not _NAME.fullmatch(self.name) or self.keyword in _TAKEN:
            raise InputError(f"axis: expected a name of words, such as 'dynamic pressure', got {show(self.name)}")
        if not isinstance(self.unit, str):
            raise InputError(f"{self.name}: expected its unit as text, such as 'deg', got {show(self.unit)}")
        try:
            values = tuple(map(float, self.values))
        except (TypeError, ValueError) as error:
            raise InputError(f"{self.name}: expected numbers, got {show(self.values)}") from error
        if len(values) < 2 or not np.isfinite(values).all() or (np.diff(values) <= 0).any():
            raise InputError(f"{self.name}: expected two or more finite values that rise, got {show(list(values))}")
        object.__setattr__(self, "values", values)

    @property
    def keyword(self) -> str:
        """The name as the keyword of ``FlightSchedule.at``: ``dynamic_pressure``."""
        return self.name.lower().replace(" ", "_")

    @property
    def title(self) -> str:
        """Name and unit: ``dynamic pressure (lb/ft^2)``."""
        return f"{self.name} ({self.unit})" if self.unit else self.name

    def text(self, value: float) -> str:
        """One value with name and unit: ``dynamic pressure 120 lb/ft^2``."""
        return f"{self.name} {to_text(value)} {self.unit}".rstrip()

    def refined(self, refine: int) -> NDArray[np.float64]:
        """The knots, with ``refine - 1`` evenly spaced values between two of them; the knots are exact."""
        values, shares = np.array(self.values), np.arange(refine) / refine
        between = values[:-1, None] + shares * np.diff(values)[:, None]
        return np.append(between.ravel(), values[-1])


def check_axes(axes: Sequence[ScheduleAxis]) -> tuple[ScheduleAxis, ...]:
    """Check that there are one to three axes with different names.

    Raises:
        InputError: If not.
    """
    checked = tuple(axes)
    if not all(isinstance(axis, ScheduleAxis) for axis in checked) or not 1 <= len(checked) <= MOST_AXES:
        raise InputError(f"axes: expected 1 to {MOST_AXES} of ScheduleAxis, got {show(list(checked))}")
    names = [axis.keyword for axis in checked]
    if len(set(names)) < len(names):
        raise InputError(f"axes: expected different names, got {', '.join(names)}; name each axis once")
    return checked


def mesh(values: Sequence[Sequence[float] | NDArray[np.float64]]) -> NDArray[np.float64]:
    """All points of a grid (points, axes); the last axis runs fastest."""
    return np.column_stack([axis.ravel() for axis in np.meshgrid(*values, indexing="ij")])


def point_of(axes: Sequence[ScheduleAxis], where: Mapping[str, float]) -> NDArray[np.float64]:
    """Point from keywords.

    Raises:
        InputError: If an axis is missing or unknown, or its value is not a number within the knots.
    """
    known = {axis.keyword: axis for axis in axes}
    if set(where) != set(known):
        expected = ", ".join(f"{name}=..." for name in known)
        raise InputError(f"where: expected {expected}, got {', '.join(where) or 'nothing'}")
    return np.array([_within(axis, where[name]) for name, axis in known.items()])


def _within(axis: ScheduleAxis, value: object) -> float:
    low, high = axis.values[0], axis.values[-1]
    if isinstance(value, bool) or not isinstance(value, int | float | np.number) or not low <= value <= high:
        ends = f"{to_text(low)} to {to_text(high)} {axis.unit}".rstrip()
        raise InputError(
            f"{axis.keyword}: expected a number within the knots, {ends}, got {show(value)}; a schedule is not extrapolated, "
            "so add a knot"
        )
    return float(value)


def place_text(axes: Sequence[ScheduleAxis], point: Sequence[float] | NDArray[np.float64]) -> str:
    """Text of a point: ``dynamic pressure 120 lb/ft^2, flaps 10 deg``."""
    return ", ".join(axis.text(value) for axis, value in zip(axes, point, strict=True))


def cells(axes: Sequence[ScheduleAxis]) -> Iterator[NDArray[np.float64]]:
    """Middles between neighboring knots along each axis."""
    for axis in axes:
        values = np.array(axis.values)
        yield (values[:-1] + values[1:]) / 2
