"""Parameters that the data answer to in jumps.

Dry friction that sticks and slips makes the residuals jump where a slip comes a little earlier or later, so the cost is a parabola
with jags. The slopes at a low place know nothing of them, and the standard errors come out too small. So the cost is looked at some
standard errors ``h`` to either side of each unknown, the others held or following along the ridge that the slopes tell, whichever
is lower: ``cost(h) - cost(0) = a h^2`` with jags of the size J. The lowest place may then be anywhere up to ``h = sqrt(J / a)``
away, and the slopes told ``a = b``, half the square of what coloured errors made of the standard error: it grows by
``sqrt(max(b / a, 1) + J / a)``. A lower place that is found on the way is where the search goes on.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from forcefeel.bench.identification.confidence import Confidence
from forcefeel.bench.identification.problem import Optimum, Problem

_SIDES = (-1.0, 1.0)

_FAR = (4.0, 16.0, 64.0)
"""Standard errors away where the parabola is looked for, the next where the last is still among the jags."""

_BLIND = 0.01
"""Share of a value that stands for its standard error where the slopes see nothing of it."""

_ABROAD = (-0.6, -0.3, -0.1, 0.1, 0.3, 0.6)
"""Shares of a value away where a lower place is looked for, beyond what the standard errors reach."""


@dataclass(frozen=True, eq=False)
class Surroundings:
    """The cost about a place.

    Attributes:
        growth: By how much standard errors grow for jags, one at least, infinite where no parabola is in sight, (unknowns,).
        lowest: The lowest place that was seen, (n,).
        drop: By how much it is lower, in units of the noise.
    """

    growth: NDArray[np.float64]
    lowest: NDArray[np.float64]
    drop: float


def surroundings(problem: Problem, optimum: Optimum, confidence: Confidence) -> Surroundings:
    """Looks at the cost about a place."""
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
    """Rises of the cost about a place, and the lowest place seen."""

    def __init__(self, problem: Problem, optimum: Optimum) -> None:
        self._problem, self._place = problem, optimum
        self._here = problem.cost(optimum.x, optimum.noise)
        self._low, self._high = problem.bounds(len(optimum.x))
        self._known: dict[bytes, float] = {}
        self.lowest, self.drop = optimum.x, 0.0

    def at(self, steps: Sequence[NDArray[np.float64]]) -> None:
        """Looks a step of the loader's unknowns away, several at once; beyond a bound there is nothing to be seen."""
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
        """Rise by a step that was looked at, in units of the noise; infinite beyond a bound."""
        return self._known[step.tobytes()]


@dataclass(frozen=True, eq=False)
class _Direction:
    """Where the cost of one unknown is looked at.

    Attributes:
        seen: Whether the slopes see anything of it.
        steps: Steps of one standard error: alone, and along the ridge.
        parabola: The parabola that the slopes promise.
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
        """Growth of the standard error where the parabola is in sight so far away, else nothing."""

        def rise(h: float) -> float:
            return min(cost_scan.rise(h * step) for step in self.steps)

        outer = [cost for h in _SIDES if np.isfinite(cost := rise(h * distance))]
        if not outer or min(outer) <= 0:
            return None
        curvature = float(np.mean(outer)) / distance**2
        nearer = [h * distance_near for distance_near in (1.0, *_FAR) if distance_near < distance for h in _SIDES]
        jags = max((abs(cost - curvature * h**2) for h in nearer if np.isfinite(cost := rise(h))), default=0.0)
        return float(np.sqrt(max(self.parabola / curvature, 1.0) + jags / curvature))
