"""Releases of many settings: exact for a linear analog loader, otherwise simulated.

Stability is that of the linear model: poles of the analog loop, or of the sampled loop with its delay.

The result is the column angle over time, with a sampling rate that follows the programmed frequency.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import ceil, pi

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel.envelope.cases import Case, PilotArm
from forcefeel.envelope.machines import columns, full_rows, machines
from forcefeel.envelope.plan import Plan
from forcefeel.laws.law import Law
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import INDEX
from forcefeel.loops.sampled_loop import sampled_loops
from forcefeel.qualification.release_batch import ReleaseBatch, measure_releases
from forcefeel.simulation import RunStatus, Scenario
from forcefeel.simulation.engine import batch_outputs
from forcefeel.simulation.inputs import Release
from forcefeel.simulation.programmed_feel import with_arm
from forcefeel.simulation.scenario import LONGEST_STEP_S
from forcefeel.threads import LANES, side_by_side

_FEWEST_PERIODS, _FEWEST_SIMULATED = 10, 5
"""Fewest periods in a record. Those after the fifth move the margin of a simulated release, whose sensors have noise, by less than
another noise does.
"""

_LEFT, _AT_REST = 1e-3, 1e-5
"""Remaining share of the ideal's deflection at the end of the record: of a swing; and without one, where the column has to rest for
three times the fall time.
"""

_SHORTEST_STEP_S, _MOST_DOUBLINGS = 1e-3, 2
_SAMPLES_IN_PERIOD = 250
"""Fewest samples in a period. The step is at most 4 ms, which resolves the column on its link at some 20 Hz."""

_DURATIONS = 8
"""Durations from one to its double: records of one duration are measured together."""

_CHUNK_BYTES = 2**24
"""Histories in memory at once; they stay in the processor's cache."""

_Array = NDArray[np.float64]


