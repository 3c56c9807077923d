"""Envelope of a linked pair: both hands on, each pilot's arm at each grip.

Both columns are let go together from one angle. The ideal is a pair of perfect loaders: both programmed feels, each with its arm,
joined by the link without its delay and injected damping (``_core.linked_feels``). The rule's figures of each column are compared
with those of the ideal's. Only settings that each loader renders alone, hands off and with each arm, are released.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from itertools import product
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel.envelope.cases import Case, Kind
from forcefeel.envelope.machines import full_rows
from forcefeel.envelope.outcomes import FIGURES, PASSED, UNSTABLE_LOOP
from forcefeel.envelope.plan import Plan
from forcefeel.envelope.releases import Record, carrying, measured, pieces
from forcefeel.envelope.result import COLORS, EVERY, PASSES, UNSTABLE, Envelope, Failure, failure_of
from forcefeel.envelope.settings import AXES, Settings
from forcefeel.laws.law import Law
from forcefeel.linked.engine import PairValues, simulate_linked_batch
from forcefeel.linked.result import SIDES
from forcefeel.linked.scenario import LinkedScenario
from forcefeel.loader.links import AfterBreakout, Link
from forcefeel.loader.project import Project
from forcefeel.qualification.batch_verdicts import judge_releases
from forcefeel.simulation.inputs import Release
from forcefeel.simulation.scenario import LONGEST_STEP_S, Scenario
from forcefeel.units import ANGLE, PERCENT

MOST_POINTS = {"damping": 4, "frequency": 5, "stiffness": 6}
"""Most values along each axis: a pair is stepped loader by loader, for each pair of arms."""

LINKED_SHARE = 0.95
"""Required share of the settings rendered alone that are within tolerance with both hands on."""

NOT_ALONE = "not rendered alone"
COLORS_LINKED = {**COLORS, NOT_ALONE: "#DDDDDD"}
"""Color of each outcome on the maps of a link."""

_OFF, _LEFT = 0.02, 0.9
"""A column swings on if, in the last quarter of the record, it is off its ideal by this share of the release angle, and by this
share of its largest error in the quarter before.
"""

_Codes = NDArray[np.int8]


@dataclass(frozen=True)
class ArmsRow:
    """One pair of arms.

    Attributes:
        first, second: Arms at the grips.
        passes: Share of the settings rendered alone that are within tolerance on both sides.
        unstable: Share of them at which a column swings on.
    """

    first: str
    second: str
    passes: Annotated[float, PERCENT]
    unstable: Annotated[float, PERCENT]


@dataclass(frozen=True, eq=False)
class PairEnvelope:
    """The envelope of two linked loaders under one law.

    Attributes:
        link: The link.
        law: Name of the law, of both sides.
        settings: Settings, some of those of the axes.
        release_rad: Release angle of both columns.
        arms: Names of the arms; the first is hands off.
        alone: Whether each side renders a setting alone with all arms, (2, settings).
        outcome: Outcome on the worse side (arms, arms, settings), index in ``OUTCOMES``; -1 where not released.
    """

    link: Link
    law: str
    settings: Settings
    release_rad: Annotated[float, ANGLE]
    arms: tuple[str, ...]
    alone: NDArray[np.bool_]
    outcome: _Codes

    @property
    def rendered(self) -> NDArray[np.bool_]:
        """Settings that both sides render alone."""
        return np.asarray(self.alone.all(axis=0))

    @property
    def linked_share(self) -> float:
        """Share of ``rendered`` that is within tolerance on both sides with every pair of arms; NaN if none is rendered."""
        codes = self.outcome[:, :, self.rendered]
        return float((codes == PASSED).all(axis=(0, 1)).mean()) if codes.size else float("nan")

    @property
    def rows(self) -> tuple[ArmsRow, ...]:
        """A row for each pair of arms."""
        codes = self.outcome[:, :, self.rendered]
        return tuple(
            ArmsRow(first, second, *(float((codes[i, j] == code).mean()) for code in (PASSED, UNSTABLE_LOOP)))
            for (i, first), (j, second) in product(enumerate(self.arms), repeat=2)
            if codes.size
        )

    @property
    def failures(self) -> Mapping[Failure, float]:
        """Share of ``rendered`` by the first failure over all pairs of arms, most frequent first."""
        kinds = self.kinds[self.rendered.reshape(self.settings.shape)]
        names = list(COLORS_LINKED)
        shares = {kind: float((kinds == names.index(kind)).mean()) for kind in Failure if kinds.size}
        return dict(sorted(((kind, share) for kind, share in shares.items() if share), key=lambda item: -item[1]))

    @property
    def kinds(self) -> _Codes:
        """Outcome of the pair at each setting (damping, frequency, stiffness): index in ``COLORS_LINKED``."""
        names = list(COLORS_LINKED)
        codes = self.outcome.reshape(-1, self.settings.count)
        first = np.take_along_axis(codes, np.argmax(codes != PASSED, axis=0)[np.newaxis], axis=0)[0]
        table = [names.index(failure_of(outcome) or EVERY) for outcome in OUTCOMES]
        kinds = np.where(first < 0, names.index(NOT_ALONE), np.array(table)[first])
        return np.asarray(kinds.reshape(self.settings.shape), dtype=np.int8)

    def alone_kinds(self, side: int) -> _Codes:
        """Whether a side renders each setting alone, likewise."""
        names = list(COLORS_LINKED)
        kinds = np.where(self.alone[side], names.index(EVERY), names.index(NOT_ALONE))
        return np.asarray(kinds.reshape(self.settings.shape), dtype=np.int8)


_SHORT = Record(LONGEST_STEP_S, 2)


def release_scenario(plans: tuple[Plan, Plan], record: Record = _SHORT) -> LinkedScenario:
    """Both columns let go together, from the smaller release angle of both plans."""
    release = Release(_release_rad(plans))
    step_s = min(record.step_s, LONGEST_STEP_S)
    return LinkedScenario(Scenario(release, record.duration_s, step_s, record.step_s), second_force=release)


def _release_rad(plans: tuple[Plan, Plan]) -> float:
    return min(plan.release_rad for plan in plans)


def most_releases(plans: tuple[Plan, Plan]) -> int:
    """Most releases of a pair, for progress."""
    laws = [law for law in plans[0].laws if law in plans[1].laws]
    return len(laws) * len(_cases(plans[0])) ** 2 * pair_settings(plans[0].settings)[0].count


def _cases(plan: Plan) -> list[Case]:
    """The nominal loader, hands off and with each arm."""
    return [case for case in plan.cases if case.kind in {Kind.NOMINAL, Kind.ARM}]


OUTCOMES = (PASSES, UNSTABLE, *FIGURES)
"""Outcomes by code."""


def pair_settings(settings: Settings) -> tuple[Settings, NDArray[np.intp]]:
    """Settings of a pair, evenly chosen from a grid, and their indices in it."""
    chosen = [
        np.unique(np.linspace(0, n - 1, min(n, most)).round().astype(int))
        for n, most in zip(settings.shape, MOST_POINTS.values(), strict=True)
    ]
    values = {name: tuple(np.array(getattr(settings, name))[some]) for name, some in zip(AXES, chosen, strict=True)}
    index = np.arange(settings.count).reshape(settings.shape)[np.ix_(*chosen)].ravel()
    return Settings(**values), index


def pair_envelope(
    project: Project,
    link: Link,
    law: str,
    axes: tuple[Envelope, Envelope],
    threads: int,
    advance: Callable[[int], None] = lambda some: None,
) -> PairEnvelope:
    """Release both columns of a link at each setting that both render alone, with each pair of arms.

    Args:
        project: The project.
        link: Its link.
        law: Name of a law of both envelopes.
        axes: Envelopes of both sides, over one grid.
        threads: Number of threads; the numbers do not depend on it.
        advance: Called with the number of completed releases.
    """
    settings, index = pair_settings(axes[0].plan.settings)
    plans = [replace(axis.plan, settings=settings) for axis in axes]
    cases = _cases(plans[0])
    alone = np.array([_alone(axis, law, index) for axis in axes])
    pair = _Pair(project, link, law, (plans[0], plans[1]))
    outcome = np.full((len(cases), len(cases), settings.count), -1, dtype=np.int8)
    for piece, record in pieces(plans[0]):
        which = piece[np.all(alone[:, piece], axis=0)]
        if len(which):
            outcome[:, :, which] = pair.released(cases, which, record, threads)
        advance(len(cases) ** 2 * len(piece))
    names = tuple("hands off" if case.arm is None else case.arm.name for case in cases)
    return PairEnvelope(link, law, settings, _release_rad(pair.plans), names, alone, outcome)


def _alone(axis: Envelope, law: str, index: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Whether a side renders some settings alone, hands off and with each arm."""
    places = [axis.plan.cases.index(case) for case in _cases(axis.plan)]
    return np.asarray((axis.codes(law)[places][:, index] == PASSED).all(axis=0))


