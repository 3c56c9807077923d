"""``forcefeel simulate``."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from rich.table import Table

from forcefeel.cli.each_axis import each_axis
from forcefeel.cli.exit_status import BAD_ANSWER
from forcefeel.cli.linked_options import LinkedOptions
from forcefeel.cli.options import OUTPUT, FolderOptions, LoaderOrProject, OutputOptions, SoftenOption, option
from forcefeel.cli.progress import all_or_nothing
from forcefeel.cli.terminal import Terminal, answer, titled
from forcefeel.errors import InputError
from forcefeel.units import UnitSystem

if TYPE_CHECKING:
    from forcefeel.linked import LinkedRun
    from forcefeel.loader.project import Project
    from forcefeel.simulation import Run


@dataclass(frozen=True, kw_only=True)
class SimulateOptions(LinkedOptions, FolderOptions, OutputOptions):
    """The options of ``forcefeel simulate``."""

    soften: SoftenOption = False
    out: Annotated[Path | None, option("Folder for simulation.html, history.csv and results.json.", OUTPUT)] = None


@each_axis(unless=lambda project: bool(project.links))
def run(path: LoaderOrProject = None, /, *, options: SimulateOptions = SimulateOptions()) -> None:
    """Simulate the loader in time, with the nonlinear effects of its file.

    For a project file with a table [links], simulate both linked loaders; without one, each axis. Values are text with a unit, such
    as '20 lb'. Times without a unit are in seconds. Exit status 1 if the run diverged.

    Example: forcefeel simulate my.toml --input release --angle '10 deg' --out run
    """
    from forcefeel.simulation import RunStatus, simulate
    from forcefeel.simulation.tables import run_json

    out, units = options.out, options.units
    if out is not None:
        from forcefeel.simulation.page.page import FOLDER  # Plotly

        FOLDER.check(out, replace=options.replace)  # before the work, not after it
    if (project := options.linked_project(path)) is not None:
        _run_linked(path, project, options)
        return
    loader = options.loader(path)
    with all_or_nothing("simulate", silent=options.json):
        softened = None
        if options.soften:
            from forcefeel.envelope import soften

            softened = soften(loader)
            loader = softened.loader
        scenario, driven_by = options.scenario(loader), options.law_of(loader)
        run = replace(simulate(loader, scenario, driven_by), softened=softened)
        law = driven_by.name
        page = None
        if out is not None:
            from forcefeel.simulation.page.page import write_simulation

            page = write_simulation(run, out, units, law, command=options.command_line(path))
    files = {} if page is None else {"page": page}
    answer(
        files,
        lambda: run_json(run, units, law),
        lambda terminal: _show(terminal, run, units),
        as_json=options.json,
    )
    if run.status is RunStatus.DIVERGED:
        raise SystemExit(BAD_ANSWER)


def _run_linked(path: Path | None, project: "Project", options: SimulateOptions) -> None:
    from forcefeel.linked import simulate_linked
    from forcefeel.linked.tables import linked_json

    if options.soften:
        raise InputError("--soften: is for one loader; leave it out, or simulate the loader of one axis")
    with all_or_nothing("simulate", silent=options.json):
        link, scenario = options.link_name(project), options.linked_scenario(project)
        laws = [options.law_of(project.loaders[axis]) for axis in project.links[link].between]
        run = simulate_linked(project, link, scenario, *laws)
        files = {}
        if options.out is not None:
            from forcefeel.linked import write_linked

            files["page"] = write_linked(run, options.out, options.units, command=options.command_line(path))
    answer(
        files,
        lambda: linked_json(run, options.units),
        lambda terminal: _show_linked(terminal, run, options.units),
        as_json=options.json,
    )
    if run.diverged:
        raise SystemExit(BAD_ANSWER)


def _show_linked(console: Terminal, run: "LinkedRun", units: UnitSystem) -> None:
    from forcefeel.linked.findings import hands_text, linked_conclusions
    from forcefeel.linked.tables import measure_rows

    console.print(hands_text(run, units), highlight=False)
    table = titled(f"Link {run.link.name}", "measure", "value")
    for name, value, unit in measure_rows(run, units):
        table.add_row(name, f"{value} {unit}".rstrip())
    console.show(table)
    console.conclude(linked_conclusions(run, units))


def _show(console: Terminal, run: "Run", units: UnitSystem) -> None:
    from forcefeel.simulation.findings import input_text, run_conclusions

    concluded = run_conclusions(run, units)
    console.print(f"{run.loader.name}, {input_text(run.scenario.force, units)}", highlight=False)
    console.show(_measures(run, units))
    console.conclude(concluded)


def _measures(run: "Run", units: UnitSystem) -> Table:
    from forcefeel.simulation.tables import measure_rows

    table = titled("Measures", "measure", "value")
    for name, value, unit in measure_rows(run, units):
        table.add_row(name, f"{value} {unit}".rstrip())
    return table
