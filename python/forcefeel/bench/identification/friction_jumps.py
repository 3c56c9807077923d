"""Parameters that the data answer to in jumps.

Dry friction that sticks and slips makes the residuals jump where a slip comes a little earlier or later, so the cost is a parabola
with jags. The slopes at a low place know nothing of them, and the standard errors come out too small. So the cost is looked at some
standard errors ``h`` to either side of each unknown, the others held or following along the ridge that the slopes tell, whichever
is lower: ``cost(h) - cost(0) = a h^2`` with jags of the size J. The lowest place may then be anywhere up to ``h = sqrt(J / a)``
away, and the slopes told ``a = b``, half the square of what coloured errors made of the standard error: it grows by
``sqrt(max(b / a, 1) + J / a)``. A lower place that is found on the way is where the search goes on.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from forcefeel.bench.identification.confidence import Confidence
from forcefeel.bench.identification.problem import Place, Problem

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


def surroundings(problem: Problem, place: Place, confidence: Confidence) -> Surroundings:
    """Looks at the cost about a place."""
    count = len(problem.unknowns)
    look = _Look(problem, place)
    sizes, growth = confidence.sizes, np.ones(count)
    for j, deviation in enumerate(confidence.deviation[:count]):
        seen = bool(np.isfinite(deviation) and deviation > 0)
        alone = np.where(np.arange(count) == j, deviation if seen else _BLIND, 0.0) * sizes
        ridge = confidence.covariance[:count, j] / deviation * sizes if seen else alone
        told = 0.5 * float(confidence.inflation[j]) ** 2 if seen else 0.5
        found = _growth(look, (alone, ridge), told)
        growth[j] = found if seen else 1.0  # without slopes there is no standard error to grow
        for share in _ABROAD:
            look.rise(np.where(np.arange(count) == j, share, 0.0) * sizes)
    return Surroundings(growth, look.lowest, look.drop)


class _Look:
    """Rises of the cost about a place, and the lowest place seen."""

    def __init__(self, problem: Problem, place: Place) -> None:
        self._problem, self._place = problem, place
        self._here = problem.cost(place.x, place.noise)
        self._low, self._high = problem.bounds(len(place.x))
        self.lowest, self.drop = place.x, 0.0

    def rise(self, step: NDArray[np.float64]) -> float:
        """Rise by a step of the loader's unknowns, in units of the noise; infinite beyond a bound, where nothing is to be seen."""
        x = self._place.x.copy()
        x[: len(step)] += step
        if np.any((x < self._low) | (x > self._high)):
            return np.inf
        rise = self._problem.cost(x, self._place.noise) - self._here
        if rise < -self.drop:
            self.lowest, self.drop = x, -rise
        return rise


def _growth(look: _Look, directions: tuple[NDArray[np.float64], ...], told: float) -> float:
    """Growth of one standard error; each direction is its step of one, ``told`` the parabola that the slopes promise."""

    def rise(h: float) -> float:
        return min(look.rise(h * direction) for direction in directions)

    inner = {h: rise(h) for h in _SIDES}
    for far in _FAR:
        outer = {h * far: it for h in _SIDES if np.isfinite(it := rise(h * far))}
        if outer and min(outer.values()) > 0:
            curvature = float(np.mean(list(outer.values()))) / far**2
            jags = max((abs(it - curvature * h**2) for h, it in inner.items() if np.isfinite(it)), default=0.0)
            return float(np.sqrt(max(told / curvature, 1.0) + jags / curvature))
        inner.update(outer)
    return float("inf")
