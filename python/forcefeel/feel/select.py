"""Choice of the shape: parts are added while they improve the criterion, then those that are not needed go.

``n`` points · ``k`` unknowns · ``RSS`` weighted sum of squares of the residuals

Schwarz's criterion with the correction of Hurvich and Tsai (Biometrika 76, 1989) for few points:
``n ln(RSS / n) + k ln n + 2 k (k + 1) / (n - k - 1)``.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from forcefeel.feel.shape import STOPS, Shape, Spring, StaticModel

_Array = NDArray[np.float64]

_KNOTS = (2, 3, 4, 6, 8)
"""Numbers of knots on a side that are tried, each from the one before or after it."""
_TOLERANCE = 1e-6
"""Relative change of squares and unknowns at which a fit ends, far below any interval."""
_EXACT = 1e-3
"""Share of the largest force below which residuals are of no interest: the accuracy of a good force sensor."""
_FEWEST_BEYOND = 2
"""Least number of points beyond a soft stop, and between a stop and neutral."""
_EQUAL, _MORE = 0.01, 2
"""Share of the travel within which angles are equal, and different angles for each knot on a side."""
_SAME = 1e-9
"""Improvement of the criterion that is rounding."""
_STARTS = ((0.75, 0.05), (0.9, 0.15), (0.6, 0.3))
"""Starting shares of the travel for stops and for deadbands."""


@dataclass(frozen=True, eq=False)
class StaticFit:
    """A fitted shape.

    Attributes:
        model: The shape on its points.
        numbers: The unknowns, as multiples of their scales.
        residual_n: Measured force minus that of the feel (points,).
        jacobian: Sensitivity of the weighted residuals to the unknowns (points, unknowns).
        squares: Weighted sum of squares of the residuals.
        criterion: The criterion; the smallest wins.
    """

    model: StaticModel
    numbers: _Array
    residual_n: _Array
    jacobian: _Array
    squares: float
    criterion: float


Fitting = Callable[[Shape], StaticFit | None]


def fitting(model: StaticModel, force_n: _Array, known_n: _Array) -> Fitting:
    """A function that fits a shape; ``None`` where there are too few points for it.

    Args:
        model: The points with any shape.
        force_n: Measured force.
        known_n: Standard uncertainty of each force; its ratios weigh the points.
    """
    from scipy.optimize import least_squares  # noqa: PLC0415  SciPy waits until there are checked points

    done: dict[Shape, StaticFit | None] = {}
    floor = (_EXACT * float(np.abs(force_n).max()) / float(np.median(known_n))) ** 2

    def best(shape: Shape) -> StaticFit | None:
        trial = replace(model, shape=shape)
        count, points = len(trial.names), len(force_n)
        if points < count + 2:
            return None
        nonlinear = shape.stop or shape.parts & {"deadband", "hysteresis"}
        runs = [
            least_squares(
                lambda numbers: (trial.forces(numbers) - force_n) / known_n,
                np.clip(trial.start(*start), *trial.bounds),
                bounds=trial.bounds,
                max_nfev=60,
                ftol=_TOLERANCE,
                xtol=_TOLERANCE,
            )
            for start in (_STARTS if nonlinear else _STARTS[:1])
        ]
        run = min(runs, key=lambda each: float(each.cost))
        squares = 2 * float(run.cost)
        penalty = count * math.log(points) + 2 * count * (count + 1) / max(points - count - 1, 1)
        criterion = points * math.log(squares / points + floor) + penalty
        return StaticFit(trial, run.x, -run.fun * known_n, np.asarray(run.jac), squares, criterion)

    def fit(shape: Shape) -> StaticFit | None:
        if shape not in done:
            done[shape] = best(shape)
        return done[shape]

    return fit


def choose(fit: Fitting, angle_rad: _Array, allowed: Sequence[str]) -> StaticFit | None:
    """The best shape whose parts are among ``allowed``; ``None`` if there are too few points even for a straight line."""
    usual = frozenset(allowed) & {"friction", "breakout"}
    begun = [Shape(), Shape(parts=usual), Shape(Spring(cubic=True), usual), Shape(Spring(2), usual)]
    ends = [_descended(fit, shape, angle_rad, allowed) for shape in begun if _enough(shape, angle_rad)]
    return min((end for end in ends if end), key=lambda each: each.criterion, default=None)


def _descended(fit: Fitting, shape: Shape, angle_rad: _Array, allowed: Sequence[str]) -> StaticFit | None:
    """The shape that no neighbor improves, from one on."""
    current = fit(shape)
    while current is not None:
        shapes = (shape for shape in _neighbors(current.model.shape, angle_rad, allowed) if _enough(shape, angle_rad))
        better = min((each for each in map(fit, shapes) if each), key=lambda each: each.criterion, default=current)
        if not better.criterion < current.criterion - _SAME:
            break
        current = better
    return current


def _enough(shape: Shape, x: _Array) -> bool:
    """Whether there are enough different angles for the knots and the stops of a shape."""
    near = _EQUAL * float(np.abs(x).max())
    sides = (np.abs(x),) if shape.spring.mirrored else (x[x > near], -x[x < -near])
    different = [int(np.sum(np.diff(np.sort(side)) > near)) + 1 for side in sides if len(side)]
    stops = {"mirrored": np.abs(x), "high": x, "low": -x}
    return min(different) >= _MORE * shape.spring.knots and all(
        np.sum(stops[name] > near) > 2 * _FEWEST_BEYOND for name in shape.stop.split()
    )


def _neighbors(shape: Shape, x: _Array, allowed: Sequence[str]) -> Iterator[Shape]:
    """Shapes with one part more or less, another spring or other stops."""
    both = bool(x.min() < 0 < x.max())
    for part in allowed:
        if part in shape.parts:
            yield replace(shape, parts=shape.parts - {part})
        elif part == "deadband":
            yield replace(shape, parts=shape.parts - {"breakout"} | {part})
        elif part == "breakout":
            yield replace(shape, parts=shape.parts - {"deadband"} | {part})
        else:
            yield shape.with_part(part)
    place = _KNOTS.index(shape.spring.knots) if shape.spring.knots in _KNOTS else 0
    near = {0: (*_KNOTS[:2],)}.get(shape.spring.knots, _KNOTS[max(place - 1, 0) : place + 2])
    springs = [Spring(), Spring(cubic=True), *(Spring(k, mirrored=True) for k in near)]
    if both:
        springs += [Spring(k, mirrored=False) for k in (1, *near)]
    yield from (replace(shape, spring=spring) for spring in springs if spring != shape.spring)
    yield from (replace(shape, stop=stop) for stop in ("", *STOPS, "high low") if stop != shape.stop)