@dataclass(frozen=True)
class _Pair:
    project: Project
    link: Link
    law: str
    plans: tuple[Plan, Plan]

    def released(self, cases: list[Case], which: NDArray[np.intp], record: Record, threads: int) -> _Codes:
        """Outcome of some settings (cases, cases, settings)."""
        arms = list(product(cases, repeat=2))
        angle = _release_rad(self.plans)
        rows, laws, feels = [], list[Law](), []
        for side, plan in enumerate(self.plans):
            feel = plan.settings.feel(plan.loader)
            law = Law.of(plan.laws[self.law], plan.loader, feel, self.law).some(which)
            feel = feel[which]
            rows.append(np.vstack([full_rows(plan.loader, pair[side], feel, law) for pair in arms]))
            laws.append(law.some(np.tile(np.arange(len(which)), len(arms))))
            feels.append(np.vstack([carrying(plan.loader, feel, pair[side].arm) for pair in arms]))
        bare = dict(zip(self.link.between, (plan.loader for plan in self.plans), strict=True))
        runs = simulate_linked_batch(
            replace(self.project, loaders={**self.project.loaders, **bare}),
            self.link.name,
            release_scenario(self.plans, record),
            PairValues(rows[0], rows[1]),
            (laws[0], laws[1]),
            threads=threads,
        )
        ideal = _core.linked_feels(
            feels[0],
            feels[1],
            self.link.values,
            (angle, record.step_s),
            record.samples,
            uncouples=self.link.after_breakout is AfterBreakout.UNCOUPLE,
            threads=threads,
        )
        angles = np.stack([runs[f"{side}_column_angle_rad"].to_numpy() for side in SIDES], axis=1)
        codes = self._judged(angles, ideal, record, threads)
        return codes.reshape(len(cases), len(cases), len(which))

    def _judged(self, angles: NDArray[np.float64], ideal: NDArray[np.float64], record: Record, threads: int) -> _Codes:
        """Outcome of each pair: unstable, or the first failing figure of the first side that fails."""
        swings = _swings_on(angles - ideal, _OFF * _release_rad(self.plans))
        angles = np.where(swings[:, np.newaxis, np.newaxis], np.nan, angles)
        codes = np.full(len(angles), PASSED, dtype=np.int8)
        for side, plan in reversed(list(enumerate(self.plans))):
            actual, reference = (
                measured(plan, record, np.ascontiguousarray(both[:, side]), threads) for both in (angles, ideal)
            )
            verdicts = judge_releases(actual, reference, plan.test, travel=plan.throw.travel_rad)
            codes = np.where(verdicts.passed, codes, verdicts.first_failing + UNSTABLE_LOOP + 1).astype(np.int8)
        return np.where(swings, UNSTABLE_LOOP, codes).astype(np.int8)


def _swings_on(apart: NDArray[np.float64], least: float) -> NDArray[np.bool_]:
    """Whether a column is still off its ideal (pairs, 2, samples) in the last quarter, nearly as much as in the quarter before."""
    quarter = apart.shape[2] // 4
    before, late = (
        np.abs(part).max(axis=(1, 2)) for part in (apart[:, :, -2 * quarter : -quarter], apart[:, :, -quarter:])
    )
    return np.asarray(np.logical_not((late < least) | (late < _LEFT * before)))
