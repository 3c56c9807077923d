"""Shapes of a feel at rest: which rows of its table are fitted, and the feel that numbers for them give.

The engine computes the force (``_core.feel_held_along``); here numbers become rows.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel.loader.curves import Curve, pieces_through
from forcefeel.loader.parameters import INDEX

_Array = NDArray[np.float64]

STOPS = ("high", "low", "mirrored")
"""Sides on which a soft stop may be; ``mirrored`` is one of the same angle on either side."""

_ROWS = {
    "friction": ("feel.coulomb_friction", "force"),
    "breakout": ("feel.breakout", "force"),
    "preload": ("feel.preload", "force"),
    "deadband": ("feel.deadband", "angle"),
    "hysteresis": ("feel.hysteresis", "force"),
    "hysteresis travel": ("feel.hysteresis_travel", "angle"),
    "stop high": ("feel.soft_stop_high", "angle"),
    "stop low": ("feel.soft_stop_low", "angle"),
    "stop stiffness": ("feel.soft_stop_stiffness", "stiffness"),
}
"""Row of each unknown, and what it is a multiple of."""

_CUBIC_POINTS = 17
"""Points of the curve of a cubic; between them it differs by 0.1 % of the end's force at most."""

_NONE, _MOST = 1e-6, 20.0
"""Bounds of an unknown in its scale."""


@dataclass(frozen=True)
class Spring:
    """The spring: a straight line, an odd cubic, or a curve through knots.

    Attributes:
        knots: Knots on either side beside the neutral; 0 for a line or a cubic.
        mirrored: Whether both sides are the same.
        cubic: Whether it is the cubic ``s_0 x + (s_1 - s_0) x^3 / (3 x_end^2)``: slope ``s_0`` at neutral, ``s_1`` at the end.
    """

    knots: int = 0
    mirrored: bool = True
    cubic: bool = False


@dataclass(frozen=True)
class Shape:
    """The fitted parts of a feel.

    Attributes:
        spring: The spring.
        parts: Names of ``friction``, ``breakout``, ``preload``, ``deadband`` and ``hysteresis``.
        stop: One of ``STOPS``; empty without soft stops. Two of different angles are ``high low``.
    """

    spring: Spring = Spring()
    parts: frozenset[str] = frozenset()
    stop: str = ""

    def with_part(self, part: str) -> "Shape":
        """The shape with one part more."""
        return replace(self, parts=self.parts | {part})


