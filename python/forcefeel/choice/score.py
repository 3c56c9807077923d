"""Scores of laws on one loader: envelope, demand on the drive, noise and margins."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from types import MappingProxyType
from typing import Unpack

import numpy as np
from numpy.typing import NDArray

from forcefeel.choice.demand import AnyDemand, largest_demand, of_all
from forcefeel.choice.own_setting import OwnSetting, own_setting
from forcefeel.envelope.contact import quiet_in_few
from forcefeel.envelope.plan import Plan, PlanOptions, make_plan
from forcefeel.envelope.result import CaseShares, Envelope, Shares
from forcefeel.envelope.run import Progress, compute
from forcefeel.errors import InputError
from forcefeel.laws.law import NAMED_LAWS, Law, drives_of, names_for, of_another_drive
from forcefeel.laws.law_file import LAW_FILE
from forcefeel.laws.sampled.grip import GRIP, no_sensor
from forcefeel.laws.sampled.law_designs import LAW_DESIGNS
from forcefeel.loader.loader import Loader
from forcefeel.loops.command_loop import command_loops
from forcefeel.loops.margins import LoopMargins, loop_margins, minimum_margins
from forcefeel.threads import side_by_side, threads_or_cores
from forcefeel.units import show

COARSE: Mapping[str, str] = MappingProxyType(
    {"stiffness": "1..100 %:6:log", "frequency": "0.5..4 Hz:4:log", "damping": "0.1, 0.3, 0.7, 1.5"}
)
"""96 settings: enough to compare laws in a minute."""

_OF_THE_REPORT = MappingProxyType(
    {
        "original": "the position loop of eq. (13), the feel computer's displacement as its command",
        "published": "the report's state feedback, recursion (22) over its horizon of 50 ms",
        "converged": "the report's state feedback, recursion (22) run until the gains converge",
    }
)


@dataclass(frozen=True, eq=False)
class OverEnvelope:
    """Results of a law over the settings of a grid.

    Attributes:
        shares: Shares that are stable and that pass, nominally and in every case.
        worst_case: Case with the largest loss of nominal passes; ``None`` without a loss.
        quiet: Share that is quiet in ``FEW_CONTACTS``; ``None`` for an analog loader, whose laws have no part for contact.
        settings: Number of settings.
        demand: Largest demand over the stable settings, nominal plant.
        margins: Smallest of each over the loader's own setting and the corners of the grid.
    """

    shares: Shares
    worst_case: CaseShares | None
    quiet: float | None
    settings: int
    demand: AnyDemand
    margins: LoopMargins


@dataclass(frozen=True, eq=False)
class Score:
    """Score of one law.

    Attributes:
        name: Its name.
        summary: One-line description.
        own: Results at the loader's own setting.
        over: Results over the grid; ``None`` if not computed.

    Example:
        >>> scored = ff.choice.score_laws(ff.digital_elevator(), ("robust",), over_envelope=False)
        >>> scored.scores[0].own.stable
        True
    """

    name: str
    summary: str
    own: OwnSetting
    over: OverEnvelope | None


@dataclass(frozen=True, eq=False)
class LawScores:
    """Scores of laws on one plan.

    Attributes:
        plan: Loader, settings, rule and cases.
        scores: One for each law.
    """

    plan: Plan
    scores: tuple[Score, ...] = field(repr=False)

    @property
    def sampled(self) -> bool:
        """Whether the loader has a digital controller."""
        return bool(self.plan.loader["controller.period"])


def score_laws(
    loader: Loader,
    names: Sequence[str] | None = None,
    grid: Mapping[str, str | Sequence[float]] = COARSE,
    *,
    over_envelope: bool = True,
    threads: int | None = None,
    progress: Progress = lambda done, total: None,
    **options: Unpack[PlanOptions],
) -> LawScores:
    """Design and score each law.

    Args:
        loader: The loader. Its own feel is the own setting of the scores; optional rows of the feel and an arm are omitted.
        names: Names of ``law.NAMED_LAWS``; default: all that the loader can run.
        grid: Settings, as in ``find_envelope``.
        over_envelope: Whether to score over the grid too, which takes most of the time.
        threads: Number of threads; default: all cores.
        progress: Called with the numbers of completed and of all releases.
        options: ``rule``, ``changes``, ``arms``, ``angle_rad``, as in ``find_envelope``.

    Returns:
        A score for each, in the order of ``names``.

    Raises:
        InputError: If an argument is invalid, or a law requires a digital controller and the loader is analog.

    Example:
        >>> scored = ff.choice.score_laws(ff.digital_elevator(), ("published", "robust"), over_envelope=False)
        >>> [(score.name, score.own.outcome) for score in scored.scores]
        [('published', 'P0'), ('robust', 'passes')]
    """
    chosen = names_for(loader) if names is None else tuple(names)
    check_names(loader, chosen)
    plan = make_plan(loader, chosen, grid, **options)
    envelope = compute(plan, threads=threads, progress=progress) if over_envelope else None
    scores = [
        Score(name, summary_of(name), own_setting(plan, plan.laws[name], threads_or_cores(threads)), None)
        for name in chosen
    ]
    if envelope is not None:
        scores = score_over(plan, scores, envelope, threads)
    return LawScores(plan, tuple(scores))


def check_names(loader: Loader, names: Sequence[str]) -> None:
    """Check that the laws exist and that the loader can run them.

    Raises:
        InputError: If not.
    """
    able = names_for(loader)
    for name in names:
        if name in NAMED_LAWS and loader.drive not in drives_of(name):
            raise of_another_drive(name, loader)
        if name == GRIP and name not in able and loader["controller.period"]:
            raise InputError(f"law: {no_sensor(loader)}")
        if name in NAMED_LAWS and name not in able:
            raise InputError(
                f"law: {name} requires a digital controller, and the loader is analog; set controller.period and controller.delay, "
                f"for example 0.5 ms each, use the built-in loader elevator-2khz, or choose one of {', '.join(able)}"
            )
        if name not in able and not name.endswith(LAW_FILE):
            raise InputError(f"law: expected {', '.join(able)}, got {show(name)}")


def summary_of(name: str) -> str:
    """One-line description of a law."""
    if name.endswith(LAW_FILE):
        return "the law of a file, unchanged"
    return LAW_DESIGNS[name].summary if name in LAW_DESIGNS else _OF_THE_REPORT[name]


def score_over(plan: Plan, scores: Sequence[Score], envelope: Envelope, threads: int | None = None) -> list[Score]:
    """Add the results over an envelope of the plan to scores of its laws."""
    return list(side_by_side(lambda score: _over(plan, score, envelope, threads), scores, threads_or_cores(threads)))


def _over(plan: Plan, score: Score, envelope: Envelope, threads: int | None) -> Score:
    name = score.name
    feel = plan.settings.feel(plan.loader)
    laws = Law.of(plan.laws[name], plan.loader, feel, name)
    lost = max(envelope.case_shares(name), key=lambda row: row.lost if row.lost > 0 else 0.0)
    corners = _corners(plan)
    loops = command_loops(plan.loader, laws.some(corners), feel[corners])
    margins = [score.own.margins, *map(loop_margins, loops)]
    over = OverEnvelope(
        shares=envelope.shares(name),
        worst_case=lost if lost.lost > 0 else None,
        quiet=_quiet(plan, laws, feel, threads) if plan.loader["controller.period"] else None,
        settings=len(feel),
        demand=_demand(plan, laws, feel, envelope.stable(name)[0]),
        margins=minimum_margins(margins),
    )
    return replace(score, over=over)


def _quiet(plan: Plan, laws: Law, feel: NDArray[np.float64], threads: int | None) -> float:
    """Share of the settings that are quiet in all of ``FEW_CONTACTS``."""
    return float(quiet_in_few(plan.loader, laws, feel, threads=threads).mean())


def _demand(plan: Plan, laws: Law, feel: NDArray[np.float64], stable: NDArray[np.bool_]) -> AnyDemand:
    """Largest demand over the stable settings, computed frequency by frequency."""
    frequency = plan.settings.rows[:, 1]
    pieces = [np.flatnonzero(stable & (frequency == value)) for value in plan.settings.frequency]
    return of_all(
        [
            largest_demand(plan.loader, laws.some(which), feel[which], plan.release_rad)
            for which in pieces
            if len(which)
        ],
        plan.loader.drive,
    )


def _corners(plan: Plan) -> NDArray[np.intp]:
    """Indices of the grid's corners among its settings."""
    ends = [(0, size - 1) for size in plan.settings.shape]
    return np.array([np.ravel_multi_index(corner, plan.settings.shape) for corner in product(*ends)], dtype=np.intp)
