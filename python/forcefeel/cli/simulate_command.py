"""What ``forcefeel simulate`` does."""

from pathlib import Path

import typer
from rich.console import Console
from rich.table import Table

from forcefeel.cli.scenario_options import ScenarioOptions
from forcefeel.cli.terminal import Terminal, print_json
from forcefeel.conclusions import Conclusions
from forcefeel.loader.built_in import open_loader
from forcefeel.simulation import Run, RunStatus, simulate
from forcefeel.simulation.findings import input_text, run_conclusions
from forcefeel.simulation.tables import measure_rows, run_json
from forcefeel.units import UnitSystem


def run_simulate(
    path: Path | None, options: ScenarioOptions, out: Path | None, units: UnitSystem, *, as_json: bool
) -> None:
    """Runs one simulation and shows it, or writes it to a folder."""
    if out is not None:
        from forcefeel.simulation.page.folder import FOLDER  # noqa: PLC0415  Plotly

        FOLDER.check(out)  # before the work, not after it
    loader = options.changed(open_loader(path))
    scenario, driven_by = options.scenario(loader), options.law_of(loader)
    run = simulate(loader, scenario, driven_by)
    law = driven_by.name
    page = None
    if out is not None:
        from forcefeel.simulation.page.folder import write_simulation  # noqa: PLC0415

        page = write_simulation(run, out, units, law)
    if as_json:
        report = {} if page is None else {"page": str(page)}
        print_json({**report, **run_json(run, units, law)})
    else:
        _show(Terminal(), run, units)
        if page is not None:
            print(f"page: {page}")
    if run.status is RunStatus.DIVERGED:
        raise typer.Exit(1)


def _show(console: Console, run: Run, units: UnitSystem) -> None:
    found = run_conclusions(run, units)
    console.print(f"{run.loader.name}, {input_text(run.scenario.force, units)}", highlight=False)
    console.print(_measures(run, units))
    _say(console, found)


def _measures(run: Run, units: UnitSystem) -> Table:
    table = Table("measure", "value", title="Measures", title_justify="left", title_style="bold")
    for name, value, unit in measure_rows(run, units):
        table.add_row(name, f"{value} {unit}".rstrip())
    return table


def _say(console: Console, found: Conclusions) -> None:
    console.print(found.verdict, style="bold" if found.good else "bold red", highlight=False)
    for finding in found.findings:
        console.print(f"- {finding}", highlight=False)
