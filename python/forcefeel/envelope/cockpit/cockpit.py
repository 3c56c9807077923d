"""Envelopes of a cockpit: one for each axis of a project, and a table of all axes."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from math import isfinite, nan
from typing import Annotated

from forcefeel.conclusions import Conclusions, capital, of_result, share_text
from forcefeel.envelope.cases import Kind
from forcefeel.envelope.cockpit.pair import LINKED_SHARE, PairEnvelope, most_releases, pair_envelope, release_scenario
from forcefeel.envelope.findings import WHOLE_NOMINAL, WHOLE_WORST, angle_text, name_text, renders
from forcefeel.envelope.plan import Plan
from forcefeel.envelope.result import MOST, Envelope
from forcefeel.envelope.run import Progress, compute
from forcefeel.errors import InputError
from forcefeel.linked.engine import check_pair
from forcefeel.loader.axes import rule_axis
from forcefeel.loader.loader import Loader
from forcefeel.loader.project import Project
from forcefeel.threads import threads_or_cores
from forcefeel.units import ANGLE, PERCENT, UnitSystem

SHARES = ("nominal", "every case", f"in {share_text(MOST)} of machines")
"""Column heads of the shares."""


@dataclass(frozen=True)
class AxisRow:
    """One law on one axis, with shares of all settings.

    Attributes:
        axis, loader, drive, law: Their names.
        release_rad: Release angle.
        nominal_share: Passes with the nominal plant, hands off.
        worst_case_share: Passes in every case.
        drawn: Passes in most machines with all tolerances at once; NaN without drawn machines.
        worst_case: Case with the largest loss of nominal passes; empty without a loss.
        lost: Share of the nominal passes that it loses.
    """

    axis: str
    loader: str
    drive: str
    law: str
    release_rad: Annotated[float, ANGLE]
    nominal_share: Annotated[float, PERCENT]
    worst_case_share: Annotated[float, PERCENT]
    drawn: Annotated[float, PERCENT]
    worst_case: str
    lost: Annotated[float, PERCENT]

    @property
    def shares(self) -> tuple[str, ...]:
        """The shares as text, in the order of ``SHARES``."""
        return tuple(
            share_text(share) if isfinite(share) else "–"
            for share in (self.nominal_share, self.worst_case_share, self.drawn)
        )

    @property
    def worst_text(self) -> str:
        """The worst case as text."""
        if not self.nominal_share:
            return "–"
        return f"{self.worst_case} ({share_text(self.lost)})" if self.worst_case else "none"


@dataclass(frozen=True, eq=False)
class CockpitEnvelope:
    r"""The envelope of each axis and link of a cockpit.

    Attributes:
        name: Name of the project, from its file.
        axes: Envelopes by axis, in the order of the file.
        pairs: Envelopes of each link with both hands on, one for each law of both axes.
    """

    name: str
    axes: Mapping[str, Envelope]
    pairs: tuple[PairEnvelope, ...] = ()

    @property
    def rows(self) -> tuple[AxisRow, ...]:
        """A row for each axis and law."""
        return tuple(_row(axis, envelope, law) for axis, envelope in self.axes.items() for law in envelope.laws)


def find_cockpit(
    project: Project,
    plan: Callable[[Loader], Plan],
    *,
    threads: int | None = None,
    progress: Progress = lambda done, total: None,
) -> CockpitEnvelope:
    r"""Compute the envelope of each loader of a project, and of each linked pair.

    Args:
        project: The project.
        plan: Function from a loader to its plan. The rule's rows are those of the project's axis, not of the plan; of a stick
            those of pitch and roll.
        threads: Number of threads; default: all cores.
        progress: Called with the numbers of completed and of all releases.

    Raises:
        InputError: As ``find_envelope``, with the axis, and as ``simulate_linked``; all is checked before the computation.

    Example:
        >>> size = Path("cockpit.toml").write_text('[axes]\npitch = "elevator-1974"\n', encoding="utf-8")
        >>> grid = {"stiffness": "10..100 %:3:log", "frequency": "1..3 Hz:3", "damping": "0.3, 0.7"}
        >>> def plan(loader):
        ...     return ff.envelope.make_plan(loader, ["original"], grid)
        >>> cockpit = ff.envelope.find_cockpit(ff.loader.read_project("cockpit.toml"), plan)
        >>> [(row.axis, row.law) for row in cockpit.rows]
        [('pitch', 'original')]
    """
    plans = project.each(lambda axis, loader: replace(plan(loader), axis=rule_axis(axis)))
    linked = {link: (plans[link.between[0]], plans[link.between[1]]) for link in project.pilot_links.values()}
    for link, sides in linked.items():
        bare = {**project.loaders, **dict(zip(link.between, (plan.loader for plan in sides), strict=True))}
        try:
            check_pair(replace(project, loaders=bare), link.name, release_scenario(sides))
        except InputError as error:
            raise InputError(f"{project.path}: {error}") from error
    total = sum(plan.releases for plan in plans.values()) + sum(map(most_releases, linked.values()))
    done = 0

    def computed(axis: str, _: Loader) -> Envelope:
        nonlocal done
        before = done
        done += plans[axis].releases
        return compute(plans[axis], threads=threads, progress=lambda some, _: progress(before + some, total))

    def advance(some: int) -> None:
        nonlocal done
        done += some
        progress(done, total)

    axes = project.each(computed)
    cores = threads_or_cores(threads)
    pairs = tuple(
        pair_envelope(project, link, law, (axes[link.between[0]], axes[link.between[1]]), cores, advance)
        for link, (first, second) in linked.items()
        for law in first.laws
        if law in second.laws
    )
    return CockpitEnvelope(project.name, axes, pairs)


@of_result
def cockpit_conclusions(cockpit: CockpitEnvelope) -> Conclusions:
    """Axes that render their envelope, and the shares of each law on each axis."""
    short = [axis for axis, envelope in cockpit.axes.items() if not renders(envelope)]
    whole = f"{share_text(WHOLE_NOMINAL)} of the settings with the nominal plant and {share_text(WHOLE_WORST)} in every case"
    does = f"do{'es' if len(short) == 1 else ''} not render"
    verdict = capital(f"{', '.join(short)} {does} {whole}.") if short else f"Every axis renders {whole}."
    lines = []
    for axis, envelope in cockpit.axes.items():
        each = ", ".join(
            f"{share_text(row.nominal_share)} with {name_text(row.law)} ({share_text(row.worst_case_share)} in every case)"
            for row in cockpit.rows
            if row.axis == axis
        )
        lines.append(
            f"{capital(axis)}, {envelope.plan.given.name}: {each} of {envelope.plan.settings.count:,} programmed feels, released "
            f"from {angle_text(envelope.plan.release_rad, UnitSystem.SI)}."
        )
    lines += map(_pair_text, cockpit.pairs)
    few = [pair.link.name for pair in cockpit.pairs if not pair.linked_share >= LINKED_SHARE]
    if few:
        share = share_text(LINKED_SHARE)
        verdict += f" With both hands on, fewer than {share} of the settings rendered alone pass: {', '.join(few)}."
    return Conclusions(not short and not few, verdict, tuple(lines))


def _pair_text(pair: PairEnvelope) -> str:
    """Share of a pair with both hands on, and where it loses most."""
    between, rendered = " and ".join(pair.link.between), int(pair.rendered.sum())
    text = f"Link {pair.link.name}, {between}, {name_text(pair.law)}"
    if not rendered:
        return f"{text}: neither setting of {pair.settings.count:,} is rendered alone by both sides."
    text += (
        f": {share_text(pair.linked_share)} of {rendered:,} settings that both sides render alone are within tolerance with "
        f"every pair of arms; the required share is {share_text(LINKED_SHARE)}."
    )
    worst = min(pair.rows, key=lambda row: row.passes)
    if worst.passes < 1:
        failure, share = next(iter(pair.failures.items()))
        text += f" Fewest, {share_text(worst.passes)}, pass with {worst.first} and {worst.second}."
        text += f" Most frequent failure: {failure} ({share_text(share)})."
    return text


def _row(axis: str, envelope: Envelope, law: str) -> AxisRow:
    shares, loader = envelope.shares(law), envelope.plan.given
    cases = [row for kind in (Kind.PLANT, Kind.ARM) if (row := envelope.worst_case(law, kind)) is not None]
    worst = max(cases, key=lambda row: row.lost, default=None)
    return AxisRow(
        axis,
        loader.name,
        loader.drive,
        law,
        envelope.plan.release_rad,
        shares.nominal_share,
        shares.worst_case_share,
        envelope.drawn_shares(law).settings if envelope.plan.machines else nan,
        worst.case if worst else "",
        worst.lost if worst else 0.0,
    )