@dataclass(frozen=True)
class Record:
    """Duration and sampling of a recorded release.

    Attributes:
        step_s: Time between samples, s.
        samples: Number of samples, the first at the release.
    """

    step_s: float
    samples: int

    @classmethod
    def of(cls, frequency: float, damping: float, fewest_periods: int = _FEWEST_PERIODS) -> "Record":
        """Record for a programmed frequency in rad/s and the smallest damping ratio of its settings."""
        step = float(_step_s(np.array(frequency)))
        periods = ceil(_periods(np.array(damping), fewest_periods))
        return cls(step, ceil(periods * 2 * pi / frequency / step) + 1)

    @property
    def time_s(self) -> _Array:
        """Time of each sample."""
        return np.asarray(np.arange(self.samples) * self.step_s, dtype=np.float64)

    @property
    def duration_s(self) -> float:
        """Time from the release to the last sample."""
        return (self.samples - 1) * self.step_s

    @property
    def together(self) -> int:
        """Number of records that fit into ``_CHUNK_BYTES``."""
        return max(LANES, _CHUNK_BYTES // (8 * self.samples) // LANES * LANES)

    def chunks(self, count: int) -> Iterator[slice]:
        """Slices of ``count`` records, ``together`` each."""
        return (slice(first, min(first + self.together, count)) for first in range(0, count, self.together))


def _step_s(frequency: _Array) -> _Array:
    """Time between samples of a release with these programmed frequencies in rad/s."""
    doublings = np.floor(np.log2(2 * pi / frequency / _SAMPLES_IN_PERIOD / _SHORTEST_STEP_S) + 1e-9)
    return np.asarray(_SHORTEST_STEP_S * 2 ** np.clip(doublings, 0, _MOST_DOUBLINGS))


def _periods(damping: _Array, fewest: int) -> _Array:
    """Periods in a release with these damping ratios."""
    slowest = damping - np.sqrt(np.maximum(damping**2 - 1, 0))  # of the poles, as a share of the frequency
    left = np.where(damping < 1, _LEFT, _AT_REST)
    return np.maximum(fewest, np.log(1 / left) / (2 * pi * slowest))


def simulated_records(plan: Plan, feel: _Array, arm: PilotArm | None) -> tuple[_Array, NDArray[np.intp]]:
    """Time between samples and number of samples of each setting's simulated release with an arm.

    A record lasts as long as feel I, B, G (settings, 3) and arm together need.
    """
    step = _step_s(plan.settings.rows[:, 1])
    frequency, damping = _core.feel_frequencies(carrying(plan.loader, feel, arm))
    duration = _periods(damping, _FEWEST_SIMULATED) * 2 * pi / frequency
    duration = 2 ** (np.ceil(_DURATIONS * np.log2(duration)) / _DURATIONS)
    return step, np.ceil(duration / step).astype(np.intp) + 1


def pieces(plan: Plan) -> Iterator[tuple[NDArray[np.intp], Record]]:
    """Chunks of settings of one frequency, each with a record that suits all arms."""
    for frequency in plan.settings.frequency:
        which = np.flatnonzero(plan.settings.rows[:, 1] == frequency)
        record = Record.of(frequency, plan.settings.damping[0])
        for chunk in record.chunks(len(which)):
            yield which[chunk], record


def measured(plan: Plan, record: Record, angles: NDArray[np.float64], threads: int) -> ReleaseBatch:
    """Figures of releases by the plan's rule."""
    return measure_releases(record.time_s, angles, held=1, rules=plan.rules.release, threads=threads)


def carrying(loader: Loader, feel: NDArray[np.float64], arm: PilotArm | None) -> NDArray[np.float64]:
    """I, B, G (settings, 3) with the arm at the grip of both the column and the ideal."""
    return feel if arm is None else with_arm(loader, feel, arm.values)


def released(
    plan: Plan, cases: Sequence[Case], feel: NDArray[np.float64], laws: Law, record: Record, threads: int
) -> tuple[NDArray[np.bool_], NDArray[np.float64]]:
    """Stability of each loop and its column angle (cases x settings, samples) after the release.

    Args:
        plan: The envelope.
        cases: Machines and arms. With a digital controller they run in one batch, which keeps lanes and cores busy for few
            settings. All have the same noise, so that machine and setting alone make the difference.
        feel: I, B, G of the settings, (settings, 3).
        laws: Law of each setting.
        record: Duration and sampling.
        threads: Number of threads.
    """
    if plan.loader["controller.period"]:
        rows = np.vstack([full_rows(plan.loader, case, feel, laws) for case in cases])
        each = laws.some(np.tile(np.arange(len(feel)), len(cases)))
        stable = sampled_loops(plan.loader, each, rows, threads=threads).stable
        return _stepped(plan, rows, each, record, threads, stable)
    stables, angles = zip(*(_analog(plan, case, feel, laws, record, threads) for case in cases), strict=True)
    return np.concatenate(stables), np.vstack(angles)


def stable_settings(
    plan: Plan, cases: Sequence[Case], feel: NDArray[np.float64], laws: Law, threads: int
) -> NDArray[np.bool_]:
    """Stability of the loop of each setting in each case (cases, settings), for a simulated loader."""
    return np.array(list(stability(plan, cases, feel, laws, threads)))


def stability(
    plan: Plan, cases: Sequence[Case], feel: NDArray[np.float64], laws: Law, threads: int
) -> Iterator[NDArray[np.bool_]]:
    """``stable_settings`` case by case."""

    def stable(case: Case) -> NDArray[np.bool_]:
        if plan.loader["controller.period"]:
            return sampled_loops(plan.loader, laws, full_rows(plan.loader, case, feel, laws), threads=threads).stable
        columns_, values = [INDEX[key] for key in columns(case)], machines(plan.loader, case, feel, laws)
        loops = _core.Loops(plan.loader.si_values, columns_, values, **laws.engine(plan.loader))
        code = _core.released(loops, np.empty((len(feel), 0)), plan.release_rad, LONGEST_STEP_S, threads)
        return np.asarray((code == _STABLE) | (code == _STABLE_BY_POLES))

    return side_by_side(stable, cases, threads)


def released_pairs(
    plan: Plan,
    pairs: Sequence[tuple[Case, NDArray[np.intp]]],
    feel: NDArray[np.float64],
    laws: Law,
    record: Record,
    threads: int,
) -> tuple[NDArray[np.bool_], NDArray[np.float64]]:
    """``released`` for cases each with its own stable settings, given as indices of ``feel``, in one batch."""
    rows = np.vstack([full_rows(plan.loader, case, feel[which], laws.some(which)) for case, which in pairs])
    each = laws.some(np.concatenate([which for _, which in pairs]))
    return _stepped(plan, rows, each, record, threads, np.ones(len(rows), dtype=bool))


def _analog(
    plan: Plan, case: Case, feel: NDArray[np.float64], laws: Law, record: Record, threads: int
) -> tuple[NDArray[np.bool_], NDArray[np.float64]]:
    columns_ = [INDEX[key] for key in columns(case)]
    values = machines(plan.loader, case, feel, laws)
    loops = _core.Loops(plan.loader.si_values, columns_, values, **laws.engine(plan.loader))
    angles = np.empty((len(feel), record.samples if plan.linear else 0))
    code = _core.released(loops, angles, plan.release_rad, record.step_s, threads)
    stable = (code == _STABLE) | (code == _STABLE_BY_POLES)
    if plan.linear:
        return stable, angles
    return _stepped(plan, full_rows(plan.loader, case, feel, laws), laws, record, threads, stable)


_STABLE, _STABLE_BY_POLES = 1, 3
"""Codes of the kernel."""


def _stepped(
    plan: Plan,
    rows: NDArray[np.float64],
    laws: Law,
    record: Record,
    threads: int,
    stable: NDArray[np.bool_],
) -> tuple[NDArray[np.bool_], NDArray[np.float64]]:
    """The same with simulation, for optional rows. A run that diverges counts as unstable."""
    which = np.flatnonzero(stable)
    if not len(which):
        return stable, np.full((len(rows), record.samples), np.nan)
    step = min(record.step_s, LONGEST_STEP_S)
    scenario = Scenario(Release(plan.release_rad), record.duration_s, step, record.step_s)
    law = laws.some(which)
    keep = ["column_angle_rad"]
    runs = batch_outputs(plan.loader, scenario, rows[which], law, keep=keep, first_run=None, threads=threads)
    angles = runs["column_angle_rad"]
    if len(which) < len(rows):
        angles = np.full((len(rows), record.samples), np.nan)
        angles[which] = runs["column_angle_rad"]
    stable = stable.copy()
    stable[which[runs["status"] == RunStatus.DIVERGED]] = False
    angles[~stable] = np.nan
    return stable, angles
