"""Curves of the feel: points, joined by a monotone piecewise cubic (PCHIP, Fritsch and Carlson 1980)."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike, NDArray

from forcefeel.errors import InputError
from forcefeel.units import ANGLE, FORCE, RATIO, Json, Unit, UnitSystem, show, to_text

MOST_POINTS = 32
"""Most points of a curve: what the Rust engine holds."""

_ROUNDING = 1e-9
"""Relative; a limit typed with ten digits is still the limit."""

_CLOSEST = 1e-6
"""Share of the largest x that neighboring points are apart at least; a file's ten digits keep them apart."""


@dataclass(frozen=True)
class Curve:
    """A curve through points that rises or stays level, and never overshoots between them.

    Attributes:
        x: Where the points are, rising from point to point; 2 to ``MOST_POINTS``.
        y: The curve there, never falling from point to point; as many.

    In a loader both are in SI units.

    Raises:
        InputError: If the numbers of points differ, there are too few or too many, one is not finite, x does not rise or
            y falls; it names the first pair of points that is wrong.

    Example:
        >>> from dataclasses import replace
        >>> curve = ff.loader.Curve((-0.3, 0.0, 0.3), (-200.0, 0.0, 250.0))  # rad, N
        >>> replace(ff.elevator(), force_curve=curve).force_curve is curve
        True
    """

    x: tuple[float, ...]
    y: tuple[float, ...]

    def __post_init__(self) -> None:
        for name in ("x", "y"):
            object.__setattr__(self, name, _numbers(name, getattr(self, name)))
        if len(self.x) != len(self.y):
            raise InputError(f"expected as many y as x, got {len(self.x)} x and {len(self.y)} y")
        if not 2 <= len(self.x) <= MOST_POINTS:
            raise InputError(f"expected 2 to {MOST_POINTS} points, got {len(self.x)}")
        apart = _CLOSEST * max(map(abs, self.x))
        for k in range(1, len(self.x)):
            if self.x[k] <= self.x[k - 1]:
                raise InputError(f"expected x to rise from point to point, got {self._pair(k)}")
            if self.x[k] - self.x[k - 1] < apart:
                raise InputError(f"expected points at least a millionth of the largest x apart, got {self._pair(k)}")
            if self.y[k] < self.y[k - 1]:
                raise InputError(f"expected y never to fall from point to point, got {self._pair(k)}")
        try:
            finite = np.all(np.isfinite(self.coefficients))
        except ValueError:  # a slope already is not
            finite = np.False_
        if not finite:
            raise InputError("expected numbers that a cubic can be put through, got numbers too large or too small")

    def _pair(self, k: int) -> str:
        first, other = (f"point {j + 1} [{self.x[j]:.10g}, {self.y[j]:.10g}]" for j in (k - 1, k))
        return f"{first} and {other}"

    @cached_property
    def coefficients(self) -> NDArray[np.float64]:
        """Rows ``c`` of the pieces between the points: y = ((c_0 u + c_1) u + c_2) u + c_3, u = x - x_j; read-only."""
        pieces = pieces_through(self.x, self.y)
        pieces.setflags(write=False)
        return pieces

    @property
    def arrays(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """X and coefficients, as the engine takes a curve."""
        return np.array(self.x), self.coefficients

    @cached_property
    def end_slopes(self) -> tuple[float, float]:
        """Slopes at the first and the last point, with which ``at`` goes on beyond them."""
        (_, _, first, _), (a, b, c, _) = self.coefficients[0].tolist(), self.coefficients[-1].tolist()
        u = self.x[-1] - self.x[-2]
        return first, (3 * a * u + 2 * b) * u + c

    def at(self, x: ArrayLike) -> NDArray[np.float64]:
        """The curve at ``x``, straight beyond its ends with the slope that it has there; shape as ``x``."""
        at = np.asarray(x, dtype=np.float64)
        low, high = self.end_slopes
        return self.held(at) + low * np.minimum(at - self.x[0], 0.0) + high * np.maximum(at - self.x[-1], 0.0)

    def held(self, x: ArrayLike) -> NDArray[np.float64]:
        """The curve at ``x``, beyond its ends as at the nearest end; shape as ``x``."""
        at = np.clip(np.asarray(x, dtype=np.float64), self.x[0], self.x[-1])
        piece = np.clip(np.searchsorted(self.x, at, side="right") - 1, 0, len(self.x) - 2)
        c, u = np.moveaxis(self.coefficients[piece], -1, 0), at - np.asarray(self.x)[piece]
        return np.asarray(np.clip(((c[0] * u + c[1]) * u + c[2]) * u + c[3], self.y[0], self.y[-1]))


def pieces_through(x: ArrayLike, y: ArrayLike) -> NDArray[np.float64]:
    """Rows of coefficients of the pieces between points, unchecked; as ``Curve.coefficients``.

    Cubics whose slope at a point is the weighted harmonic mean of the chords' beside it, and zero where these differ in sign: they
    rise and fall with the points.

    Source: F. N. Fritsch and J. Butland, A method for constructing local monotone piecewise cubic interpolants, SIAM J. Sci. Stat.
    Comput. 5 (1984); at the ends the three-point formula of C. Moler, Numerical Computing with MATLAB, 2004, section 3.4.
    """
    at, heights = np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64)
    with np.errstate(all="ignore"):
        h = np.diff(at)
        chord = np.diff(heights) / h
        slope = np.empty_like(at)
        slope[0], slope[-1] = _end_slope(h, chord), _end_slope(h[::-1], chord[::-1])
        before, after = 2 * h[1:] + h[:-1], h[1:] + 2 * h[:-1]
        mean = 1.0 / ((before / chord[:-1] + after / chord[1:]) / (before + after))
        slope[1:-1] = np.where(np.sign(chord[:-1]) * np.sign(chord[1:]) > 0, mean, 0.0)
        third = (slope[:-1] + slope[1:] - 2 * chord) / h
        second = (chord - slope[:-1]) / h - third
        return np.ascontiguousarray(np.transpose([third / h, second, slope[:-1], heights[:-1]]))


