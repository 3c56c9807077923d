"""Directions of the points where the file does not state them, and checks of each branch."""

import math
from dataclasses import replace
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from forcefeel.errors import InputError
from forcefeel.feel.select import StaticFit, fitting
from forcefeel.feel.shape import Shape, Spring, StaticModel
from forcefeel.qualification import ForcePoints

_Array = NDArray[np.float64]

_BINS = 40
"""Largest number of positions at which a branch is checked."""
_SAME = 0.01
"""Share of the travel within which positions are equal."""
_FALL = 0.05
"""Share of the range of force that a branch may fall; with few points scatter may be that large."""
_CLEAR = 0.02
"""Share of the largest force below which a half width is scatter."""
_ROUNDS = 20
_GUESS = 2 * math.log(2)
"""Cost in the criterion of each assigned direction, a bit of information."""
_WIDE = 5.0
"""Least half width of a loop in standard deviations of its scatter; the best split of ten points of mere noise has up to 4."""


class Directions(StrEnum):
    """How the directions of the points are known."""

    STATED = "stated"
    OUTWARD = "outward"
    """Not stated; taken as away from neutral, because the points lie on one line."""
    ASSIGNED = "assigned"
    """Not stated; taken from the side of the mean curve on which a point lies."""


def both_ways(x: _Array, direction: _Array) -> bool:
    """Whether friction is separable from breakout: some points lead away from neutral, and others back."""
    away = x * direction
    return bool((away > 0).any() and (away < 0).any())


def assigned(model: StaticModel, points: ForcePoints, known_n: _Array, single: StaticFit) -> _Array | None:
    """Directions by which the points form a loop; ``None`` if one line describes them as well."""
    force, x = points.force_n, model.angle_rad
    none = np.zeros(len(x))
    best: tuple[float, _Array] | None = None
    for spring in (Spring(), Spring(2, mirrored=False)):
        mean = fitting(replace(model, directions=none), force, known_n)(Shape(spring, frozenset({"preload"})))
        if mean is None:
            continue
        direction = np.sign(mean.residual_n)
        for _ in range(_ROUNDS):
            fit = fitting(replace(model, directions=direction), force, known_n)
            loops = [fit(Shape(spring, frozenset(parts))) for parts in ({"friction"}, {"friction", "breakout"})]
            loop = min((each for each in loops if each), key=lambda each: each.criterion, default=None)
            if loop is None:
                break
            width = loop.numbers[loop.model.names.index("friction")] * model.scales["force"]
            least = max(_WIDE * float(np.std(loop.residual_n)), _CLEAR * model.scales["force"])
            if width > least and (best is None or loop.criterion < best[0]):
                best = loop.criterion, direction
            changed = np.sign(force - loop.model.forces(loop.numbers, directions=none))
            if (changed == direction).all():
                break
            direction = changed
    if best is None or best[0] + _GUESS * len(x) >= single.criterion:
        return None
    return best[1]


def check_branches(points: ForcePoints, direction: _Array) -> None:
    """Refuses points whose force falls while the position rises, and a loop that turns the other way round.

    Raises:
        InputError: With two points, or the half width of the loop.
    """
    if np.corrcoef(points.position, points.force_n)[0, 1] < 0:
        raise InputError(
            f"{points.name}: the force falls as the position rises; expected forces that pull towards positive positions to be "
            "positive; change the sign of one column"
        )
    branches = {sign: _branch(points, direction == sign) for sign in (1.0, -1.0)}
    span = float(np.ptp(points.force_n))
    for x, force in branches.values():
        highest = np.maximum.accumulate(force)
        fall = highest - force
        k = int(np.argmax(fall)) if len(fall) else 0
        if len(fall) and fall[k] > _FALL * span:
            raise _turns_back(points, x, force, int(np.argmax(force[: k + 1])), k)
    (x_up, up), (x_down, down) = branches.values()
    if min(len(up), len(down)) < 2:
        return
    between = (x_up >= x_down[0]) & (x_up <= x_down[-1])
    if not between.any():
        return
    half = float(np.median(up[between] - np.interp(x_up[between], x_down, down))) / 2
    if half < -_CLEAR * float(np.abs(points.force_n).max()):
        raise InputError(
            f"{points.name}: negative friction: the force on the way up lies {-2 * half:.4g} N below that on the way down; "
            "expected it above; check the signs of the force and of the column 'direction'"
        )


def check_line(points: ForcePoints) -> None:
    """Refuses points without directions whose force falls over two steps in a row.

    Those of a loop, or of two flight conditions, never do: the force falls from the upper line to the lower, and rises along it.

    Raises:
        InputError: With the first and the last point of the fall.
    """
    x, force = _branch(points, np.ones(len(points.force_n), dtype=np.bool_))
    falls = np.diff(force) < 0
    for k in np.flatnonzero(falls[:-1] & falls[1:]):
        last = int(k + np.argmin(np.append(falls[k:], False)))
        if force[k] - force[last] > _FALL * float(np.ptp(points.force_n)):
            raise _turns_back(points, x, force, int(k), last)


def _turns_back(points: ForcePoints, x: _Array, force: _Array, first: int, last: int) -> InputError:
    return InputError(
        f"{points.name}: turns back: {force[first]:.4g} N at {points.shown(x[first])}, and {force[last]:.4g} N at "
        f"{points.shown(x[last])}; expected a force that does not fall in one direction; correct the points, or if they are "
        "of two flight conditions, add a column such as 'dynamic pressure (Pa)'"
    )


def _branch(points: ForcePoints, which: NDArray[np.bool_]) -> tuple[_Array, _Array]:
    """Mean positions and forces of one direction, from the lowest position to the highest."""
    x, force = points.position[which], points.force_n[which]
    if not len(x):
        return x, force
    step = max(float(np.ptp(points.position)) / _BINS, 1e-300)
    cell = np.round((x - x.min()) / step).astype(np.intp) if len(x) > _BINS else _near(x, _SAME * _BINS * step)
    count = np.bincount(cell)
    filled = count > 0
    at, mean = (np.bincount(cell, values)[filled] / count[filled] for values in (x, force))
    order = np.argsort(at)
    return at[order], mean[order]


def _near(x: _Array, near: float) -> NDArray[np.intp]:
    """The number of each position; positions that are nearly equal have one number."""
    order = np.argsort(x)
    number = np.concatenate(([0], np.cumsum(np.diff(x[order]) > near)))
    cells = np.empty(len(x), dtype=np.intp)
    cells[order] = number
    return cells
