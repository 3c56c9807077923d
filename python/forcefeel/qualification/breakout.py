"""Breakout: the force at which a control leaves neutral, from the knee of force over position on the way out.

``d`` distance from neutral · ``F`` force on the way out · ``kappa_1 < kappa_2 < kappa_3`` distances at which the slope changes

``F = F_0 + s d + a_1 max(d - kappa_1, 0) + ...``, with up to three changes of slope, or ``F = F_0 + s d + b d^2 + c d^3``. The
model with the smallest information criterion is used.

- The slope falls near neutral: breakout is the intercept at neutral of the line beyond the knee, ``F_0 - a_1 kappa_1``.
- A detent, whose force vanishes beyond the knee: breakout is its largest force above the line that follows.
- The slope only rises, as at the end of a deadband, or falls only farther out: breakout is the intercept ``F_0``.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations, combinations_with_replacement

import numpy as np
from numpy.typing import NDArray

from forcefeel.qualification.figures import Figure, combined

NEAR = 0.04
"""Share of the travel around neutral in which the knee is sought."""
_CELLS = 160
"""Cells of distance, smaller near neutral; the lines are fitted to the cell means, weighted by the number of samples."""
_PLACES = np.linspace(0.0, 1.0, 26)[1:-1] ** 2
"""Initial candidates for the distances at which the slope changes; denser near neutral."""
_BEGINS, _ROUNDS, _SHARES = 6, 20, 0.5 ** np.arange(8)
"""Number of starting points of the search, its largest number of steps, and the step fractions of the line search."""
_FEWEST = 12
"""Least number of samples for a knee."""
_EXACT = 1e-3
"""Share of the largest force below which the residual of a fit is negligible."""
_FALLS = 0.1
"""Share of the largest fall of the slope above which a further fall is part of the same knee."""
_MOST = 3
"""Largest number of slope changes: two falls and a rise."""
_BUILT_UP = 0.5
"""Share of ``NEAR`` within which the breakout force builds up."""
_GONE = 0.1
"""Largest share of the built-up force that remains beyond a detent; also the largest slope of a deadband, in spring slopes."""

_KEPT = 0.5
"""Share of the force at a knee from which on it has not vanished, although it falls a little."""

_SAME = 1e-10
"""Regularization; keeps the system solvable where two knots coincide."""

_Array = NDArray[np.float64]


def breakout(distance: _Array, force_n: _Array, force_uncertainty_n: float) -> Figure:
    """Breakout on one side, N.

    Args:
        distance: Distance from neutral on the way out (samples,), in any unit.
        force_n: Force away from neutral, N (samples,).
        force_uncertainty_n: Standard uncertainty of a sample.

    Returns:
        The figure, 0 or more; NaN where there are too few samples.
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
        if fits[-1].residual <= floor * len(d):
            break  # the residual is already negligible
    chosen = min(fits, key=lambda fit: fit.criterion(floor))
    value, known = chosen.at_neutral(points)
    return Figure(max(value, 0.0), combined(known, force_uncertainty_n / math.sqrt(len(distance))), "N")


@dataclass(frozen=True, eq=False)
class _Points:
    """Rising distances, forces away from neutral, and square roots of the weights (points,)."""

    d: _Array
    force: _Array
    weight: _Array

    @cached_property
    def beyond(self) -> _Array:
        """Weighted sums of 1, ``d``, ``d^2``, ``F`` and ``F d`` over the points from each place on: (5, points + 1)."""
        each = np.array([np.ones_like(self.d), self.d, self.d**2, self.force, self.force * self.d]) * self.weight**2
        return np.pad(np.cumsum(each[:, ::-1], axis=1)[:, ::-1], ((0, 0), (0, 1)))


def _best_lines(points: _Points, changes: int) -> "_Lines":
    """The best lines with ``changes`` slope changes: search from the best knots of a coarse grid."""
    if not changes:
        return _Lines.through(points, np.empty(0))
    tried = np.array(list(combinations(_PLACES, changes)))
    begun = tried[np.argsort(_residual_squares(points, tried), kind="stable")[:_BEGINS]]
    return min((_downhill(points, knots) for knots in begun), key=lambda lines: lines.residual)