def _end_slope(h: NDArray[np.float64], chord: NDArray[np.float64]) -> float:
    """Slope at the first point: of a parabola through three, no steeper than the curve stays monotone with."""
    if len(h) == 1:
        return float(chord[0])
    slope = float(((2 * h[0] + h[1]) * chord[0] - h[0] * chord[1]) / (h[0] + h[1]))
    if np.sign(slope) != np.sign(chord[0]):
        return 0.0
    if np.sign(chord[0]) != np.sign(chord[1]) and abs(slope) > 3 * abs(chord[0]):
        return float(3 * chord[0])
    return slope


def _numbers(name: str, given: object) -> tuple[float, ...]:
    try:
        numbers = tuple(float(number) for number in given)  # type: ignore[attr-defined]
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(f"expected {name} to be numbers, got {show(given)}") from error
    for k, number in enumerate(numbers):
        if not np.isfinite(number):
            raise InputError(f"expected finite {name}, got {number} at point {k + 1}")
    return tuple(number + 0.0 for number in numbers)  # minus zero is zero


@dataclass(frozen=True)
class Axis:
    """What x or y of a curve measures.

    Attributes:
        name: In words.
        unit: Its units.
        low, high: Smallest and largest accepted value, in U.S. customary units.
    """

    name: str
    unit: Unit
    low: float
    high: float

    def complaint(self, value: float) -> str | None:
        """What is wrong with ``value`` in SI units; nothing if it is in range."""
        came = self.unit.from_si(value, UnitSystem.US)
        slack = _ROUNDING * abs(came)
        if self.low - slack <= came <= self.high + slack and (came >= 0 or self.low < 0):
            return None
        low, high = to_text(self.low, 10), to_text(self.high, 10)
        unit = f" {self.unit.us}".rstrip()
        return f"{self.name} out of range: expected {low} to {high}{unit}, got {came:.10g}{unit}"


@dataclass(frozen=True)
class CurveRow:
    """A curve that a loader may have.

    Attributes:
        name: Its attribute of a loader, and its table of the loader file's part ``feel``.
        meaning: What it is.
        x, y: What its axes measure.
        example: Points of a good one, in U.S. customary units.
    """

    name: str
    meaning: str
    x: Axis
    y: Axis
    example: tuple[tuple[float, float], ...]

    @property
    def key(self) -> str:
        """``part.name``, as the rows of the parameter table."""
        return f"feel.{self.name}"

    def units(self, system: UnitSystem) -> tuple[str, str]:
        """The units that people read."""
        return self.x.unit.shown(system), self.y.unit.shown(system)

    def as_json(self, curve: Curve, system: UnitSystem) -> dict[str, Json]:
        """The points of a curve, with the units of its axes."""
        axes = zip((self.x.unit, self.y.unit), (curve.x, curve.y), strict=True)
        columns = [[measured_in.from_si(value, system) for value in values] for measured_in, values in axes]
        return {"units": list(self.units(system)), "points": [list(point) for point in zip(*columns, strict=True)]}


_DYNAMIC_PRESSURE = Unit("Pa", "Pa", "lb/ft^2")

CURVES: Mapping[str, CurveRow] = MappingProxyType(
    {
        "force_curve": CurveRow(
            "force_curve",
            "force at the grip over angle, in place of the stiffness; straight beyond its ends",
            Axis("angle", ANGLE, -180.0, 180.0),
            Axis("force", FORCE, -1e4, 1e4),
            ((-20, -60), (-5, -20), (0, 0), (5, 18), (20, 75)),
        ),
        "stiffness_factor": CurveRow(
            "stiffness_factor",
            "factor on the spring over dynamic pressure (q-feel); beyond its ends as at the nearest end",
            Axis("dynamic pressure", _DYNAMIC_PRESSURE, 0.0, 1e5),
            Axis("factor", RATIO, 1e-3, 1e3),
            ((0, 0.4), (100, 1.0), (300, 2.2)),
        ),
    }
)
"""The curves that a loader may have."""


def check(row: CurveRow, curve: object) -> None:
    """Refuses what is no curve, or one beyond the limits of its axes.

    Raises:
        InputError: Naming the limits and the value; without the curve's name.
    """
    if not isinstance(curve, Curve):
        raise InputError(f"expected a Curve, got {show(curve)}")
    for axis, values in ((row.x, curve.x), (row.y, curve.y)):
        for value in values:
            if wrong := axis.complaint(value):
                raise InputError(wrong)
