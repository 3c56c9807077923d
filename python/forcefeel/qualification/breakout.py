"""The force at which a control moves off neutral: the knee of force over position, on the way out.

``d`` distance from neutral · ``F`` force on the way out · ``kappa_1 < kappa_2`` distances at which the slope changes

``F = F_0 + s d + a_1 max(d - kappa_1, 0) + a_2 max(d - kappa_2, 0)``, with none, one or two of the changes, as the samples ask for.
Where the slope has fallen, the force has built up, and breakout is what the line beyond leaves at neutral, ``F_0 - a_1 kappa_1``;
where it only rises, as at the end of a deadband, it is what the first line leaves there, ``F_0``.
"""

import math
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from forcefeel.qualification.figures import Figure, combined

NEAR = 0.04
"""Share of the travel around neutral in which the knee is looked for."""
_POINTS = 160
"""Means of neighbouring samples that the lines are laid through."""
_PLACES = np.linspace(0.0, 1.0, 26)[1:-1] ** 2
"""Distances at which the slope may change, to begin with; closer together near neutral."""
_ROUNDS, _CLOSER, _AROUND = 8, 0.4, 5
"""Rounds in which the places are looked for more closely, how much so in each, and how many of each are tried."""
_FEWEST = 12
"""Samples that a knee is found in at least."""
_EXACT = 1e-3
"""Share of the largest force below which it does not matter what the lines leave."""
_FALLS = 0.1
"""Share of the largest fall of the slope from which on another one beyond it is part of the knee."""

_SAME = 1e-10
"""Keeps two changes at one place from being no solution."""

_Array = NDArray[np.float64]


def breakout(distance: _Array, force_n: _Array, force_uncertainty_n: float) -> Figure:
    """Breakout on one side, N.

    Args:
        distance: Samples of the way out, near neutral (samples,), in any unit.
        force_n: Away from neutral (samples,).
        force_uncertainty_n: Standard uncertainty of a sample.

    Returns:
        The figure, 0 or more; not a number where there are too few samples.
    """
    if len(distance) < _FEWEST or not np.ptp(distance) > 0:
        return Figure(math.nan, math.nan, "N")
    order = np.argsort(distance, kind="stable")
    starts = np.linspace(0, len(order), min(_POINTS, len(order)), endpoint=False).astype(np.intp)
    counts = np.diff(np.append(starts, len(order)))
    d, force = (np.add.reduceat(values[order], starts) / counts for values in (distance / np.max(distance), force_n))
    largest = float(np.max(np.abs(force)))
    if largest == 0:
        return Figure(0.0, force_uncertainty_n, "N")
    floor = (_EXACT * largest) ** 2 + force_uncertainty_n**2 / len(d)
    found = [_Lines.through(d, force, _best_knots(d, force, changes)) for changes in range(3)]
    chosen = min(found, key=lambda lines: lines.criterion(floor))
    value, known = chosen.at_neutral()
    return Figure(max(value, 0.0), combined(known, force_uncertainty_n / math.sqrt(len(distance))), "N")


def _best_knots(d: _Array, force: _Array, changes: int) -> _Array:
    """Where the slope changes so many times that least is left: the best of a coarse grid, looked for more closely."""
    if not changes:
        return np.empty(0)
    tried = np.array(list(combinations(_PLACES, changes)))
    reach = np.full(changes, 1 / len(_PLACES))
    for _ in range(_ROUNDS):
        best = tried[np.argmin(_left(d, force, tried))]
        around = np.linspace(-1.0, 1.0, _AROUND)
        steps = np.stack(np.meshgrid(*[around] * changes), axis=-1).reshape(-1, changes)
        tried = np.sort(np.clip(best + reach * steps, 0.0, 1.0), axis=1)
        reach = reach * _CLOSER
    return np.asarray(tried[np.argmin(_left(d, force, tried))])


def _basis(d: _Array, knots: _Array) -> _Array:
    """What the terms are multiplied by: (..., points, 2 + changes) for knots (..., changes)."""
    hinges = np.maximum(d[:, np.newaxis] - knots[..., np.newaxis, :], 0.0)
    return np.concatenate([np.broadcast_to(np.stack([np.ones_like(d), d], -1), (*hinges.shape[:-1], 2)), hinges], -1)


def _left(d: _Array, force: _Array, knots: _Array) -> _Array:
    """Sum of squares that the best lines with these knots leave, for many at once."""
    basis = _basis(d, knots)
    turned = np.swapaxes(basis, -1, -2)
    products = turned @ basis + _SAME * np.eye(basis.shape[-1])
    along = turned @ force
    terms = np.linalg.solve(products, along[..., np.newaxis])[..., 0]
    return np.asarray(force @ force - np.sum(along * terms, axis=-1))


@dataclass(frozen=True, eq=False)
class _Lines:
    """Lines that meet at the knots, by least squares.

    Attributes:
        knots: Where the slope changes.
        terms: ``F_0, s, a_1, a_2``.
        covariance: Of the terms, then of the knots.
        points: How many points they are laid through.
        left: Sum of squares of what they leave.
    """

    knots: _Array
    terms: _Array
    covariance: _Array
    points: int
    left: float

    @staticmethod
    def through(d: _Array, force: _Array, knots: _Array) -> "_Lines":
        basis = _basis(d, knots)
        terms, *_ = np.linalg.lstsq(basis, force)
        left = float(np.sum((basis @ terms - force) ** 2))
        # How the lines move with each term, and with each knot.
        slopes = np.column_stack(
            [basis, *(-change * (d > knot) for change, knot in zip(terms[2:], knots, strict=True))]
        )
        variance = left / max(len(d) - slopes.shape[1], 1)
        covariance: _Array = np.linalg.pinv(slopes.T @ slopes) * variance
        return _Lines(knots, np.asarray(terms, dtype=np.float64), covariance, len(d), left)

    def criterion(self, floor: float) -> float:
        """Schwarz's: a knot is two unknowns, its place and the change there. What is left below ``floor`` a point is nothing."""
        return self.points * math.log(self.left / self.points + floor) + 2 * len(self.knots) * math.log(self.points)

    def at_neutral(self) -> tuple[float, float]:
        """What is left at neutral of the line beyond the knee, and its standard uncertainty."""
        changes = self.terms[2:]
        beyond = int(np.argmin(changes)) + 1 if len(changes) else 0
        if np.sum(changes[:beyond]) >= 0:  # no less steep than the first
            beyond = 0
        while 0 < beyond < len(changes) and changes[beyond] <= _FALLS * float(changes.min()):
            beyond += 1
        part = np.where(np.arange(len(changes)) < beyond, -1.0, 0.0)
        along = np.concatenate([[1.0, 0.0], part * self.knots, part * changes])
        return float(along[: len(self.terms)] @ self.terms), math.sqrt(max(float(along @ self.covariance @ along), 0.0))
