"""The search: from several starts over a smaller set of the data, then from the best end over all of it.

The cost of frequency responses is smooth. That of records has jags and many local minima due to stick-slip, so a search continues
from any lower point about its end, see ``friction_jumps``.
"""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from forcefeel.bench.identification.confidence import Confidence, confidence_of
from forcefeel.bench.identification.friction_jumps import surroundings
from forcefeel.bench.identification.problem import DivergesError, Optimum, Problem
from forcefeel.bench.identification.result import Ended
from forcefeel.bench.identification.unknowns import starts
from forcefeel.bench.records import BenchRecord
from forcefeel.errors import InputError

_SAME_LEFT = 0.01
"""Relative difference of the noise below which two searches explain the data equally well."""

_SAME_PLACE = 0.02
"""Relative difference of values below which two ends of a coarse search are equal."""

_DROP, _MOST_DESCENTS = 1.0, 4
"""Least decrease of the cost for another search, in units of the noise, and the most searches."""


def search(
    problem: Problem, begin: tuple[NDArray[np.float64], int], progress: Callable[[int, int], None]
) -> tuple[Optimum, Confidence, tuple[Ended, ...]]:
    """The best optimum, its confidence and the end of each start.

    Args:
        problem: Data and unknowns.
        begin: Values of the first starts, SI units, (starts, unknowns), and the least number of starts.
        progress: Called with the number of finished searches and of all.

    Raises:
        InputError: If the model diverges from every start on.
    """
    coarse = replace(problem, observations=[observation.coarse() for observation in problem.observations], _last={})
    first, count = begin[0], max(len(begin[0]), begin[1])
    start_values = starts(problem.unknowns, count)
    start_values[: len(first)] = first
    reached: list[tuple[int, Optimum]] = []
    for k, values in enumerate(start_values):
        progress(k, count + 1)
        start = coarse.start(values)
        if np.isfinite(coarse.compare(start)[0]).all():  # or the model diverges there
            with suppress(DivergesError):
                reached.append((k, _settled(coarse, start, coarse=True)[0]))
    if not reached:
        raise InputError(
            "data: the model diverges from the file's values and from every other start on; expected a loop that is stable there: "
            "check the experiment, the law and the loader file"
        )
    progress(count, count + 1)
    best = min((optimum for _, optimum in reached), key=partial(_cost, coarse))
    optimum, confidence = _settled(problem, best.x, coarse=False)
    progress(count + 1, count + 1)
    ends = tuple(
        Ended(start_values[k], problem.values(end.x), _cost(coarse, end), _same(coarse, end, best))
        for k, end in reached
    )
    return optimum, confidence, ends


def from_afar(problem: Problem) -> Confidence | None:
    """Confidence by all data at the end of a coarse search, by one comparison; ``None`` if the model diverges."""
    coarse = replace(problem, observations=[observation.coarse() for observation in problem.observations], _last={})
    start = coarse.start(starts(problem.unknowns, 1)[0])
    if not np.isfinite(coarse.compare(start)[0]).all():
        return None
    try:
        optimum, _ = _settled(coarse, start, coarse=True)
        return confidence_of(problem, problem.optimum_at(optimum.x, optimum.at_bound))
    except DivergesError:
        return None


def _settled(problem: Problem, x: NDArray[np.float64], *, coarse: bool) -> tuple[Optimum, Confidence]:
    """The optimum from ``x`` on without a lower point nearby, and its confidence, jags of the cost included.

    On the way from jag to jag digits are of no use: a search to the last of them takes four times the runs.
    """
    jags = any(isinstance(observation.data, BenchRecord) for observation in problem.observations)
    optimum = problem.search(x, coarse=coarse or jags)
    confidence = confidence_of(problem, optimum)
    if not jags:
        return optimum, confidence
    neighborhood = surroundings(problem, optimum, confidence)
    for _ in range(_MOST_DESCENTS):
        if neighborhood.drop < _DROP:
            break
        optimum = problem.search(neighborhood.lowest, coarse=True)
        confidence = confidence_of(problem, optimum)
        neighborhood = surroundings(problem, optimum, confidence)
    if not coarse:
        optimum = problem.search(optimum.x)
        confidence = confidence_of(problem, optimum)
    return optimum, confidence.widened(neighborhood.growth)


def _cost(problem: Problem, optimum: Optimum) -> float:
    """Cost per point after a search: ``(sum_g n_g ln s_g + prior) / n``, the likelihood of normal errors of unknown size.

    Noise is estimated at each end, so sums of squares in its units do not compare.
    """
    points = np.array([group.stop - group.start for group in problem.groups])
    prior, _ = problem.prior_rows(optimum.x)
    return float((points @ np.log(optimum.noise) + 0.5 * prior @ prior) / points.sum())


def _same(problem: Problem, optimum: Optimum, best: Optimum) -> bool:
    unknowns = len(problem.unknowns)
    near = np.allclose(optimum.x[:unknowns], best.x[:unknowns], rtol=_SAME_PLACE)
    return near or abs(_cost(problem, optimum) - _cost(problem, best)) < _SAME_LEFT
