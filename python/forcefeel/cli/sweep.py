"""``forcefeel sweep``."""

import shlex
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Group
from rich.table import Table

from forcefeel.cli.each_axis import each_axis
from forcefeel.cli.exit_status import BAD_ANSWER, INTERRUPTED
from forcefeel.cli.linked_options import LinkedOptions
from forcefeel.cli.options import OUTPUT, WORK, FolderOptions, LoaderOrProject, OutputOptions, ThreadOptions, option
from forcefeel.cli.progress import Bar
from forcefeel.cli.terminal import Terminal, answer, titled
from forcefeel.conclusions import share_text
from forcefeel.errors import InputError
from forcefeel.units import UnitSystem

if TYPE_CHECKING:
    from forcefeel.loader.project import Project
    from forcefeel.sweep import LinkedSweep, LinkedSweepResult, Sweep, SweepResult
    from forcefeel.sweep.summary import Summary

REDESIGNED = ("published", "converged")
"""Laws of which --redesign makes one for each setting."""


_MARKS = ("nominal", "lowest", "5 %", "median", "95 %", "highest")

SWEEP = Group("Sweep", sort_key=5)


@dataclass(frozen=True, kw_only=True)
class SweepOptions(LinkedOptions, FolderOptions, ThreadOptions, OutputOptions):
    """The options of ``forcefeel sweep``."""

    runs: Annotated[
        int | None,
        option(
            "Number of loaders drawn from the tolerances; with --grid, at each grid point. Of a project with links: of pairs.",
            SWEEP,
            default="10000; with --grid only the nominal loader; 1000 pairs",
        ),
    ] = None
    vary: Annotated[
        tuple[str, ...],
        option(
            "Additional or changed tolerance: 'linkage.stiffness=20 %', of a linked pair 'link.stiffness=10 %', "
            "'column.coulomb_friction=1 lb..5 lb', "
            '\'load_cell.gain={ normal = "2 %", low = "-6 %", high = "6 %" }\', \'valve.rated_flow=none\'. Repeatable.',
            SWEEP,
            metavar="NAME=TOLERANCE",
        ),
    ] = ()
    grid: Annotated[
        tuple[str, ...],
        option(
            "Values of a parameter: 'feel.stiffness=288..28800 lb in/rad:40:log' for 40 logarithmically spaced values. "
            "Use twice for a map.",
            SWEEP,
            metavar="NAME=VALUES",
        ),
    ] = ()
    redesign: Annotated[
        bool,
        option(
            "Design the gains of --law for each setting I, B, G of --grid or --vary, for the nominal machine. Default: "
            "one law, for the loader file's setting.",
            SWEEP,
        ),
    ] = False
    scheduler: Annotated[
        str | None,
        option(
            "Compute on a Dask cluster, such as tcp://host:8786. Requires the extra forcefeel[cluster].",
            WORK,
            metavar="ADDRESS",
        ),
    ] = None
    out: Annotated[Path, option("Folder for sweep.html, summary.json and runs.nc.", OUTPUT)] = Path("forcefeel-sweep")
    resume: Annotated[bool, option("Continue from the completed part in the folder.", OUTPUT)] = False

    def sweep(self, path: Path | None) -> "Sweep":
        """What is swept.

        Raises:
            InputError: If an option is bad or does not go with another.
        """
        from forcefeel.laws.law import named
        from forcefeel.sweep import Sweep, text

        loader = self.loader(path)
        scenario = self.scenario(loader)
        if self.redesign and self.law not in REDESIGNED:
            raise InputError("--redesign: is about designed gains; add --law published or converged")
        return Sweep(
            loader,
            scenario,
            named((str(self.law),), loader)[str(self.law)] if self.redesign else self.law_of(loader),
            runs=self.runs,
            seed=scenario.seed,
            vary=text.assignments("--vary", self.vary, "linkage.stiffness=20 %"),
            grids=text.assignments("--grid", self.grid, "feel.stiffness=1000..9000 lb in/rad:20"),
        )

    def linked_sweep(self, project: "Project") -> "LinkedSweep":
        """What is swept of a project with links.

        Raises:
            InputError: If an option is bad, or is for one loader.
        """
        from forcefeel.sweep import LinkedSweep, text
        from forcefeel.sweep.linked_plan import LINKED_RUNS

        for name, given in {
            "--grid": self.grid,
            "--redesign": self.redesign,
            "--scheduler": self.scheduler,
            "--resume": self.resume,
        }.items():
            if given:
                raise InputError(
                    f"{name}: is for one loader, and {project.path} has links; leave it out, or give a loader"
                )
        link, scenario = self.link_name(project), self.linked_scenario(project)
        first, second = (self.law_of(project.loaders[axis]) for axis in project.links[link].between)
        vary = text.assignments("--vary", self.vary, "link.stiffness=20 %")
        runs = LINKED_RUNS if self.runs is None else self.runs
        return LinkedSweep(project, link, scenario, (first, second), runs, scenario.first.seed, vary)


