"""Outcomes of an envelope's releases: of whole cases, and of cases whose settings are mostly inferred from their neighbors."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from forcefeel.envelope.cases import Case, PilotArm
from forcefeel.envelope.ideal import ideal_releases
from forcefeel.envelope.plan import Plan
from forcefeel.envelope.refinement import PACE, UNKNOWN, rounds
from forcefeel.envelope.releases import (
    Record,
    carrying,
    measured,
    pieces,
    records,
    released,
    released_pairs,
    stable_settings,
)
from forcefeel.envelope.result import NOT_HELD
from forcefeel.laws.law import Law
from forcefeel.qualification.batch_verdicts import NAMES, BatchVerdicts, judge_releases
from forcefeel.qualification.release import COLUMNS
from forcefeel.qualification.release_batch import ReleaseBatch
from forcefeel.sizing.too_small import Beyond
from forcefeel.threads import side_by_side

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
    parts = {
        arm: [(which, record, [law.some(which) for law in laws.values()]) for which, record in pieces(plan, arm=arm)]
        for arm in {_with_arm(group) for group in groups if not plan.infers(group[0])}
    }
    references: _References = {}
    first = 0
    for group in groups:
        places = slice(first, first + len(group))
        first = places.stop
        if plan.infers(group[0]):
            for k, law in enumerate(laws.values()):
                results = _refined(plan, feel, law, group, threads, advance)
                outcome[k, places], margin[k, places], inferred[k, places] = results
            continue
        for k, which, codes, margins in _whole(plan, group, feel, parts[_with_arm(group)], references, threads):
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


def _whole(
    plan: Plan,
    group: Sequence[Case],
    feel: NDArray[np.float64],
    parts: Sequence[_Part],
    references: _References,
    threads: int,
) -> Iterator[_Done]:
    """Release all settings in the cases of a group under each law."""
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


def _with_arm(group: Sequence[Case]) -> bool:
    """Whether an arm is at the grip in any of the cases."""
    return any(case.arm is not None for case in group)


def _refined(
    plan: Plan,
    feel: NDArray[np.float64],
    law: Law,
    cases: Sequence[Case],
    threads: int,
    advance: Callable[[int], None],
) -> Outcomes:
    """Outcomes of a law in hands-off cases, run where ``rounds`` asks for it."""
    stable = stable_settings(plan, cases, feel, law, threads)
    outcome = np.where(stable, UNKNOWN, UNSTABLE_LOOP).astype(np.int8)
    margin = np.full(outcome.shape, np.nan, dtype=np.float32)
    run = ~stable
    shape = len(cases), *plan.settings.shape
    counted, usual = 0, sum(map(plan.usual_runs, cases))
    # Of views, which share their memory.
    for index, wanted in enumerate(rounds(outcome.reshape(shape), margin.reshape(shape), UNSTABLE_LOOP)):
        settings = wanted.reshape(outcome.shape)
        for places, which, codes, margins in run_settings(plan, cases, settings, feel, law, threads):
            outcome[places, which], margin[places, which] = codes, margins
        run |= settings
        now = round(PACE[min(index, len(PACE) - 1)] * usual)
        advance(now - counted)
        counted = now
    advance(usual - counted)
    return outcome, margin, ~run


def run_settings(
    plan: Plan, cases: Sequence[Case], settings: NDArray[np.bool_], feel: NDArray[np.float64], law: Law, threads: int
) -> Iterator[Ran]:
    """Release some settings (cases, settings) whose loops are stable, in batches.

    Args:
        plan: The envelope of a simulated loader.
        cases: All with an arm at the grip, or all hands off.
        settings: The settings to run in each case.
        feel: I, B, G of all settings, (settings, 3).
        law: Law of each setting.
        threads: Number of threads.
    """
    arms = list(dict.fromkeys(case.arm for case in cases))
    of_arm = np.array([arms.index(case.arm) for case in cases])

    def tasks() -> Iterator[tuple[Record, NDArray[np.float64], NDArray[np.intp], NDArray[np.intp]]]:
        for record, alike in records(plan, arm=_with_arm(cases)):
            all_alike = np.flatnonzero(alike)
            wanted = settings[:, all_alike]
            places, columns = np.nonzero(wanted)
            # The feel alone is the same for all machines.
            features = np.full((len(arms), len(all_alike), _FEATURES), np.nan)
            for arm, table in enumerate(features):
                some = np.flatnonzero(wanted[of_arm == arm].any(axis=0))
                for chunk in record.chunks(len(some)):
                    ideal = _ideal(plan, arms[arm], feel[all_alike[some[chunk]]], record)
                    table[some[chunk]] = measured(plan, record, ideal, threads).values
            for chunk in record.chunks(len(columns)):
                reference = features[of_arm[places[chunk]], columns[chunk]]
                yield record, reference, places[chunk], all_alike[columns[chunk]]

    def run(task: tuple[Record, NDArray[np.float64], NDArray[np.intp], NDArray[np.intp]]) -> Ran:
        record, reference, places, which = task
        grouped = groupby(range(len(places)), key=lambda row: int(places[row]))
        pairs = [(cases[place], which[list(rows)]) for place, rows in grouped]
        good, angles = released_pairs(plan, pairs, feel, law, record, threads)
        measures = measured(plan, record, angles, threads)
        ideal = replace(measures, values=reference)
        verdicts = judge_releases(measures, ideal, plan.test, travel=plan.throw.travel_rad)
        return places, which, *_judged(verdicts, good)

    return side_by_side(run, tasks(), threads)


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
