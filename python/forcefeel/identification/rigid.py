"""Rigid against compliant: do the frequency responses need the link's compliance?

Both models are fitted to the same responses with the same unknowns, the rigid one without k and c; the file's own k and c where
they are not among the unknowns. The report argued so by eye, with figures 8 and 9.
"""

from collections.abc import Sequence

import numpy as np
from scipy.stats import f as fisher

from forcefeel.bench.responses import Response
from forcefeel.identification.linear import Law, LinearModel
from forcefeel.identification.problem import Problem
from forcefeel.identification.response_observation import ResponseObservation
from forcefeel.identification.result import RigidTest
from forcefeel.identification.unknowns import Unknown
from forcefeel.loader import Loader
from forcefeel.models import Linkage

_LINK = ("linkage.stiffness", "linkage.damping")

_LEVEL = 0.001
"""Probability of F below which the rigid link is refused."""


def rigid_test(loader: Loader, law: Law, unknowns: Sequence[Unknown], responses: Sequence[Response]) -> RigidTest:
    """Fits both models and compares what is left.

    Args:
        loader: The loader, its values at the compliant fit's estimates: there the searches start.
        law: The law of the whole loader.
        unknowns: The unknowns.
        responses: The data.
    """
    others = [it for it in unknowns if it.key not in _LINK]
    compliant, compliant_rms, points = _left(loader, law, unknowns, responses, Linkage.COMPLIANT)
    rigid, rigid_rms, _ = _left(loader, law, others, responses, Linkage.RIGID)
    # k and c count as two parameters more even where the file gives them: somebody found them before.
    fewer, left = len(_LINK), points - len(others) - len(_LINK)
    statistic = max((rigid - compliant) / fewer / (compliant / left), 0.0)
    probability = float(fisher.sf(statistic, fewer, left))
    return RigidTest(
        needed=probability < _LEVEL,
        rigid_rms=rigid_rms,
        compliant_rms=compliant_rms,
        f_statistic=float(statistic),
        probability=probability,
        degrees=(fewer, left),
        bic_difference=float(points * np.log(rigid / compliant) - fewer * np.log(points)),
        level=_LEVEL,
    )


def _left(
    loader: Loader, law: Law, unknowns: Sequence[Unknown], responses: Sequence[Response], linkage: Linkage
) -> tuple[float, float, int]:
    """After a fit: sum of the squared errors in units of their deviations, relative r.m.s. error, and how many points there are."""
    keys = [it.key for it in unknowns]
    models = [LinearModel(loader, it.experiment.loop, law, linkage) for it in responses]
    observations = [ResponseObservation(it, model, keys) for it, model in zip(responses, models, strict=True)]
    values = np.array([loader[key] for key in keys])
    if keys:
        problem = Problem(unknowns, observations, priors=False)
        values = problem.values(problem.search(problem.start(values)).x)
    nothing = np.empty(0)
    residual = np.concatenate([it.compare(values, nothing).residual for it in observations])
    deviation = np.concatenate([it.deviation for it in observations])
    # Lines that are hardly known must not speak for all: the mean is weighted as the sum of squares is.
    mean_square = float(residual @ residual) / len(residual) / float(np.mean(deviation**-2.0))
    return float(residual @ residual), float(np.sqrt(mean_square)), len(residual)
