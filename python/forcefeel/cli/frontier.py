"""``forcefeel frontier``."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from rich.table import Table

from forcefeel.cli.law_option import LAW_METAVAR, LAW_NAMES, law_option_named
from forcefeel.cli.options import OUTPUT, FolderOptions, LoaderOrProject, OutputOptions, ThreadOptions, option
from forcefeel.cli.progress import all_or_nothing
from forcefeel.cli.release_options import ASKED, AngleOptions, ReleaseOptions
from forcefeel.cli.terminal import Terminal, answer, titled
from forcefeel.conclusions import share_text
from forcefeel.units import UnitSystem

if TYPE_CHECKING:
    from forcefeel.envelope.plan import Plan
    from forcefeel.frontier import Frontier
    from forcefeel.loader.project import Project


@dataclass(frozen=True, kw_only=True)
class FrontierOptions(ReleaseOptions, AngleOptions, FolderOptions, ThreadOptions, OutputOptions):
    """The options of ``forcefeel frontier``."""

    grid: Annotated[
        tuple[str, ...],
        option(
            "Values along an axis. Defaults, the centers of 140 cells: 'stiffness=1.39..72 %:7:log' (of G_max), "
            "'frequency=0.616..3.25 Hz:5:log', 'damping=0.1, 0.4, 0.7, 1.5'. Repeatable. Each setting takes about 550 "
            "releases.",
            ASKED,
            metavar="AXIS=VALUES",
        ),
    ] = ()
    law: Annotated[
        str | None,
        option(
            f"Law: {LAW_NAMES}; or a law file.",
            ASKED,
            default="robust; grip with a force sensor at the grip; published without a digital controller",
            metavar=LAW_METAVAR,
        ),
    ] = None
    out: Annotated[Path, option("Folder for frontier.html and results.json.", OUTPUT)] = Path("forcefeel-frontier")

    def plan(self, path: Path | None) -> "Plan":
        """What is to be computed.

        Raises:
            InputError: If an option is bad.
        """
        from forcefeel.frontier.run import frontier_plan
        from forcefeel.sweep import text

        grid = text.assignments("--grid", self.grid, "stiffness=1..100 %:7:log")
        loader = self.loader(path)
        changes = self.deviations(loader)
        with law_option_named():
            return frontier_plan(loader, self.law, grid, rule=self.rule, angle_rad=self.angle_rad, changes=changes)


def run(path: LoaderOrProject = None, /, *, options: FrontierOptions = FrontierOptions()) -> None:
    """Compute which feels this hardware cannot render, why, and the gain from tighter tolerances or other parts.

    Takes a few minutes with the default grid. For a project file with a table [links], computes the largest stable stiffness of
    each link over its delay and its injected damping.

    Example: forcefeel frontier elevator-2khz --out frontier
    """
    from forcefeel.frontier.as_json import frontier_json
    from forcefeel.frontier.page.page import FOLDER, write_frontier
    from forcefeel.frontier.run import compute_frontier

    FOLDER.check(options.out, replace=options.replace)  # before the work, not after it
    project = options.project(path, grid=options.grid, deviation=options.deviation, angle=options.angle)
    if project is not None:
        _links(project, path, options)
        return
    with all_or_nothing("frontier", "releases", silent=options.json) as bar:
        bar.describe("law")
        plan = options.plan(path)

        def show(what: str, done: int, total: int) -> None:
            bar.describe(what)
            bar.show(done, total)

        with law_option_named():
            frontier = compute_frontier(plan, threads=options.threads, progress=show)
        bar.describe("report")
        page = write_frontier(
            frontier, options.out, options.units, replace=options.replace, command=options.command_line(path)
        )
    answer(
        {"page": page},
        lambda: frontier_json(frontier, options.units),
        lambda terminal: _show(terminal, frontier, options.units),
        as_json=options.json,
    )


def _links(project: "Project", path: Path | None, options: FrontierOptions) -> None:
    from forcefeel.frontier.link_limits import link_conclusions, link_frontier
    from forcefeel.frontier.page.link_page import limit_heads, limit_rows, links_json, write_links

    with all_or_nothing("frontier", "runs", silent=options.json) as bar:

        def show(what: str, done: int, total: int) -> None:
            bar.describe(what)
            bar.show(done, total)

        with law_option_named():
            frontier = link_frontier(project, options.law, threads=options.threads, progress=show)
        command = options.command_line(path)
        page = write_links(frontier, options.out, options.units, replace=options.replace, command=command)

    def said(terminal: Terminal) -> None:
        for name, link in frontier.links.items():
            first, *numbers = limit_heads(link, options.units)
            table = titled(f"Largest stable stiffness of link {name}, law {link.law}", first, numbers=tuple(numbers))
            for row in limit_rows(link, options.units):
                table.add_row(*row)
            terminal.show(table)
        terminal.conclude(link_conclusions(frontier, options.units))

    answer({"page": page}, lambda: links_json(frontier, options.units), said, as_json=options.json)


def _show(console: Terminal, frontier: "Frontier", units: UnitSystem) -> None:
    from forcefeel.frontier.findings import frontier_conclusions

    console.show(_tolerances(frontier))
    console.show(_hardware(frontier))
    console.conclude(frontier_conclusions(frontier, units), alarming=False)


def _tolerances(frontier: "Frontier") -> Table:
    from forcefeel.frontier.findings import tolerance_text

    tight, known = frontier.tightening.inertia_and_geometry, frontier.tightening.all_in_proportion
    numbers = ("inertia and geometry tightened", "all in proportion", "bound on any linear law")
    table = titled("Passes in every case", "inertia known to", numbers=numbers)
    bounds = dict(zip(frontier.bound.errors, frontier.bound.shares, strict=True))
    for tolerance, worst_share, other in zip(tight.tolerances, tight.shares, known.shares, strict=True):
        bound = next((share for error, share in bounds.items() if abs(error - tolerance) < _SAME * tolerance), None)
        last = "" if bound is None else share_text(bound)
        table.add_row(tolerance_text(tolerance), share_text(worst_share), share_text(other), last)
    return table


_SAME = 1e-6
"""Relative; tolerances that are the same but for rounding."""


def _hardware(frontier: "Frontier") -> Table:
    from forcefeel.frontier.findings import points_text

    table = titled("Points gained", "change", numbers=("in every case", "nominally", "stable in every case"))
    for gain in frontier.hardware:
        gains = (gain.worst_gain, gain.nominal_gain, gain.stable_worst_gain)
        table.add_row(gain.name, *map(points_text, gains))
    return table
