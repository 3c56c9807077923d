"""Robust tuning: the weights and noises of a design for one loader, searched for over many plants at once.

The rules of ``laws.sampled.rules`` are where it begins. No equation says which noises make an observer that is both exact and
robust. So an envelope is the judge: few settings, on every perturbed plant and under every arm, run side by side by the batch
engine. What is looked for is the largest

    score = worst + 0.3 nominal + 0.15 margin + 0.1 stable

``worst``, ``nominal`` shares that pass in every case and in the nominal one · ``stable`` share that is stable in every case ·
``margin`` mean over the settings of the least margin of any case, between -1 (unstable, or not to be measured) and 0.2 of the
tolerance, which tells one tuning from the next where no setting changes sides.

A random walk that keeps what is better: numbers are moved by normal steps, a few at a time; the steps grow after a success and
shrink after a failure. It needs no slope, of which shares have none. I. Rechenberg, Evolutionsstrategie, 1973.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Annotated

import numpy as np

from forcefeel.envelope.plan import Plan, make_plan
from forcefeel.envelope.result import Envelope, Shares
from forcefeel.envelope.run import compute_few
from forcefeel.errors import InputError
from forcefeel.laws.sampled.methods import tuned
from forcefeel.laws.sampled.rules import robust_tuning
from forcefeel.laws.sampled.tuning import Power, Tuning
from forcefeel.loader.loader import Loader
from forcefeel.units import PERCENT

COARSE: Mapping[str, str] = {
    "damping": "0.1, 1",
    "frequency": "1, 2, 4 Hz",
    "stiffness": "1..100 %:4:log",
}
"""Grid of the search."""

_NAME = "searched"
_NOMINAL, _MARGIN, _STABLE = 0.3, 0.15, 0.1
_LEAST, _MOST = -1.0, 0.2
_DECADES, _SLOPE = 1.0, 0.5
"""Size of a step of one, in decades and in decades a decade."""

_FIRST, _SMALLEST, _LARGEST, _GROWS, _SHRINKS, _MOVED = 0.5, 0.08, 1.0, 1.3, 0.97, 0.3
"""Steps: the first, their bounds, how they grow and shrink; and the share of numbers that a step moves."""


@dataclass(frozen=True)
class Tuned:
    """What a search found.

    Attributes:
        tuning: The best tuning.
        shares: Its shares on the grid of the search.
        score: Its score.
        first: The score that it began with.
        evaluations: Envelopes that were computed.

    Example:
        >>> import forcefeel as ff
        >>> grid = {"stiffness": "10, 100 %", "frequency": "2, 3 Hz", "damping": "0.3, 1"}
        >>> found = ff.envelope.tune(ff.digital_elevator(), evaluations=2, grid=grid, changes={}, arms=())
        >>> found.evaluations
        2
    """

    tuning: Tuning = field(repr=False)
    shares: Shares
    score: Annotated[float, PERCENT]
    first: Annotated[float, PERCENT]
    evaluations: int


Progress = Callable[[int, int, float], None]
"""Called with the envelopes that are computed, all there are, and the best score."""


def tune(
    loader: Loader,
    start: Tuning | None = None,
    evaluations: int = 40,
    *,
    seed: int = 0,
    progress: Progress = lambda done, total, best: None,
    **options: object,
) -> Tuned:
    """Searches for a tuning of the observer designs that passes most in every case.

    Args:
        loader: The loader, with ``controller.period``.
        start: Where to begin; the rules' tuning for the loader if not given.
        evaluations: Envelopes to compute, about a second each on the standard grid.
        seed: Of the steps; the same seed finds the same tuning.
        progress: Called with the envelopes that are computed, all there are, and the best score.
        options: As ``envelope`` takes them; ``grid`` is ``COARSE`` if not given.

    Raises:
        InputError: If an argument is bad, or there is no law with the first tuning.

    Example:
        >>> import forcefeel as ff
        >>> grid = {"stiffness": "10, 100 %", "frequency": "2, 3 Hz", "damping": "0.3, 1"}
        >>> found = ff.envelope.tune(ff.digital_elevator(), evaluations=2, grid=grid, changes={}, arms=())
        >>> found.score >= found.first
        True
    """
    if evaluations < 1:
        raise InputError(f"evaluations: expected at least 1, got {evaluations}")
    grid = options.pop("grid", COARSE)
    plan = make_plan(loader, {_NAME: None}, grid, **options)  # type: ignore[arg-type]
    draw = np.random.default_rng(seed)
    best = robust_tuning(loader) if start is None else start
    found, step = _envelope(plan, best), _FIRST
    first = score = _score(found)
    for done in range(1, evaluations):
        progress(done, evaluations, score)
        trial = _moved(best, step, draw)
        try:
            there = _envelope(plan, trial)
        except InputError:  # no law in double precision: as bad as can be
            step = max(step * _SHRINKS, _SMALLEST)
            continue
        if (reached := _score(there)) > score:
            best, found, score, step = trial, there, reached, min(step * _GROWS, _LARGEST)
        else:
            step = max(step * _SHRINKS, _SMALLEST)
    progress(evaluations, evaluations, score)
    return Tuned(best, found.shares(_NAME), score, first, evaluations)


def _envelope(plan: Plan, tuning: Tuning) -> Envelope:
    return compute_few(replace(plan, compensators={_NAME: tuned(_NAME, "", tuning)}))


def _score(found: Envelope) -> float:
    shares = found.shares(_NAME)
    margins = np.nan_to_num(found.data["margin"].values[0], nan=_LEAST)
    margins = np.where(found.stable(_NAME).reshape(margins.shape), np.clip(margins, _LEAST, _MOST), _LEAST)
    margin = float(margins.min(axis=0).mean())
    return shares.passes_worst + _NOMINAL * shares.passes + _MARGIN * margin + _STABLE * shares.stable_worst


def _moved(tuning: Tuning, step: float, draw: np.random.Generator) -> Tuning:
    """The tuning with some of its numbers moved."""

    def one(power: Power) -> Power:
        decades, slope = step * draw.normal(size=2) * (draw.random(2) < _MOVED)
        return Power(power.decades + _DECADES * float(decades), power.slope + _SLOPE * float(slope))

    given = {row.name: getattr(tuning, row.name) for row in fields(tuning)}
    return replace(tuning, **{name: one(power) for name, power in given.items() if power is not None})
