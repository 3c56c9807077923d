"""The force at which a control moves off neutral: the knee of force over position, on the way out.

``d`` distance from neutral · ``F`` force on the way out · ``kappa_1 < kappa_2 < kappa_3`` distances at which the slope changes

``F = F_0 + s d + a_1 max(d - kappa_1, 0) + ...``, with none to three changes, or ``F = F_0 + s d + b d^2 + c d^3`` where a curve
says more of the samples with fewer terms. Where the slope has fallen close to neutral, the force has built up, and breakout is
what the line beyond leaves at neutral, ``F_0 - a_1 kappa_1``. Of a detent nothing is left beyond it: what has built up is its
largest force above the line that follows. Where the slope only rises, as at the end of a deadband, or falls farther out, where the
control has long moved, breakout is what the first line or the curve leaves at neutral, ``F_0``.
"""

import math
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from forcefeel.qualification.figures import Figure, combined

NEAR = 0.04
"""Share of the travel around neutral in which the knee is looked for."""
_CELLS = 160
"""Cells of distance, closer together near neutral, over whose samples' means the lines are laid; each counts by its samples."""
_PLACES = np.linspace(0.0, 1.0, 26)[1:-1] ** 2
"""Distances at which the slope may change, to begin with; closer together near neutral."""
_BEGINS, _ROUNDS, _SHARES = 6, 20, 0.5 ** np.arange(8)
"""Places from which a search goes downhill, its steps at most, and the shares of a step that are tried."""
_FEWEST = 12
"""Samples that a knee is found in at least."""
_EXACT = 1e-3
"""Share of the largest force below which it does not matter what the lines leave."""
_FALLS = 0.1
"""Share of the largest fall of the slope from which on another one beyond it is part of the knee."""
_MOST = 3
"""Changes of the slope at most: two falls and a rise."""
_BUILT_UP = 0.5
"""Share of ``NEAR`` within which a force builds up: beyond it the control has moved."""
_GONE = 0.1
"""Share of what has built up that is left of it beyond a detent at most; and of the spring's slope that a deadband has at most."""

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
    share = distance / np.max(distance)
    cell = np.minimum(np.sqrt(share) * _CELLS, _CELLS - 1).astype(np.intp)
    count = np.bincount(cell, minlength=_CELLS)
    filled = count > 0
    d, force = (np.bincount(cell, values, minlength=_CELLS)[filled] / count[filled] for values in (share, force_n))
    weight = np.sqrt(count[filled] / np.mean(count[filled]))
    largest = float(np.max(np.abs(force)))
    if largest == 0:
        return Figure(0.0, force_uncertainty_n, "N")
    floor = (_EXACT * largest) ** 2 + force_uncertainty_n**2 / len(d)
    points = _Points(d, force, weight)
    fits: list[_Lines | _Cubic] = [_Cubic.through(points)]
    for changes in range(_MOST + 1):
        fits.append(_best_lines(points, changes))
        if fits[-1].left <= floor * len(d):
            break  # more could only follow what is nothing
    chosen = min(fits, key=lambda fit: fit.criterion(floor))
    value, known = chosen.at_neutral()
    return Figure(max(value, 0.0), combined(known, force_uncertainty_n / math.sqrt(len(distance))), "N")


@dataclass(frozen=True, eq=False)
class _Points:
    """Distances and forces away from neutral, and the square roots of what they count (points,)."""

    d: _Array
    force: _Array
    weight: _Array


def _best_lines(points: _Points, changes: int) -> "_Lines":
    """The lines whose slope changes so many times that leave least: from the best places of a coarse grid downhill."""
    if not changes:
        return _Lines.through(points, np.empty(0))
    tried = np.array(list(combinations(_PLACES, changes)))
    begun = tried[np.argsort(_left(points, tried), kind="stable")[:_BEGINS]]
    return min((_downhill(points, knots) for knots in begun), key=lambda lines: lines.left)


def _downhill(points: _Points, knots: _Array) -> "_Lines":
    """The lines with the best places near given ones, by the method of Gauss and Newton with steps that are halved."""
    best = _Lines.through(points, knots)
    for _ in range(_ROUNDS):
        missed = points.weight * (points.force - _basis(points.d, best.knots) @ best.terms)
        step, *_ = np.linalg.lstsq(points.weight[:, np.newaxis] * best.slopes(points), missed)
        ways = np.sort(np.clip(best.knots + np.outer(_SHARES, step[len(best.terms) :]), 0.0, 1.0), axis=1)
        better = _Lines.through(points, ways[np.argmin(_left(points, ways))])
        if not better.left < best.left:
            break
        best = better
    return best


def _basis(d: _Array, knots: _Array) -> _Array:
    """What the terms are multiplied by: (..., points, 2 + changes) for knots (..., changes)."""
    hinges = np.maximum(d[:, np.newaxis] - knots[..., np.newaxis, :], 0.0)
    return np.concatenate([np.broadcast_to(np.stack([np.ones_like(d), d], -1), (*hinges.shape[:-1], 2)), hinges], -1)


