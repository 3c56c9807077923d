"""The search: from several starts over a smaller set of the data, then from the best end over all of it.

The cost of frequency responses is smooth. That of records has jags and many low places where friction sticks and slips, so there a
search goes on from any lower place that is seen about its end, see ``jagged``.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from forcefeel.bench.identification.confidence import Confidence, confidence_of
from forcefeel.bench.identification.friction_jumps import surroundings
from forcefeel.bench.identification.problem import Place, Problem
from forcefeel.bench.identification.result import Ended
from forcefeel.bench.identification.unknowns import starts
from forcefeel.bench.records import BenchRecord
from forcefeel.errors import InputError

_SAME_LEFT = 0.01
"""Of the noise: two searches that leave as much explain the data as well."""

_SAME_PLACE = 0.02
"""Shares of a value within which two ends of a search from afar are the same place."""

_DROP, _MOST_DESCENTS = 1.0, 4
"""In units of the noise: a place lower by so much is worth going to; and how often."""


def search(
    problem: Problem, count: int, progress: Callable[[int, int], None]
) -> tuple[Place, Confidence, tuple[Ended, ...]]:
    """The best place, the confidence there, and where each start ended.

    Args:
        problem: Data and unknowns.
        count: How many starts.
        progress: Told how many of the searches are done.

    Raises:
        InputError: If the model diverges at every start.
    """
    coarse = replace(problem, observations=[it.coarse() for it in problem.observations], _last={})
    begun = starts(problem.unknowns, count)
    reached: list[tuple[int, Place]] = []
    for k, values in enumerate(begun):
        progress(k, count + 1)
        begin = coarse.start(values)
        if np.isfinite(coarse.compare(begin)[0]).all():  # or the model diverges there
            reached.append((k, _settled(coarse, coarse.search(begin, coarse=True), coarse=True)[0]))
    if not reached:
        raise InputError(
            "data: the model diverges at the file's values and at every other start; expected a loop that is stable there: check "
            "the experiment, the law and the loader file"
        )
    progress(count, count + 1)
    best = min((place for _, place in reached), key=partial(_left, coarse))
    place, confidence = _settled(problem, problem.search(best.x), coarse=False)
    progress(count + 1, count + 1)
    ends = tuple(Ended(begun[k], problem.values(it.x), _left(coarse, it), _same(coarse, it, best)) for k, it in reached)
    return place, confidence, ends


def from_afar(problem: Problem) -> Confidence | None:
    """What all of the data tell where a search over the smaller set ends: one comparison. Nothing where the model diverges."""
    coarse = replace(problem, observations=[it.coarse() for it in problem.observations], _last={})
    begin = coarse.start(starts(problem.unknowns, 1)[0])
    if not np.isfinite(coarse.compare(begin)[0]).all():
        return None
    place, _ = _settled(coarse, coarse.search(begin, coarse=True), coarse=True)
    return confidence_of(problem, problem.place(place.x, place.at_bound))


def _settled(problem: Problem, place: Place, *, coarse: bool) -> tuple[Place, Confidence]:
    """A place about which no lower one is in sight, and the confidence there, jags of the cost counted."""
    confidence = confidence_of(problem, place)
    if not any(isinstance(it.data, BenchRecord) for it in problem.observations):
        return place, confidence
    around = surroundings(problem, place, confidence)
    for _ in range(_MOST_DESCENTS):
        if around.drop < _DROP:
            break
        place = problem.search(around.lowest, coarse=coarse)
        confidence = confidence_of(problem, place)
        around = surroundings(problem, place, confidence)
    return place, confidence.widened(around.growth)


def _left(problem: Problem, place: Place) -> float:
    """What is left after a search, per point: ``(sum_g n_g ln s_g + prior) / n``, the likelihood of normal errors of unknown size.

    Noise is found anew at each end, so sums of squares in its units do not compare.
    """
    points = np.array([group.stop - group.start for group in problem.groups])
    prior, _ = problem.prior_rows(place.x)
    return float((points @ np.log(place.noise) + 0.5 * prior @ prior) / points.sum())


def _same(problem: Problem, place: Place, best: Place) -> bool:
    unknowns = len(problem.unknowns)
    near = np.allclose(place.x[:unknowns], best.x[:unknowns], rtol=_SAME_PLACE)
    return near or abs(_left(problem, place) - _left(problem, best)) < _SAME_LEFT
