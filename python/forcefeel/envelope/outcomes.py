"""Outcomes of an envelope's releases: of whole cases, and of cases whose settings are mostly inferred from their neighbors."""

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from forcefeel.envelope.cases import Case, PilotArm
from forcefeel.envelope.ideal import ideal_releases
from forcefeel.envelope.plan import STABILITY_TIME, Plan
from forcefeel.envelope.refinement import PACE, UNKNOWN, rounds
from forcefeel.envelope.releases import (
    Record,
    carrying,
    measured,
    pieces,
    released,
    released_pairs,
    simulated_records,
    stability,
)
from forcefeel.envelope.result import NOT_HELD
from forcefeel.laws.law import Law
from forcefeel.qualification.batch_verdicts import NAMES, BatchVerdicts, judge_releases
from forcefeel.qualification.release import COLUMNS
from forcefeel.qualification.release_batch import ReleaseBatch
from forcefeel.sizing.too_small import Beyond
from forcefeel.threads import LANES, side_by_side

PASSED, UNSTABLE_LOOP, _FIRST = 0, 1, 2
"""Outcome codes; figures that can fail start at ``_FIRST``."""

FIGURES = (*NAMES, NOT_HELD)
"""What can fail, in the order of the codes."""

Outcomes = tuple[NDArray[np.int8], NDArray[np.float32], NDArray[np.bool_]]
"""Outcome, margin, and whether both are inferred: (laws, cases, settings)."""

Ran = tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.int8], NDArray[np.float32]]
"""Case, setting, outcome and margin of each release."""


def find_outcomes(
    plan: Plan,
    feel: NDArray[np.float64],
    laws: Mapping[str, Law],
    groups: Sequence[tuple[Case, ...]],
    threads: int,
    advance: Callable[[int], None],
) -> Outcomes:
    """Outcomes of every law at the plan's angle, each group of cases in one batch: all whole or all inferred."""
    shape = len(laws), sum(map(len, groups)), len(feel)
    outcome, margin = np.zeros(shape, dtype=np.int8), np.full(shape, np.nan, dtype=np.float32)
    inferred = np.zeros(shape, dtype=bool)
    of_linear = pieces(plan) if plan.linear else ()
    exact = [(which, record, [law.some(which) for law in laws.values()]) for which, record in of_linear]
    references: _References = {}
    ideal = IdealFigures(plan, feel, threads)
    first = 0
    for group in groups:
        places = slice(first, first + len(group))
        first = places.stop
        if not plan.linear:
            for k, law in enumerate(laws.values()):
                results = _simulated(ideal, law, group, advance)
                outcome[k, places], margin[k, places], inferred[k, places] = results
            continue
        for k, which, codes, margins in _exact(plan, group, feel, exact, references, threads):
            outcome[k, places][:, which] = codes.reshape(len(group), -1)
            margin[k, places][:, which] = margins.reshape(len(group), -1)
            advance(len(codes))
    # A force that the motor cannot hold is wrong before the release, even if the release passes.
    outcome[(outcome == PASSED) & force_not_held(plan, feel)] = _FIRST + len(NAMES)
    return outcome, margin, inferred


_References = dict[tuple[int, tuple[PilotArm | None, ...]], ReleaseBatch]
"""The ideal's releases of a piece of the settings with these arms."""

_Part = tuple[NDArray[np.intp], Record, list[Law]]
"""A piece of the settings: which, their record, and each law of them."""

_Task = tuple[int, NDArray[np.intp], Record, Law, ReleaseBatch]
"""Place of a law, settings, their record, the law of them, and the ideal's releases."""

_Done = tuple[int, NDArray[np.intp], NDArray[np.int8], NDArray[np.float32]]
"""Place of a law, settings, and outcome and margin of each release, case by case."""


