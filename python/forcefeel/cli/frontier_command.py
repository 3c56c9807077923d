"""What ``forcefeel frontier`` does."""

from dataclasses import dataclass
from pathlib import Path

from rich.console import Console
from rich.table import Table

from forcefeel.cli.envelope_command import release_angle
from forcefeel.cli.given_loader import given_deviations, given_loader
from forcefeel.cli.progress import all_or_nothing
from forcefeel.cli.terminal import Terminal, print_json
from forcefeel.conclusions import share_text
from forcefeel.envelope.plan import Plan
from forcefeel.frontier import Frontier
from forcefeel.frontier.as_json import frontier_json
from forcefeel.frontier.findings import frontier_conclusions, points_text, tolerance_text
from forcefeel.frontier.run import compute_frontier, frontier_plan
from forcefeel.qualification import DEFAULT_EDITION
from forcefeel.sweep import text
from forcefeel.units import UnitSystem


@dataclass(frozen=True)
class FrontierOptions:
    """The options as given; ``None`` is not given."""

    grid: list[str] | None
    compensator: str | None
    rule: str | None
    angle: str | None
    off: list[str] | None
    changes: list[str] | None
    out: Path
    replace: bool
    threads: int | None

    def plan(self, path: Path | None) -> Plan:
        """What is to be computed.

        Raises:
            InputError: If an option is bad.
        """
        angle = release_angle(self.angle)
        grid = text.assignments("--grid", self.grid, "stiffness=1..100 %:7:log")
        loader = given_loader(path, self.changes)
        options = {
            "rule": self.rule or DEFAULT_EDITION,
            "angle_rad": angle,
            "changes": given_deviations(loader, self.off),
        }
        return frontier_plan(loader, self.compensator, grid, **options)


def run_frontier(path: Path | None, options: FrontierOptions, units: UnitSystem, *, as_json: bool) -> None:
    """Computes a frontier and writes its folder."""
    from forcefeel.frontier.page.folder import FOLDER, write_frontier  # noqa: PLC0415  Plotly

    plan = options.plan(path)
    FOLDER.check(options.out, replace=options.replace)  # before the work, not after it
    with all_or_nothing(silent=as_json) as bar:

        def show(what: str, done: int, total: int) -> None:
            bar.describe(what)
            bar.show(done, total)

        found = compute_frontier(plan, threads=options.threads, progress=show)
        bar.describe("report")
        page = write_frontier(found, options.out, units, replace=options.replace)
    if as_json:
        print_json({"page": str(page), **frontier_json(found, units)})
    else:
        _show(Terminal(), found, units)
        print(f"page: {page}")


def _show(console: Console, found: Frontier, units: UnitSystem) -> None:
    console.print(_tolerances(found))
    console.print(_hardware(found))
    said = frontier_conclusions(found, units)
    console.print(said.verdict, style="bold", highlight=False)
    for finding in said.findings:
        console.print(f"- {finding}", highlight=False)


def _tolerances(found: Frontier) -> Table:
    tight, known = found.tightening.inertia_and_geometry, found.tightening.all_in_proportion
    table = Table("inertia known to", title="Passes in every case", title_justify="left", title_style="bold")
    for name in ("inertia and geometry tightened", "all in proportion", "bound on any linear law"):
        table.add_column(name, justify="right")
    bounds = dict(zip(found.bound.errors, found.bound.shares, strict=True))
    for tolerance, one, other in zip(tight.tolerances, tight.shares, known.shares, strict=True):
        bound = next((share for error, share in bounds.items() if abs(error - tolerance) < _SAME * tolerance), None)
        last = "" if bound is None else share_text(bound)
        table.add_row(tolerance_text(tolerance), share_text(one), share_text(other), last)
    return table


_SAME = 1e-6
"""Relative; tolerances that are the same but for rounding."""


def _hardware(found: Frontier) -> Table:
    table = Table("change", title="Points gained", title_justify="left", title_style="bold")
    for name in ("in every case", "nominally", "stable in every case"):
        table.add_column(name, justify="right")
    for gain in found.hardware:
        gains = (gain.worst_gain, gain.nominal_gain, gain.stable_worst_gain)
        table.add_row(gain.name, *map(points_text, gains))
    return table
