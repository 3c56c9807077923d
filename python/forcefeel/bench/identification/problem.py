"""The least-squares problem of an identification: all data at once, in units of their noise.

``cost = 1/2 sum rho((r_i / s_g)^2) + 1/2 sum ((theta_j - mean_j) / deviation_j)^2``

with ``r`` the residuals, ``s_g`` the noise of their group as estimated by the fit, ``rho`` the robust loss, and the second sum
over parameters with a normal tolerance. The unknowns are in shares of the file's values, so that all are of the order of one.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import get_args

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import OptimizeResult, least_squares

from forcefeel.bench.identification.losses import ROBUST_FROM, Loss, cost_of
from forcefeel.bench.identification.observations import Observation
from forcefeel.bench.identification.unknowns import Unknown
from forcefeel.errors import InputError
from forcefeel.loader.consistency import AT_LEAST
from forcefeel.threads import LANES
from forcefeel.units import show

_ROUNDS = 5
"""Most rounds of estimating the unknowns, then the noise; two or three suffice if the model fits."""

_SAME_NOISE = 0.01
"""Relative change of the noise at which the rounds end."""

_TO_DEVIATION = 1.4826
"""Standard deviation of normal noise per median of its magnitude."""

_PRECISION, _COARSE_PRECISION = 1e-9, 1e-4
"""Relative change of cost or unknowns at which a search ends: far below the standard errors, or coarse, to separate minima."""

_MOST_STEPS = 60
"""Most steps of one search: a smooth cost takes ten, one with jags may not converge."""


@dataclass(frozen=True, eq=False)
class Optimum:
    """End of a search in the space of the unknowns.

    Attributes:
        x: Unknowns in shares of the file's values, then the data's own, (n,).
        noise: Noise of each group, in units of the expected noise, (groups,).
        residual: Residuals in units of the noise, (points,).
        slopes: Their derivatives by ``x``, (points, n).
        at_bound: Which unknowns stand at a bound, (unknowns,).
    """

    x: NDArray[np.float64]
    noise: NDArray[np.float64]
    residual: NDArray[np.float64]
    slopes: NDArray[np.float64]
    at_bound: NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Problem:
    """Data, unknowns and weights.

    Attributes:
        unknowns: The unknowns of the loader.
        observations: The data.
        loss: The robust loss.
        priors: Whether normal tolerances are priors.
    """

    unknowns: Sequence[Unknown]
    observations: Sequence[Observation]
    loss: Loss = "huber"
    priors: bool = True
    _last: dict[bytes, tuple[NDArray[np.float64], NDArray[np.float64]]] = field(default_factory=dict, repr=False)

    def __post_init__(self) -> None:
        if self.loss not in get_args(Loss):
            raise InputError(f"loss: expected {', '.join(get_args(Loss))}, got {show(self.loss)}")

    @property
    def scale(self) -> NDArray[np.float64]:
        """SI value of one unit of each of the loader's unknowns."""
        return np.array([unknown.scale for unknown in self.unknowns])

    @property
    def groups(self) -> list[slice]:
        """Slices of the residual vector, one for each group."""
        slices, first = [], 0
        for observation in self.observations:
            slices += [slice(first + group.start, first + group.stop) for group in observation.groups]
            first = slices[-1].stop
        return slices

    @property
    def clusters(self) -> NDArray[np.int64]:
        """A number for each set of points with correlated errors, (points,)."""
        indices: list[NDArray[np.int64]] = []
        for observation in self.observations:
            indices.append(observation.clusters + (1 + int(indices[-1].max()) if indices else 0))
        return np.concatenate(indices)

    def values(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """SI values of the loader's unknowns at ``x``."""
        return x[: len(self.unknowns)] * self.scale

    def start(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """``x`` of these values, the data's own unknowns where they start."""
        return np.concatenate([values / self.scale, *(observation.own for observation in self.observations)])

    def bounds(self, size: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Lowest and highest ``x`` of so many unknowns; the data's own have no bounds."""
        own = np.full(size - len(self.unknowns), np.inf)
        low = np.array([unknown.low for unknown in self.unknowns]) / self.scale
        high = np.array([unknown.high for unknown in self.unknowns]) / self.scale
        return np.concatenate([low, -own]), np.concatenate([high, own])

    def consistent(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """``x`` with breakaway forces no smaller than the dry friction, below which they have no effect."""
        index = {unknown.key: j for j, unknown in enumerate(self.unknowns)}
        x = x.copy()
        for larger, smaller in AT_LEAST:
            if larger in index and smaller in index:
                j, k = index[larger], index[smaller]
                x[j] = max(x[j], x[k] * self.scale[k] / self.scale[j])
        return x

    def own(self, x: NDArray[np.float64]) -> list[NDArray[np.float64]]:
        """The data's own unknowns at ``x``, an array for each set."""
        ends = np.cumsum([len(self.unknowns), *(len(observation.own) for observation in self.observations)])
        return [x[a:b] for a, b in pairwise(ends)]

    def compare(self, x: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Residuals over the expected noise, (points,), and their derivatives by ``x``, (points, n)."""
        key = x.tobytes()
        if key not in self._last:
            self._last.clear()  # a search requests residuals and slopes of a point in turn
            self._last[key] = self._compare(x)
        return self._last[key]

    def _compare(self, x: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        residuals, rows, loader = [], [], len(self.unknowns)
        column = loader
        for observation, own in zip(self.observations, self.own(x), strict=True):
            comparison = observation.compare(self.values(x), own)
            slopes = np.zeros((len(comparison.residual), len(x)))
            slopes[:, :loader] = comparison.slopes[:, :loader] * self.scale
            slopes[:, column : column + len(own)] = comparison.slopes[:, loader:]
            column += len(own)
            residuals.append(comparison.residual)
            rows.append(slopes)
        return np.concatenate(residuals), np.concatenate(rows)

    def residual(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Residuals over the expected noise, (points,), without derivatives, each of which takes a separate run."""
        if (cached := self._last.get(x.tobytes())) is not None:
            return cached[0]
        residuals = [
            observation.residual(self.values(x), own)
            for observation, own in zip(self.observations, self.own(x), strict=True)
        ]
        return np.concatenate(residuals)

    def search(self, x: NDArray[np.float64], *, coarse: bool = False) -> Optimum:
        """The nearest minimum and its noise; at ``x`` the model must not diverge."""
        noise = self._noise(self.compare(x)[0])
        precision, rounds = (_COARSE_PRECISION, 2) if coarse else (_PRECISION, _ROUNDS)
        for _ in range(rounds):
            minimum = self._minimum(x, noise, precision)
            x, before = minimum.x, noise
            noise = self._noise(self.compare(x)[0])
            if np.allclose(noise, before, rtol=_SAME_NOISE):
                break
        at_bound = np.asarray(minimum.active_mask[: len(self.unknowns)] != 0)
        return self.optimum_at(self.consistent(x), at_bound, before)

    def optimum_at(
        self, x: NDArray[np.float64], at_bound: NDArray[np.bool_], noise: NDArray[np.float64] | None = None
    ) -> Optimum:
        """The optimum at ``x``, with this noise or the noise of the residual there."""
        residual, slopes = self.compare(x)
        _check_slopes(slopes)
        noise = self._noise(residual) if noise is None else noise
        weight = self._weight(noise)
        return Optimum(x, noise, residual * weight, slopes * weight[:, np.newaxis], at_bound)

    def minimum(self, x: NDArray[np.float64], noise: NDArray[np.float64]) -> NDArray[np.float64]:
        """The nearest minimum ``x`` at this noise."""
        return np.asarray(self._minimum(x, noise, _PRECISION).x) if len(x) else x

    def weighted(self, x: NDArray[np.float64], noise: NDArray[np.float64]) -> NDArray[np.float64]:
        """Residuals in units of this noise, (points,)."""
        return self.compare(x)[0] * self._weight(noise)

    def cost(self, x: NDArray[np.float64], noise: NDArray[np.float64]) -> float:
        """Cost at ``x`` in units of this noise; infinite if the model diverges."""
        residual = self.residual(x) * self._weight(noise)
        return cost_of(residual, self.loss) if np.isfinite(residual).all() else float("inf")

    def costs(self, places: Sequence[NDArray[np.float64]], noise: NDArray[np.float64]) -> list[float]:
        """``cost`` of several points, with their runs in parallel."""
        weight, costs = self._weight(noise), list[float]()
        for first in range(0, len(places), LANES):
            batch = places[first : first + LANES]
            values, own = np.array([self.values(x) for x in batch]), zip(*map(self.own, batch), strict=True)
            residuals = [
                observation.residuals(values, np.array(own_values))
                for observation, own_values in zip(self.observations, own, strict=True)
            ]
            rows = (np.concatenate(row) * weight for row in zip(*residuals, strict=True))
            costs += [cost_of(row, self.loss) if np.isfinite(row).all() else float("inf") for row in rows]
        return costs

    def prior_rows(self, x: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The priors as residuals and their slopes."""
        with_prior = [
            (j, unknown.prior) for j, unknown in enumerate(self.unknowns) if self.priors and unknown.prior is not None
        ]
        residual, slopes = np.empty(len(with_prior)), np.zeros((len(with_prior), len(x)))
        for row, (j, prior) in enumerate(with_prior):
            mean, deviation = prior or (0.0, 1.0)
            residual[row] = (x[j] * self.scale[j] - mean) / deviation
            slopes[row, j] = self.scale[j] / deviation
        return residual, slopes

    def _minimum(self, x: NDArray[np.float64], noise: NDArray[np.float64], precision: float) -> OptimizeResult:
        weight = self._weight(noise)

        def residual(at: NDArray[np.float64]) -> NDArray[np.float64]:
            return np.concatenate([self.residual(at) * weight, self.prior_rows(at)[0]])

        def slopes(at: NDArray[np.float64]) -> NDArray[np.float64]:
            there = self.compare(at)[1]
            _check_slopes(there)
            return np.concatenate([there * weight[:, np.newaxis], self.prior_rows(at)[1]])

        low, high = self.bounds(len(x))
        with np.errstate(over="ignore"):  # a step to a diverging model is retracted
            return least_squares(
                residual,
                np.clip(x, low, high),
                slopes,
                bounds=(low, high),
                loss=self.loss,
                f_scale=ROBUST_FROM,
                ftol=precision,
                xtol=precision,
                gtol=precision,
                max_nfev=_MOST_STEPS,
            )

    def _weight(self, noise: NDArray[np.float64]) -> NDArray[np.float64]:
        weight = np.empty(self.groups[-1].stop)
        for group, deviation in zip(self.groups, noise, strict=True):
            weight[group] = 1 / deviation
        return weight

    def _noise(self, residual: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.array([self._deviation(residual[group]) for group in self.groups])

    def _deviation(self, residual: NDArray[np.float64]) -> float:
        """Root mean square; under a robust loss outliers count no more than its limit."""
        if self.loss != "linear":
            limit = ROBUST_FROM * _TO_DEVIATION * float(np.median(np.abs(residual)))
            residual = np.clip(residual, -limit, limit) if limit > 0 else residual
        deviation = float(np.sqrt(np.mean(residual**2)))
        return max(deviation, _LEAST_NOISE)


def _check_slopes(slopes: NDArray[np.float64]) -> None:
    """Refuse a point at which the loop swings without end: limits bound its motion, and the derivatives grow with time.

    Raises:
        DivergesError: If they have.
    """
    if not (np.abs(slopes) < _MOST_SLOPE).all():
        raise DivergesError(
            "data: the search came to an unstable loop; expected one that is stable at and about the file's values: check the "
            "experiment, the law and the loader file"
        )


class DivergesError(InputError):
    """The model diverges where a search has come to."""


_MOST_SLOPE = 1e12
"""Largest derivative of a stable loop's residual, in units of the expected noise."""

_LEAST_NOISE = 1e-9
"""Noise of data computed by the model itself, in units of the expected noise."""