def _exact(
    plan: Plan,
    group: Sequence[Case],
    feel: NDArray[np.float64],
    parts: Sequence[_Part],
    references: _References,
    threads: int,
) -> Iterator[_Done]:
    """Release all settings of a linear loader in the cases of a group under each law."""
    arms = tuple(case.arm for case in group)

    def tasks() -> Iterator[_Task]:
        for piece, (which, record, laws) in enumerate(parts):
            if (piece, arms) not in references:
                ideal = np.vstack([_ideal(plan, arm, feel[which], record) for arm in arms])
                references[piece, arms] = measured(plan, record, ideal, threads)
            yield from ((k, which, record, law, references[piece, arms]) for k, law in enumerate(laws))

    def run(task: _Task) -> _Done:
        k, which, record, law, reference = task
        stable, angles = released(plan, group, feel[which], law, record, threads)
        measures = measured(plan, record, angles, threads)
        verdicts = judge_releases(measures, reference, plan.test, travel=plan.throw.travel_rad)
        return k, which, *_judged(verdicts, stable)

    return side_by_side(run, tasks(), threads)


def force_not_held(plan: Plan, feel: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Settings whose force before the release is beyond the motor."""
    return Beyond.of(plan.loader, feel[:, 2], plan.release_rad).settings


class IdealFigures:
    """Records of simulated releases, and figures of the ideal with each arm, computed when first needed.

    Args:
        plan: The envelope of a simulated loader.
        feel: I, B, G of all settings, (settings, 3).
        threads: Number of threads.
    """

    def __init__(self, plan: Plan, feel: NDArray[np.float64], threads: int) -> None:
        self.plan, self.feel, self.threads = plan, feel, threads
        self._records: dict[PilotArm | None, tuple[NDArray[np.float64], NDArray[np.intp]]] = {}
        self._figures: dict[PilotArm | None, NDArray[np.float64]] = defaultdict(self._none_yet)

    def records(self, arm: PilotArm | None) -> tuple[NDArray[np.float64], NDArray[np.intp]]:
        """Time between samples and number of samples of each setting with an arm."""
        if arm not in self._records:
            self._records[arm] = simulated_records(self.plan, self.feel, arm)
        return self._records[arm]

    def of(self, arm: PilotArm | None, record: Record, which: NDArray[np.intp]) -> NDArray[np.float64]:
        """Figures of some settings with an arm, all of this record, (settings, figures)."""
        figures = self._figures[arm]
        missing = which[np.isnan(figures[which]).all(axis=1)]
        for chunk in record.chunks(len(missing)):
            some = missing[chunk]
            ideal = _ideal(self.plan, arm, self.feel[some], record)
            figures[some] = measured(self.plan, record, ideal, self.threads).values
        return figures[which]

    def _none_yet(self) -> NDArray[np.float64]:
        return np.full((len(self.feel), _FEATURES), np.nan)


def _simulated(ideal: IdealFigures, law: Law, cases: Sequence[Case], advance: Callable[[int], None]) -> Outcomes:
    """Outcomes of a law in cases of a simulated loader: run at all settings, or where ``rounds`` asks for it."""
    plan, usual = ideal.plan, sum(map(ideal.plan.usual_releases, cases))
    counted = 0

    def reach(share: float) -> None:
        nonlocal counted
        now = round(share * usual)
        advance(now - counted)
        counted = now

    rows, begun = [], 0.0
    for row in stability(plan, cases, ideal.feel, law, ideal.threads):
        rows.append(row)
        begun += STABILITY_TIME * len(row) / usual
        reach(begun)
    stable = np.array(rows)
    outcome = np.where(stable, UNKNOWN, UNSTABLE_LOOP).astype(np.int8)
    margin = np.full(outcome.shape, np.nan, dtype=np.float32)
    shape = len(cases), *plan.settings.shape
    wanted: Iterable[NDArray[np.bool_]] = [stable]
    paces: Sequence[float] = [1.0]
    if plan.infers(cases[0]):
        # Of views, which share their memory.
        wanted, paces = rounds(outcome.reshape(shape), margin.reshape(shape), UNSTABLE_LOOP), PACE
    run, known = ~stable, begun
    for index, each in enumerate(wanted):
        settings = each.reshape(outcome.shape)
        done, count = 0, max(1, int(settings.sum()))
        then = known + (1 - known) * paces[min(index, len(paces) - 1)]
        for places, which, codes, margins in run_settings(ideal, cases, settings, law):
            outcome[places, which], margin[places, which] = codes, margins
            done += len(codes)
            reach(begun + (then - begun) * done / count)
        run |= settings
        begun = then
    reach(1.0)
    return outcome, margin, ~run


def run_settings(ideal: IdealFigures, cases: Sequence[Case], settings: NDArray[np.bool_], law: Law) -> Iterator[Ran]:
    """Release some settings (cases, settings) whose loops are stable, in batches.

    The runs of a batch are of like duration and last as long as the longest. Each is measured by its own record, so that a result
    does not depend on the others, with one exception: a loop that diverges after its own record may count as unstable.

    Args:
        ideal: Records and figures of the ideal.
        cases: The cases.
        settings: The settings to run in each case.
        law: Law of each setting.
    """
    plan = ideal.plan
    places, which = np.nonzero(settings)
    records = [ideal.records(case.arm) for case in cases]
    steps, samples = (np.array(rows)[places, which] for rows in zip(*records, strict=True))

    def batches() -> Iterator[tuple[Record, NDArray[np.intp]]]:
        for step in np.unique(steps):
            left = np.flatnonzero(steps == step)
            left = left[np.argsort(-samples[left], kind="stable")]
            while left.size:
                longest = Record(float(step), int(samples[left[0]]))
                alike = int(np.sum(samples[left] > _ALIKE * longest.samples))
                count = min(max(_FEWEST, -(-alike // LANES) * LANES), longest.together)
                yield longest, np.sort(left[:count])
                left = left[count:]

    def reference(record: Record, runs: NDArray[np.intp]) -> NDArray[np.float64]:
        return np.vstack([ideal.of(cases[place].arm, record, which[some]) for place, some in _by(places, runs)])

    def tasks() -> Iterator[_Batch]:
        for longest, runs in batches():
            own = [(Record(longest.step_s, count), some) for count, some in _by(samples, runs)]
            yield longest, runs, [(record, some, reference(record, some)) for record, some in own]

    def run(batch: _Batch) -> Ran:
        longest, runs, measured_by = batch
        pairs = [(cases[place], which[some]) for place, some in _by(places, runs)]
        good, angles = released_pairs(plan, pairs, ideal.feel, law, longest, ideal.threads)
        outcome, margin = np.empty(len(runs), dtype=np.int8), np.empty(len(runs), dtype=np.float32)
        for record, some, figures in measured_by:
            rows = np.searchsorted(runs, some)
            measures = measured(plan, record, angles[rows, : record.samples], ideal.threads)
            verdicts = judge_releases(
                measures, replace(measures, values=figures), plan.test, travel=plan.throw.travel_rad
            )
            outcome[rows], margin[rows] = _judged(verdicts, good[rows])
        return places[runs], which[runs], outcome, margin

    return side_by_side(run, tasks(), ideal.threads)


_ALIKE, _FEWEST = 0.8, 32
"""Shortest duration in a batch, as a share of the longest, and fewest runs, shorter ones too: fewer leave lanes and cores empty."""

_Batch = tuple[Record, NDArray[np.intp], list[tuple[Record, NDArray[np.intp], NDArray[np.float64]]]]
"""Longest record and runs of a batch; records, their runs, and the ideal's figures of these."""


def _by(key: NDArray[np.intp], runs: NDArray[np.intp]) -> Iterator[tuple[int, NDArray[np.intp]]]:
    """Each value of a key and the runs that have it, in order."""
    return ((value, runs[key[runs] == value]) for value in np.unique(key[runs]).tolist())


_FEATURES = max(columns.stop for columns in COLUMNS.values())
"""Features of a release."""


def _ideal(plan: Plan, arm: PilotArm | None, feel: NDArray[np.float64], record: Record) -> NDArray[np.float64]:
    """Releases of I, B and G alone, with an arm if there is one."""
    return ideal_releases(carrying(plan.loader, feel, arm), plan.release_rad, record.step_s, record.samples)


def _judged(verdicts: BatchVerdicts, stable: NDArray[np.bool_]) -> tuple[NDArray[np.int8], NDArray[np.float32]]:
    """Outcome and margin of each release."""
    failing = np.where(verdicts.passed, PASSED, verdicts.first_failing + _FIRST)
    outcome = np.where(stable, failing, UNSTABLE_LOOP).astype(np.int8)
    return outcome, np.where(stable, verdicts.margin, np.nan).astype(np.float32)