def _downhill(points: _Points, knots: _Array) -> "_Lines":
    """The best lines near ``knots``, by the Gauss-Newton method with step halving."""
    best = _Lines.through(points, knots)
    for _ in range(_ROUNDS):
        missed = points.weight * (points.force - _basis(points.d, best.knots) @ best.terms)
        step, *_ = np.linalg.lstsq(points.weight[:, np.newaxis] * best.slopes(points), missed)
        candidates = np.sort(np.clip(best.knots + np.outer(_SHARES, step[len(best.terms) :]), 0.0, 1.0), axis=1)
        better = _Lines.through(points, candidates[np.argmin(_residual_squares(points, candidates))])
        if not better.residual < best.residual:
            break
        best = better
    return best


def _basis(d: _Array, knots: _Array) -> _Array:
    """Basis functions of the terms: (..., points, 2 + changes) for knots (..., changes)."""
    basis = np.empty((*knots.shape[:-1], len(d), 2 + knots.shape[-1]))
    basis[..., 0], basis[..., 1] = 1.0, d
    np.subtract(d[:, np.newaxis], knots[..., np.newaxis, :], out=basis[..., 2:])
    np.maximum(basis[..., 2:], 0.0, out=basis[..., 2:])
    return basis


def _residual_squares(points: _Points, knots: _Array) -> _Array:
    """Residual sums of squares of the best lines with these rising knots, vectorized over sets of knots."""
    # Normal equations: a product with max(d - kappa, 0) is one of sums over the points beyond kappa.
    lines, changes = 2, knots.shape[-1]
    zeroth, first, second, force, force_first = points.beyond[:, np.searchsorted(points.d, knots, side="right")]
    products = np.empty((*knots.shape[:-1], lines + changes, lines + changes))
    along = np.empty(products.shape[:-1])
    (products[..., 0, 0], middle, products[..., 1, 1], along[..., 0], along[..., 1]) = points.beyond[:, 0]
    products[..., 0, 1] = products[..., 1, 0] = middle
    products[..., 0, lines:] = products[..., lines:, 0] = first - knots * zeroth
    products[..., 1, lines:] = products[..., lines:, 1] = second - knots * first
    along[..., lines:] = force_first - knots * force
    for low, high in combinations_with_replacement(range(changes), 2):
        both = second - (knots + knots[..., [low]]) * first + knots * knots[..., [low]] * zeroth
        products[..., lines + low, lines + high] = products[..., lines + high, lines + low] = both[..., high]
    terms = np.linalg.solve(products + _SAME * np.eye(lines + changes), along[..., np.newaxis])[..., 0]
    return np.asarray(np.sum((points.weight * points.force) ** 2) - np.sum(along * terms, axis=-1))


def _fitted(points: _Points, basis: _Array) -> tuple[_Array, float]:
    """Terms by least squares, and the residual sum of squares."""
    terms, *_ = np.linalg.lstsq(points.weight[:, np.newaxis] * basis, points.weight * points.force)
    return np.asarray(terms, dtype=np.float64), float(np.sum((points.weight * (basis @ terms - points.force)) ** 2))


def _covariance(points: _Points, slopes: _Array, residual: float) -> _Array:
    """Covariance of the unknowns of a fit with sensitivities ``slopes`` (points, unknowns)."""
    weighted = points.weight[:, np.newaxis] * slopes
    variance = residual / max(len(slopes) - slopes.shape[1], 1)
    return np.asarray(np.linalg.pinv(weighted.T @ weighted) * variance)