@each_axis(unless=lambda project: bool(project.links))
def run(path: LoaderOrProject = None, /, *, options: SweepOptions = SweepOptions()) -> None:
    """Simulate many loaders, drawn from the tolerances of the loader file or over a grid of settings.

    For a project with a table [links], simulate pairs: both loaders and the link are drawn.

    The results depend on the seed only, not on threads or workers. Ctrl-C keeps the completed part and prints the command that
    resumes it (exit status 130). Exit status 1 if a loader within the tolerances diverged.

    Example: forcefeel sweep my.toml --runs 100000 --out sweep
    """
    from forcefeel.simulation import RunStatus
    from forcefeel.sweep import run_sweep
    from forcefeel.sweep.as_json import sweep_json
    from forcefeel.sweep.page.page import FOLDER, RUNS_FOLDER, write_sweep
    from forcefeel.sweep.summary import summarize

    units = options.units
    if (project := options.linked_project(path)) is not None:
        _run_linked(path, project, options)
        return
    for part in (FOLDER, RUNS_FOLDER):  # before the work, not after it
        part.check(options.out)
        if not (options.replace or options.resume):
            part.check_script(options.out)
    sweep = options.sweep(path)
    law = str(options.law) if options.redesign else sweep.nominal_law.name
    with Bar("sweep", "runs", silent=options.json) as bar:
        try:
            result = run_sweep(
                sweep,
                options.out,
                scheduler=options.scheduler,
                threads=options.threads,
                resume=options.resume,
                replace=options.replace,
                progress=bar.show,
            )
            bar.describe("report")
            summary = summarize(result)
            page = write_sweep(result, summary, options.out, units, law, command=options.command_line(path))
        except KeyboardInterrupt:
            bar.stop()
            print(f"\nforcefeel: interrupted; {_resume_text(bar, options.out)}", file=sys.stderr)
            raise SystemExit(INTERRUPTED) from None
        except InputError as error:
            raise InputError(f"{error}\n{_resume_text(bar, options.out)}" if bar.done else str(error)) from error
    answer(
        {"page": page},
        lambda: sweep_json(result, summary, units),
        lambda terminal: _show(terminal, result, summary, units),
        as_json=options.json,
    )
    if not sweep.axes and summary.share(RunStatus.DIVERGED).runs:
        raise SystemExit(BAD_ANSWER)


def _run_linked(path: Path | None, project: "Project", options: SweepOptions) -> None:
    from forcefeel.sweep import run_linked_sweep, write_linked_sweep
    from forcefeel.sweep.linked_result import DIVERGED
    from forcefeel.sweep.page.linked_page import LINKED_FOLDER, linked_sweep_json

    LINKED_FOLDER.check(options.out, replace=options.replace)
    sweep = options.linked_sweep(project)
    with Bar("sweep", "pairs", silent=options.json) as bar:
        result = run_linked_sweep(sweep, threads=options.threads, progress=bar.show)
        bar.describe("report")
        page = write_linked_sweep(result, options.out, options.units, command=options.command_line(path))
    answer(
        {"page": page},
        lambda: linked_sweep_json(result, options.units),
        lambda terminal: _show_linked(terminal, result, options.units),
        as_json=options.json,
    )
    if result.share(DIVERGED).runs:
        raise SystemExit(BAD_ANSWER)


def _show_linked(console: Terminal, result: "LinkedSweepResult", units: UnitSystem) -> None:
    from forcefeel.sweep.findings import number_of
    from forcefeel.sweep.linked_result import LINKED_MEASURES, linked_sweep_conclusions

    table = titled(f"Link {result.sweep.link}", "measure", numbers=_MARKS)
    for name, spread in result.spreads.items():
        marks = (spread.nominal, spread.lowest, *map(spread.quantile, (0.05, 0.5, 0.95)), spread.highest)
        values = (number_of(spread.unit, value, units) for value in marks)
        table.add_row(f"{LINKED_MEASURES[name][0]}, {spread.unit.shown(units)}", *values)
    console.show(table)
    console.conclude(linked_sweep_conclusions(result, units))


def _resume_text(bar: Bar, out: Path) -> str:
    """What is kept, and the command that goes on."""
    words = [word for word in sys.argv[1:] if word not in {"--replace", "--resume"}]
    command = shlex.join(["forcefeel", *words, "--resume"])
    return f"{bar.done:,} of {bar.total:,} runs are kept in {out}; go on with: {command}"


def _show(console: Terminal, result: "SweepResult", summary: "Summary", units: UnitSystem) -> None:
    from forcefeel.sweep.findings import sweep_conclusions

    concluded = sweep_conclusions(result, summary, units)
    console.show(_measures(result, summary, units))
    ended = ", ".join(f"{share.status} {share_text(share.share)}" for share in summary.shares if share.runs)
    console.print(f"{result.sweep.total:,} runs: {ended}", highlight=False)
    console.conclude(concluded)


def _measures(result: "SweepResult", summary: "Summary", units: UnitSystem) -> Table:
    from forcefeel.sweep.findings import main_measures, number_of
    from forcefeel.sweep.summary import measure_name

    table = titled("Measures", "measure", numbers=_MARKS)
    for name in main_measures(result, summary):
        spread = summary.spreads[name]
        marks = (spread.nominal, spread.lowest, *map(spread.quantile, (0.05, 0.5, 0.95)), spread.highest)
        values = (number_of(spread.unit, value, units) for value in marks)
        table.add_row(f"{measure_name(name)}, {spread.unit.shown(units)}", *values)
    return table