@dataclass(frozen=True, eq=False)
class StaticModel:
    """A shape on points: unknowns as multiples of their scales.

    Attributes:
        shape: The shape.
        values: SI values of a loader without the fitted parts.
        angle_rad, directions: The points (points,).
        scales: Largest angle, largest force and their quotient at the column, by ``angle``, ``force`` and ``stiffness``.
        stated: Values of rows that are not fitted.
    """

    shape: Shape
    values: _Array
    angle_rad: _Array
    directions: _Array
    scales: Mapping[str, float]
    stated: Mapping[str, float] = field(default_factory=dict)

    @cached_property
    def knots_rad(self) -> tuple[_Array, _Array]:
        """Distances of the knots from neutral below and above it; the farthest are the farthest points."""
        count, x = self.shape.spring.knots, self.angle_rad
        if self.shape.spring.mirrored:
            both = _spread(np.abs(x), count)
            return both, both
        return _spread(-x[x < 0], count), _spread(x[x > 0], count)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The unknowns."""
        low, high = self.knots_rad
        sides = ("",) if self.shape.spring.mirrored else ("-", "+")
        rises = [f"rise {side}{k}" for side in sides for k in range(len(low if side == "-" else high))]
        if self.shape.spring.cubic:
            rises = ["slope 0", "slope 1"]
        parts = [name for name in _ROWS if name in self.shape.parts]
        if "hysteresis" in parts:
            parts.append("hysteresis travel")
        stops = {"mirrored": ["stop"]}.get(self.shape.stop, [f"stop {side}" for side in self.shape.stop.split()])
        return (*(rises or ["stiffness"]), *parts, *stops, *(["stop stiffness"] if stops else []))

    def start(self, stop_share: float, inner_share: float) -> _Array:
        """Numbers to begin with: a stop at a share of the travel, a deadband and a hysteresis travel of another."""
        begun = {
            "stiffness": 1.0,
            "slope 0": 0.8,
            "slope 1": 1.2,
            "stop": stop_share,
            "stop high": stop_share,
            "stop low": -stop_share,
            "preload": 0.0,
        }
        begun |= {"deadband": inner_share, "hysteresis travel": inner_share, "stop stiffness": 3.0}
        knots = max(len(self.knots_rad[1]), 1)
        return np.array([begun.get(name, 1 / knots if name.startswith("rise") else 0.1) for name in self.names])

    @property
    def bounds(self) -> tuple[_Array, _Array]:
        """Lowest and highest numbers."""
        low = {"preload": -_MOST, "stop low": -1.0, "hysteresis travel": 1e-3}
        high = {"stop low": -_NONE, "stop high": 1.0, "stop": 1.0, "deadband": 0.9, "hysteresis travel": 0.5}
        bottom = [low.get(name, _NONE if name == "stiffness" else 0.0) for name in self.names]
        return np.array(bottom), np.array(
            [high.get(name, 1e3 if "stiffness" in name else _MOST) for name in self.names]
        )

    def feel(self, numbers: _Array) -> tuple[_Array, Curve | None]:
        """SI values and curve of the feel with these numbers."""
        named = dict(zip(self.names, numbers.tolist(), strict=True))
        values, points = self._values(named), self._curve_points(named)
        curve = None if points is None else Curve(tuple(points[0].tolist()), tuple(points[1].tolist()))
        stiffness = named["stiffness"] * self.scales["stiffness"] if curve is None else self._slope(curve)
        values[INDEX["feel.stiffness"]] = stiffness
        return values, curve

    def forces(self, numbers: _Array, angle_rad: _Array | None = None, directions: _Array | None = None) -> _Array:
        """Force at the grip at the points, or at other angles."""
        named = dict(zip(self.names, numbers.tolist(), strict=True))
        values, points = self._values(named), self._curve_points(named)
        if points is None:
            values[INDEX["feel.stiffness"]] = named["stiffness"] * self.scales["stiffness"]
        angle = self.angle_rad if angle_rad is None else angle_rad
        direction = self.directions if directions is None else directions
        curve = None if points is None else (points[0], _pieces(*(tuple(along.tolist()) for along in points)))
        return _core.feel_held_along(values, angle, direction, curve=curve)

    def _values(self, named: Mapping[str, float]) -> _Array:
        """SI values with all but the spring."""
        values = self.values.copy()
        for key, value in self.stated.items():
            values[INDEX[key]] = value
        for name, (key, scale) in _ROWS.items():
            if name in named:
                values[INDEX[key]] = named[name] * self.scales[scale]
        if "stop" in named:
            for side, sign in (("high", 1.0), ("low", -1.0)):
                values[INDEX[f"feel.soft_stop_{side}"]] = sign * named["stop"] * self.scales["angle"]
        return values

    def _curve_points(self, named: Mapping[str, float]) -> tuple[_Array, _Array] | None:
        """Angles and forces of the curve; ``None`` for a straight spring."""
        spring = self.shape.spring
        if spring.cubic:
            u = np.linspace(-1, 1, _CUBIC_POINTS)
            rise = named["slope 0"] * u + (named["slope 1"] - named["slope 0"]) / 3 * u**3
            return self.scales["angle"] * u, self.scales["force"] * rise
        if not spring.knots:
            return None
        x, y = [], []
        for sign, side, far in zip((-1, 1), "-+", self.knots_rad, strict=True):
            rises = [named[f"rise {'' if spring.mirrored else side}{k}"] for k in range(len(far))]
            x.append(sign * far[::sign])
            y.append(sign * self.scales["force"] * np.cumsum(rises)[::sign])
        return np.concatenate([x[0], [0.0], x[1]]), np.concatenate([y[0], [0.0], y[1]])

    def _slope(self, curve: Curve) -> float:
        """Mean slope of the curve over the middle half of its travel, as spring rate of the column."""
        ends = np.array([curve.x[0], curve.x[-1]]) / 2
        low, high = curve.at(ends)
        arm = self.scales["stiffness"] * self.scales["angle"] / self.scales["force"]
        return max(float(arm * (high - low) / (ends[1] - ends[0])), _NONE * self.scales["stiffness"])


# A fit differs its numbers one by one, and most leave the curve as it is.
_pieces = lru_cache(maxsize=8)(pieces_through)


def _spread(distance: _Array, count: int) -> _Array:
    """Places of knots: quantiles of the distances, with the farthest."""
    if not count or not len(distance):
        return np.empty(0)
    far = float(distance.max())
    places = np.quantile(np.unique(distance), np.linspace(0, 1, count + 1)[1:])
    even = np.linspace(0, far, count + 1)[1:]
    return np.asarray((places + even) / 2)