@dataclass(frozen=True, eq=False)
class _Lines:
    """Lines that meet at the knots, by least squares.

    Attributes:
        knots: Distances at which the slope changes.
        terms: ``F_0, s, a_1, a_2``.
        points: Number of points of the fit.
        residual: Residual sum of squares.
    """

    knots: _Array
    terms: _Array
    points: int
    residual: float

    @staticmethod
    def through(points: _Points, knots: _Array) -> "_Lines":
        terms, residual = _fitted(points, _basis(points.d, knots))
        return _Lines(knots, terms, len(points.d), residual)

    def slopes(self, points: _Points) -> _Array:
        """Sensitivity of the lines to each term and each knot: (points, terms and knots)."""
        with_knots = (-change * (points.d > knot) for change, knot in zip(self.terms[2:], self.knots, strict=True))
        return np.column_stack([_basis(points.d, self.knots), *with_knots])

    def criterion(self, floor: float) -> float:
        """Schwarz's criterion; a knot adds two unknowns, its distance and its change of slope."""
        return _criterion(self.residual, self.points, 2 * len(self.knots), floor)

    def at_neutral(self, points: _Points) -> tuple[float, float]:
        """Built-up force, or intercept of the first line at neutral, and its standard uncertainty."""
        changes = self.terms[2:]
        beyond = int(np.argmin(changes)) + 1 if len(changes) else 0
        if np.sum(changes[:beyond]) >= 0 or (beyond and self.knots[beyond - 1] > _BUILT_UP):
            beyond = 0  # the slope does not fall, or falls too far out
        while 0 < beyond < len(changes) and changes[beyond] <= _FALLS * float(changes.min()):
            beyond += 1
        if beyond and self._is_gone(beyond):
            slopes = self._above_last(beyond)
        else:
            # F_0 - a_1 kappa_1
            part = np.where(np.arange(len(changes)) < beyond, -1.0, 0.0)
            slopes = np.concatenate([[1.0, 0.0], part * self.knots, part * changes])
        value = float(slopes[: len(self.terms)] @ self.terms)
        covariance = _covariance(points, self.slopes(points), self.residual)
        return value, math.sqrt(max(float(slopes @ covariance @ slopes), 0.0))

    def _above_last(self, beyond: int) -> _Array:
        """Derivatives, by terms and knots, of the force at a knee above the last line."""
        # F_0 + a_k (kappa_k - kappa) + ... of the changes beyond the knee kappa
        after = np.where(np.arange(len(self.knots)) >= beyond, 1.0, 0.0)
        changes = after * self.terms[2:]
        at_knots = changes.copy()
        at_knots[beyond - 1] -= np.sum(changes)
        return np.concatenate([[1.0, 0.0], after * (self.knots - self.knots[beyond - 1]), at_knots])

    def _is_gone(self, beyond: int) -> bool:
        """Whether the force built up at a knee vanishes on the last line, as beyond a detent, not as in a deadband."""
        changes, first = self.terms[2:], self.terms[1]
        built_up = float(np.sum((changes * (self.knots - self.knots[beyond - 1]))[beyond:]))
        residual = abs(float(np.sum(changes * self.knots)))
        after, last = float(first + np.sum(changes[:beyond])), float(first + np.sum(changes))
        knee = self.knots[beyond - 1]
        at_knee = float(self.terms[0] + first * knee + np.sum((changes * (knee - self.knots))[: beyond - 1]))
        if float(self.terms[0] - np.sum(changes * self.knots)) > _KEPT * at_knee:
            return False  # most of it is still there on the last line: friction, of which a little was that of rest
        # A falling force is not a spring's, although a jump across it blurs the samples that follow.
        return built_up > 0 and (after < -_GONE * last or (after > _GONE * last and residual <= _GONE * built_up))


@dataclass(frozen=True, eq=False)
class _Cubic:
    """A cubic curve, by least squares.

    Attributes:
        terms: ``F_0, s, b, c``.
        points, residual: As of ``_Lines``.
    """

    terms: _Array
    points: int
    residual: float

    @staticmethod
    def through(points: _Points) -> "_Cubic":
        terms, residual = _fitted(points, _powers(points))
        return _Cubic(terms, len(points.d), residual)

    def criterion(self, floor: float) -> float:
        """Schwarz's criterion; a cubic has two terms more than a straight line."""
        return _criterion(self.residual, self.points, 2, floor)

    def at_neutral(self, points: _Points) -> tuple[float, float]:
        """``F_0`` and its standard uncertainty."""
        return float(self.terms[0]), math.sqrt(float(_covariance(points, _powers(points), self.residual)[0, 0]))


def _powers(points: _Points) -> _Array:
    return np.vander(points.d, 4, increasing=True)


def _criterion(residual: float, points: int, unknowns: int, floor: float) -> float:
    """Schwarz's criterion, with the unknowns beyond a straight line; a residual below ``floor`` per point is negligible."""
    return points * math.log(residual / points + floor) + unknowns * math.log(points)
