"""Test of the link: do the frequency responses require its compliance?

Both models are fitted to the same responses with the same unknowns, the rigid one without k and c; k and c are those of the file
unless fitted. The report compares them in figures 8 and 9.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.stats import f as fisher

from forcefeel.bench.identification.linear import LinearModel
from forcefeel.bench.identification.problem import Problem
from forcefeel.bench.identification.response_observation import ResponseObservation, line_deviation
from forcefeel.bench.identification.result import RigidTest
from forcefeel.bench.identification.unknowns import Unknown
from forcefeel.bench.responses import Response
from forcefeel.laws.law import LawLike
from forcefeel.linear.models import Linkage
from forcefeel.loader.loader import Loader

_LINK = ("linkage.stiffness", "linkage.damping")

_LEVEL = 0.001
"""Significance level of the rejection of the rigid link."""


def rigid_test(loader: Loader, law: LawLike, unknowns: Sequence[Unknown], responses: Sequence[Response]) -> RigidTest:
    """Fit both models and compare their residuals.

    Args:
        loader: The loader, its values at the compliant fit's estimates: there the searches start.
        law: The law of the whole loader.
        unknowns: The unknowns.
        responses: The data.
    """
    others = [unknown for unknown in unknowns if unknown.key not in _LINK]
    bent = _problem(loader, law, unknowns, responses, Linkage.COMPLIANT)
    best = bent.search(bent.start(_values(loader, unknowns)))
    stiff = _problem(loader, law, others, responses, Linkage.RIGID)
    # Both in units of the noise of the compliant fit, so that their sums of squares compare.
    residual = stiff.weighted(stiff.minimum(stiff.start(_values(loader, others)), best.noise), best.noise)
    compliant, rigid, points = float(best.residual @ best.residual), float(residual @ residual), len(residual)
    # k and c count as two parameters even with the file's values, which were estimated before. These may fit worse than the
    # rigid link, and then F does not exist.
    fewer, degrees_of_freedom = len(_LINK), points - len(others) - len(_LINK)
    statistic = max((rigid - compliant) / fewer / (compliant / degrees_of_freedom), 0.0)
    probability = float(fisher.sf(statistic, fewer, degrees_of_freedom))
    size = _relative(bent, best.noise)
    return RigidTest(
        needed=probability < _LEVEL,
        rigid_rms=size * float(np.sqrt(rigid / points)),
        compliant_rms=size * float(np.sqrt(compliant / points)),
        f_statistic=float(statistic),
        probability=probability,
        degrees=(fewer, degrees_of_freedom),
        bic_difference=float(points * np.log(rigid / compliant) - fewer * np.log(points)),
        level=_LEVEL,
    )


def _problem(
    loader: Loader, law: LawLike, unknowns: Sequence[Unknown], responses: Sequence[Response], linkage: Linkage
) -> Problem:
    """Plain least squares without priors."""
    keys = [unknown.key for unknown in unknowns]
    models = [LinearModel(loader, response.experiment.loop, law, linkage) for response in responses]
    observations = [
        ResponseObservation(response, model, keys) for response, model in zip(responses, models, strict=True)
    ]
    return Problem(unknowns, observations, "linear", priors=False)


def _values(loader: Loader, unknowns: Sequence[Unknown]) -> NDArray[np.float64]:
    return np.array([loader[unknown.key] for unknown in unknowns])


def _relative(problem: Problem, noise: NDArray[np.float64]) -> float:
    """Relative error of one unit of noise, as a mean weighted by the accuracy of the points."""
    lines = [
        line_deviation(observation.data) * size
        for observation, size in zip(problem.observations, noise, strict=True)
        if isinstance(observation.data, Response)
    ]
    return float(np.mean(np.concatenate(lines) ** -2.0) ** -0.5)