def _left(points: _Points, knots: _Array) -> _Array:
    """Sum of squares that the best lines with these knots leave, for many at once."""
    basis, force = points.weight[:, np.newaxis] * _basis(points.d, knots), points.weight * points.force
    turned = np.swapaxes(basis, -1, -2)
    products = turned @ basis + _SAME * np.eye(basis.shape[-1])
    along = turned @ force
    terms = np.linalg.solve(products, along[..., np.newaxis])[..., 0]
    return np.asarray(force @ force - np.sum(along * terms, axis=-1))


def _fitted(points: _Points, basis: _Array) -> tuple[_Array, float]:
    """Terms by least squares, and the sum of squares that they leave."""
    terms, *_ = np.linalg.lstsq(points.weight[:, np.newaxis] * basis, points.weight * points.force)
    return np.asarray(terms, dtype=np.float64), float(np.sum((points.weight * (basis @ terms - points.force)) ** 2))


def _covariance(points: _Points, slopes: _Array, left: float) -> _Array:
    """Of the unknowns along whose slopes (points, unknowns) a fit moves."""
    weighted = points.weight[:, np.newaxis] * slopes
    variance = left / max(len(slopes) - slopes.shape[1], 1)
    return np.asarray(np.linalg.pinv(weighted.T @ weighted) * variance)


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
    def through(points: _Points, knots: _Array) -> "_Lines":
        basis = _basis(points.d, knots)
        terms, left = _fitted(points, basis)
        lines = _Lines(knots, terms, np.empty(0), len(points.d), left)
        return replace(lines, covariance=_covariance(points, lines.slopes(points), left))

    def slopes(self, points: _Points) -> _Array:
        """How the lines move with each term, and with each knot: (points, terms and knots)."""
        with_knots = (-change * (points.d > knot) for change, knot in zip(self.terms[2:], self.knots, strict=True))
        return np.column_stack([_basis(points.d, self.knots), *with_knots])

    def criterion(self, floor: float) -> float:
        """A knot is two unknowns, its place and the change there."""
        return _criterion(self.left, self.points, 2 * len(self.knots), floor)

    def at_neutral(self) -> tuple[float, float]:
        """What has built up, or is left at neutral of the first line, and its standard uncertainty."""
        changes = self.terms[2:]
        beyond = int(np.argmin(changes)) + 1 if len(changes) else 0
        if np.sum(changes[:beyond]) >= 0 or (beyond and self.knots[beyond - 1] > _BUILT_UP):
            beyond = 0  # no less steep than the first, or too far out
        while 0 < beyond < len(changes) and changes[beyond] <= _FALLS * float(changes.min()):
            beyond += 1
        if beyond and self._is_gone(beyond):
            slopes = self._above_last(beyond)
        else:
            # F_0 - a_1 kappa_1
            part = np.where(np.arange(len(changes)) < beyond, -1.0, 0.0)
            slopes = np.concatenate([[1.0, 0.0], part * self.knots, part * changes])
        value = float(slopes[: len(self.terms)] @ self.terms)
        return value, math.sqrt(max(float(slopes @ self.covariance @ slopes), 0.0))

    def _above_last(self, beyond: int) -> _Array:
        """Slopes, by terms and knots, of the force at a knee above the last line, which begins at ``F_0``."""
        # F_0 + a_k (kappa_k - kappa) + ... of the changes beyond the knee kappa
        after = np.where(np.arange(len(self.knots)) >= beyond, 1.0, 0.0)
        changes = after * self.terms[2:]
        at_knots = changes.copy()
        at_knots[beyond - 1] -= np.sum(changes)
        return np.concatenate([[1.0, 0.0], after * (self.knots - self.knots[beyond - 1]), at_knots])

    def _is_gone(self, beyond: int) -> bool:
        """Whether what has built up at a knee is gone on the last line, as beyond a detent; a deadband ends its own flat one."""
        changes, first = self.terms[2:], self.terms[1]
        built_up = float(np.sum((changes * (self.knots - self.knots[beyond - 1]))[beyond:]))
        left = abs(float(np.sum(changes * self.knots)))
        after, last = float(first + np.sum(changes[:beyond])), float(first + np.sum(changes))
        # A force that falls as the control goes on is that of no spring, though a jump over it blurs what follows.
        return built_up > 0 and (after < -_GONE * last or (after > _GONE * last and left <= _GONE * built_up))


@dataclass(frozen=True, eq=False)
class _Cubic:
    """A curve of third degree, by least squares.

    Attributes:
        terms: ``F_0, s, b, c``.
        covariance: Of the terms.
        points, left: As of lines.
    """

    terms: _Array
    covariance: _Array
    points: int
    left: float

    @staticmethod
    def through(points: _Points) -> "_Cubic":
        powers = np.vander(points.d, 4, increasing=True)
        terms, left = _fitted(points, powers)
        return _Cubic(terms, _covariance(points, powers, left), len(points.d), left)

    def criterion(self, floor: float) -> float:
        """As of lines: two more terms than a straight one has."""
        return _criterion(self.left, self.points, 2, floor)

    def at_neutral(self) -> tuple[float, float]:
        """``F_0`` and its standard uncertainty."""
        return float(self.terms[0]), math.sqrt(float(self.covariance[0, 0]))


def _criterion(left: float, points: int, unknowns: int, floor: float) -> float:
    """Schwarz's, of unknowns more than a straight line has. What is left below ``floor`` a point is nothing."""
    return points * math.log(left / points + floor) + unknowns * math.log(points)
