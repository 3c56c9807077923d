"""The envelopes of a cockpit: one for each axis of a project, and a table over them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from math import isfinite, nan
from typing import Annotated

from forcefeel.conclusions import Conclusions, capital, of_result, share_text
from forcefeel.envelope.cases import Kind
from forcefeel.envelope.findings import WHOLE_NOMINAL, WHOLE_WORST, angle_text, name_text, renders
from forcefeel.envelope.plan import Plan
from forcefeel.envelope.result import MOST, Envelope
from forcefeel.envelope.run import Progress, compute
from forcefeel.loader.axes import rule_axis
from forcefeel.loader.loader import Loader
from forcefeel.loader.project import Project
from forcefeel.units import ANGLE, PERCENT, UnitSystem

SHARES = ("nominal", "every case", f"in {share_text(MOST)} of machines")
"""Heads of the shares of a row."""


@dataclass(frozen=True)
class AxisRow:
    """One law on one axis, as the table over the axes has it; shares of all settings.

    Attributes:
        axis, loader, drive, law: Which.
        release_rad: Angle of its releases.
        nominal_share: Passes with the nominal plant, hands off.
        worst_case_share: Passes in every case.
        drawn: Passes in most of the machines with all tolerances at once; not a number where none were drawn.
        worst_case: The case that loses most of what passes nominally; empty where none loses any.
        lost: How much of it.
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
        """The shares as people read them, as ``SHARES``."""
        return tuple(
            share_text(share) if isfinite(share) else "–"
            for share in (self.nominal_share, self.worst_case_share, self.drawn)
        )

    @property
    def worst_text(self) -> str:
        """The worst case as people read it."""
        if not self.nominal_share:
            return "–"
        return f"{self.worst_case} ({share_text(self.lost)})" if self.worst_case else "none"


@dataclass(frozen=True, eq=False)
class CockpitEnvelope:
    r"""The envelope of each axis of a cockpit.

    Attributes:
        name: The project, by its file.
        axes: By axis, in the file's order.

    Example:
        >>> import forcefeel as ff
        >>> from pathlib import Path
        >>> size = Path("cockpit.toml").write_text('[axes]\npitch = "elevator"\n', encoding="utf-8")
        >>> grid = {"stiffness": "10..100 %:3:log", "frequency": "1..3 Hz:3", "damping": "0.3, 0.7"}
        >>> def plan(loader):
        ...     return ff.envelope.make_plan(loader, ["original"], grid)
        >>> cockpit = ff.envelope.find_cockpit(ff.loader.read_project("cockpit.toml"), plan)
        >>> cockpit.axes["pitch"].laws
        ('original',)
    """

    name: str
    axes: Mapping[str, Envelope]

    @property
    def rows(self) -> tuple[AxisRow, ...]:
        """The table over the axes, a row for each law of each."""
        return tuple(_row(axis, envelope, law) for axis, envelope in self.axes.items() for law in envelope.laws)


def find_cockpit(
    project: Project,
    plan: Callable[[Loader], Plan],
    *,
    threads: int | None = None,
    progress: Progress = lambda done, total: None,
) -> CockpitEnvelope:
    r"""Which programmed feels each loader of a project renders.

    Args:
        project: The project.
        plan: What is to be computed of a loader of it. The rule's rows are those of its axis, whatever the plan says; of a stick
            those of pitch and roll.
        threads: How many; all cores if not given.
        progress: Called with the releases that are done and all there are.

    Raises:
        InputError: As ``find_envelope``, with the axis; all plans are made before the work.

    Example:
        >>> import forcefeel as ff
        >>> from pathlib import Path
        >>> size = Path("cockpit.toml").write_text('[axes]\npitch = "elevator"\n', encoding="utf-8")
        >>> grid = {"stiffness": "10..100 %:3:log", "frequency": "1..3 Hz:3", "damping": "0.3, 0.7"}
        >>> def plan(loader):
        ...     return ff.envelope.make_plan(loader, ["original"], grid)
        >>> cockpit = ff.envelope.find_cockpit(ff.loader.read_project("cockpit.toml"), plan)
        >>> [(row.axis, row.law) for row in cockpit.rows]
        [('pitch', 'original')]
    """
    plans = project.each(lambda axis, loader: replace(plan(loader), axis=rule_axis(axis)))
    total = sum(plan.releases for plan in plans.values())
    done = 0

    def computed(axis: str, _: Loader) -> Envelope:
        nonlocal done
        before = done
        done += plans[axis].releases
        return compute(plans[axis], threads=threads, progress=lambda some, _: progress(before + some, total))

    return CockpitEnvelope(project.name, project.each(computed))


@of_result
def cockpit_conclusions(cockpit: CockpitEnvelope) -> Conclusions:
    """Which axes render their envelope, and what each of them renders by its best law."""
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
    return Conclusions(not short, verdict, tuple(lines))


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
