"""Parameters with jumps in the residual.

Dry friction that sticks and slips makes the residuals jump where a slip comes a little earlier or later, so the cost is a parabola
with jags. The slopes at a minimum do not show them, and the standard errors are too small. So the cost is evaluated some standard
errors ``h`` to either side of each unknown, with the others fixed or along the ridge of the slopes, whichever is lower:
``cost(h) - cost(0) = a h^2`` with jags of size J. The minimum may then be up to ``h = sqrt(J / a)`` away. The slopes predict
``a = b``, half the square of the inflation of the standard error by colored errors, so it grows by ``sqrt(max(b / a, 1) + J / a)``.
The search continues from any lower point.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from forcefeel.bench.identification.confidence import Confidence
from forcefeel.bench.identification.problem import Optimum, Problem

_SIDES = (-1.0, 1.0)

_FAR = (4.0, 16.0, 64.0, 256.0, 1024.0)
"""Distances of the evaluated points in standard errors; the next if the jags still dominate at the last."""

_BLIND = 0.01
"""Assumed standard error without slopes, as a share of the value."""

_ABROAD = (-0.6, -0.3, -0.1, 0.1, 0.3, 0.6)
"""Further distances of the search for a lower point, in shares of a value."""


@dataclass(frozen=True, eq=False)
class Surroundings:
    """The cost about an optimum.

    Attributes:
        growth: Factor of the standard errors due to jags, at least one, infinite without a parabola, (unknowns,).
        lowest: The lowest point evaluated, (n,).
        drop: Decrease of the cost there, in units of the noise.
    """

    growth: NDArray[np.float64]
    lowest: NDArray[np.float64]
    drop: float


def surroundings(problem: Problem, optimum: Optimum, confidence: Confidence) -> Surroundings:
    """Evaluate the cost about an optimum."""
    count = len(problem.unknowns)
    cost_scan = _Look(problem, optimum)
    directions = [_Direction.of(confidence, j, count) for j in range(count)]
    alone = np.eye(count) * confidence.sizes
    cost_scan.at([share * row for row in alone for share in _ABROAD])
    cost_scan.at([h * step for direction in directions for h in _SIDES for step in direction.steps])
    open_, growth = set(range(count)), np.full(count, np.inf)
    for distance in _FAR:
        cost_scan.at([h * distance * step for j in open_ for h in _SIDES for step in directions[j].steps])
        for j in list(open_):
            if (grown := directions[j].growth(cost_scan, distance)) is not None:
                growth[j] = grown
                open_.remove(j)
    growth = np.where(
        [direction.seen for direction in directions], growth, 1.0
    )  # without slopes there is no standard error to grow
    return Surroundings(growth, cost_scan.lowest, cost_scan.drop)


class _Look:
    """Rises of the cost about an optimum, and the lowest point evaluated."""

    def __init__(self, problem: Problem, optimum: Optimum) -> None:
        self._problem, self._place = problem, optimum
        self._here = problem.cost(optimum.x, optimum.noise)
        self._low, self._high = problem.bounds(len(optimum.x))
        self._known: dict[bytes, float] = {}
        self.lowest, self.drop = optimum.x, 0.0

    def at(self, steps: Sequence[NDArray[np.float64]]) -> None:
        """Evaluate several steps of the loader's unknowns at once; steps beyond a bound are skipped."""
        places = []
        for step in steps:
            x = self._place.x.copy()
            x[: len(step)] += step
            self._known[step.tobytes()] = np.inf
            if not np.any((x < self._low) | (x > self._high)):
                places.append((step, x))
        costs = self._problem.costs([x for _, x in places], self._place.noise)
        for (step, x), cost in zip(places, costs, strict=True):
            self._known[step.tobytes()] = rise = cost - self._here
            if rise < -self.drop:
                self.lowest, self.drop = x, -rise

    def rise(self, step: NDArray[np.float64]) -> float:
        """Rise at an evaluated step, in units of the noise; infinite beyond a bound."""
        return self._known[step.tobytes()]


@dataclass(frozen=True, eq=False)
class _Direction:
    """Steps of the evaluation for one unknown.

    Attributes:
        seen: Whether the slopes depend on it.
        steps: Steps of one standard error: alone, and along the ridge.
        parabola: The parabola predicted by the slopes.
    """

    seen: bool
    steps: tuple[NDArray[np.float64], NDArray[np.float64]]
    parabola: float

    @classmethod
    def of(cls, confidence: Confidence, j: int, count: int) -> "_Direction":
        deviation, sizes = confidence.deviation[j], confidence.sizes
        observable = bool(np.isfinite(deviation) and deviation > 0)
        alone = np.where(np.arange(count) == j, deviation if observable else _BLIND, 0.0) * sizes
        ridge = confidence.covariance[:count, j] / deviation * sizes if observable else alone
        return cls(observable, (alone, ridge), 0.5 * float(confidence.inflation[j]) ** 2 if observable else 0.5)

    def growth(self, cost_scan: _Look, distance: float) -> float | None:
        """Growth of the standard error, if the parabola shows at this distance."""

        def rise(h: float) -> float:
            return min(cost_scan.rise(h * step) for step in self.steps)

        outer = [cost for h in _SIDES if np.isfinite(cost := rise(h * distance))]
        if not outer or min(outer) <= 0:
            return None
        curvature = float(np.mean(outer)) / distance**2
        nearer = [h * distance_near for distance_near in (1.0, *_FAR) if distance_near < distance for h in _SIDES]
        jags = max((abs(cost - curvature * h**2) for h in nearer if np.isfinite(cost := rise(h))), default=0.0)
        return float(np.sqrt(max(self.parabola / curvature, 1.0) + jags / curvature))
