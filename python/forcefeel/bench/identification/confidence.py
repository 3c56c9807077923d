"""Standard errors of the unknowns.

``H = J^T W J`` with the slopes J in units of the noise and the weights W of the robust loss. The covariance is
``H^-1 M H^-1`` with ``M = n/(n - 1) sum_c g_c g_c^T`` over pieces of data whose errors are independent, ``g_c = J_c^T W_c r_c``:
valid also for correlated errors within a piece, due to colored noise or model errors; but no standard error is smaller than that
of independent errors, ``H^-1``.

Source: H. White, Econometrica 48 (1980) 817; K.-Y. Liang, S. L. Zeger, Biometrika 73 (1986) 13.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import t as student

from forcefeel.bench.identification.losses import weight_of
from forcefeel.bench.identification.problem import Optimum, Problem

_CONFIDENCE = 0.95

_SINGULAR = 1e-13
"""Eigenvalue of H relative to the largest below which a direction is unobservable, within rounding."""

UNSEEN = 1e-6
"""Weight of a parameter in a direction that counts as zero."""


@dataclass(frozen=True, eq=False)
class Confidence:
    """Covariance and information, in shares of the larger of estimate and file value.

    Attributes:
        covariance: Of all unknowns, the data's own included, with priors, (n, n).
        sizes: Reference of the shares, relative to the file values, (unknowns,).
        estimates: Magnitudes of the estimates, in the same, (unknowns,).
        quantile: Student's t of the 95 % interval.
        information: Inverse covariance that the data alone would give, (unknowns, unknowns): H with the data's own unknowns taken
            out, less what ``inflation`` says.
        inflation: Standard errors over those that independent errors would give, one at least, (unknowns,).
        clear: Whether the cost has a detected minimum, (unknowns,).
    """

    covariance: NDArray[np.float64]
    sizes: NDArray[np.float64]
    estimates: NDArray[np.float64]
    quantile: float
    information: NDArray[np.float64]
    inflation: NDArray[np.float64]
    clear: NDArray[np.bool_]

    def widened(self, growth: NDArray[np.float64]) -> "Confidence":
        """The same with standard errors of the loader's unknowns multiplied by ``growth``, at least one, (unknowns,)."""
        sure = np.isfinite(growth)
        factor = np.where(sure, growth, 1.0)
        every = np.concatenate([factor, np.ones(len(self.covariance) - len(factor))])
        covariance = self.covariance * np.outer(every, every)
        information = self.information / np.outer(factor, factor) * np.outer(sure, sure)
        return replace(
            self, covariance=covariance, information=information, inflation=self.inflation * factor, clear=sure
        )

    @property
    def deviation(self) -> NDArray[np.float64]:
        """Standard errors, (n,)."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def correlation(self) -> NDArray[np.float64]:
        """Correlation of the loader's unknowns; not a number if a deviation is infinite or zero."""
        count = len(self.information)
        deviation = self.deviation[:count]
        with np.errstate(divide="ignore", invalid="ignore"):
            return self.covariance[:count, :count] / np.outer(deviation, deviation)


def confidence_of(problem: Problem, optimum: Optimum) -> Confidence:
    """Confidence at the end of the search."""
    count = len(problem.unknowns)
    weight = weight_of(optimum.residual, problem.loss)
    weighted = optimum.slopes * weight[:, np.newaxis]
    information = optimum.slopes.T @ weighted
    scores = weighted * optimum.residual[:, np.newaxis]
    clusters = problem.clusters
    pieces = int(clusters.max()) + 1
    sums = np.array([np.bincount(clusters, column, pieces) for column in scores.T]).T
    middle = pieces / (pieces - 1) * sums.T @ sums
    _, prior = problem.prior_rows(optimum.x)
    outer = _inverse(information + prior.T @ prior)
    covariance = outer @ (middle + prior.T @ prior) @ outer
    # A direction determined by few pieces is fitted to them, so they seem to agree; independent errors are the lower bound.
    least, variances = np.diag(outer), np.diag(covariance)
    raised = np.sqrt(
        np.divide(least, variances, out=np.ones_like(variances), where=(variances > 0) & (variances < least))
    )
    covariance = covariance * np.outer(raised, raised)
    inflation = np.sqrt(np.divide(np.diag(covariance), least, out=np.ones_like(least), where=least > 0))[:count]
    # An estimate near zero has no meaningful share; for an absent friction the file value is the reference.
    estimates = np.abs(optimum.x[:count])
    sizes = np.maximum(estimates, 1.0)
    phases = np.array([unknown.is_phase for unknown in problem.unknowns], dtype=np.bool_)
    estimates, sizes = np.where(phases, 1.0, estimates), np.where(phases, 1.0, sizes)
    every = np.concatenate([sizes, np.ones(len(optimum.x) - count)])
    quantile = float(student.ppf(0.5 + 0.5 * _CONFIDENCE, max(pieces - len(optimum.x), 1)))
    in_shares = _without_own(information * np.outer(every, every), count) / np.outer(inflation, inflation)
    clear = np.ones(count, dtype=np.bool_)
    return Confidence(covariance / np.outer(every, every), sizes, estimates, quantile, in_shares, inflation, clear)


def half_widths(information: NDArray[np.float64]) -> NDArray[np.float64]:
    """Standard errors ``sqrt(diag(H^-1))``; infinite for unknowns in a direction without information."""
    values, vectors = np.linalg.eigh(information)
    observable = values > _SINGULAR * max(float(values[-1]), np.finfo(float).tiny)
    variance = (vectors[:, observable] ** 2 / values[observable]).sum(axis=1)
    unseen = (np.abs(vectors[:, ~observable]) > UNSEEN).any(axis=1)
    return np.sqrt(np.where(unseen, np.inf, variance))


def weak_directions(information: NDArray[np.float64], limit: float) -> Sequence[NDArray[np.float64]]:
    """Directions along which an unknown can move by ``limit`` and more within a standard error, largest part 1, weakest first."""
    values, vectors = np.linalg.eigh(information)
    parts = np.abs(vectors).max(axis=0)
    weak = (values < _SINGULAR * values[-1]) | (values * limit**2 < parts**2)
    return [column / column[np.argmax(np.abs(column))] for column in vectors[:, weak].T]


def _inverse(information: NDArray[np.float64]) -> NDArray[np.float64]:
    """Inverse through scaled eigenvalues; directions without information are left out: half_widths says so."""
    scale = np.sqrt(np.maximum(np.diag(information), np.finfo(float).tiny))
    values, vectors = np.linalg.eigh(information / np.outer(scale, scale))
    observable = values > _SINGULAR * values[-1]
    return np.asarray((vectors[:, observable] / values[observable]) @ vectors[:, observable].T / np.outer(scale, scale))


def _without_own(information: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    """Information on the first unknowns once the others are found too: ``H_11 - H_12 H_22^-1 H_21``."""
    if count == len(information):
        return information
    own = information[count:, count:]
    return np.asarray(
        information[:count, :count] - information[:count, count:] @ np.linalg.pinv(own) @ information[count:, :count]
    )
