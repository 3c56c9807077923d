"""The page of a run, the template filled with plots, tables and words, and its folder."""

from collections.abc import Sequence
from pathlib import Path

from forcefeel.json_values import json_text
from forcefeel.page import machine
from forcefeel.page.folder import OutputFolder
from forcefeel.page.picture import Picture
from forcefeel.page.render import render
from forcefeel.simulation import Run, RunStatus
from forcefeel.simulation.findings import input_text, run_conclusions
from forcefeel.simulation.page import plots as simulation_plots
from forcefeel.simulation.page import tables as simulation_tables
from forcefeel.simulation.programmed_feel import has_arm, ideal_angle
from forcefeel.simulation.tables import Column, columns, run_json
from forcefeel.tables.csv_table import csv_text
from forcefeel.units import Json, UnitSystem

SIMULATION, HISTORY, NUMBERS = "simulation.html", "history.csv", "results.json"

FOLDER = OutputFolder("the simulation", (SIMULATION, HISTORY, NUMBERS))

_MOTION = (
    "The column and the programmed control. The load cell's force is referred to the grip: at rest and without friction it equals "
    "the pilot's force."
)
_IDEAL = "Dotted: response of I, B and G alone to the same force."
_IDEAL_ARM = "Dotted: response of I, B and G with the pilot's arm to the same force."
_DIVERGED = "Drawn up to the divergence of the run, scaled to the first motion."
_DEMAND = "Demand on the drive. Red: ratings and limits near the curve."
_LOOP = "In slow motion without friction and hysteresis both directions coincide."


def simulation_page(run: Run, units: UnitSystem, law: str = "original", *, command: str = "") -> str:
    """The whole page; ``law`` is what the law that drove the servo is called."""
    return render(
        "simulation/page/simulation.html.j2",
        command=command,
        loader=run.loader,
        subject=input_text(run.scenario.force, units),
        conclusions=run_conclusions(run, units),
        pictures=_pictures(run, units),
        measures=simulation_tables.measured(run, units),
        effects=simulation_tables.effects(run, units),
        scenario=simulation_tables.scenario(run, units, law),
        parameters=machine.parameters(run.loader, units),
    )


def _pictures(run: Run, units: UnitSystem) -> dict[str, Picture]:
    diverged = run.status is RunStatus.DIVERGED
    ideal = None if diverged else ideal_angle(run)
    dotted = _IDEAL_ARM if has_arm(run.loader) else _IDEAL
    remarks = (_MOTION, "" if ideal is None else dotted, _DIVERGED if diverged else "")
    pictures = [
        Picture.of("motion", "", " ".join(filter(None, remarks)), simulation_plots.motion(run, ideal, units)),
        Picture.of("demand", "", _DEMAND, simulation_plots.demand(run, units)),
    ]
    if simulation_plots.has_loop(run):
        pictures.append(Picture.of("loop", "", _LOOP, simulation_plots.loop(run, units)))
    return {picture.key: picture for picture in pictures}


def write_simulation(run: Run, out: Path, units: UnitSystem, law: str = "original", *, command: str = "") -> Path:
    """Writes ``simulation.html``, ``history.csv`` and ``results.json``.

    What is there stays until the new files are complete; other files in the folder are left alone.

    Args:
        run: What to report.
        out: The folder; made if it is not there.
        units: The units of every number.
        law: What the law that drove the servo is called.
        command: The command that asked for it, to stand on the page.

    Returns:
        The path of the page.

    Raises:
        InputError: If ``out`` is a file, or cannot be made or written.

    Example:
        >>> run = ff.simulate(ff.elevator(), ff.Scenario(ff.Step(100.0), duration_s=0.5))
        >>> ff.simulation.write_simulation(run, Path("run"), ff.UnitSystem.SI).parent.name
        'run'
    """
    FOLDER.check(out)
    page = simulation_page(run, units, law, command=command)
    return write_run(out, columns(run, units), run_json(run, units, law), page)


def write_run(out: Path, history: Sequence[Column], document: dict[str, Json], page: str) -> Path:
    """Writes the folder of a run: its history, its results and its page."""
    heads = [f"{column.name} ({column.unit})".removesuffix(" ()") for column in history]
    rows = zip(*(column.values.tolist() for column in history), strict=True)
    results = document | {"history": {"file": HISTORY, "columns": heads}}
    FOLDER.write(out, {HISTORY: csv_text(heads, rows, ".9g"), NUMBERS: json_text(results), SIMULATION: page})
    return out / SIMULATION
