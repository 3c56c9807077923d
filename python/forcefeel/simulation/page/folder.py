"""The folder of a simulation: page, history and results, written completely or not at all."""

import csv
import io
from pathlib import Path

from forcefeel.json_values import json_text
from forcefeel.page.folder import OutputFolder
from forcefeel.simulation import Run
from forcefeel.simulation.page.page import simulation_page
from forcefeel.simulation.tables import Column, columns, run_json
from forcefeel.units import UnitSystem

SIMULATION, HISTORY, NUMBERS = "simulation.html", "history.csv", "results.json"
"""Names in the folder."""

FOLDER = OutputFolder("the simulation", (SIMULATION, HISTORY, NUMBERS))
"""Checked before the work, written after it."""


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
    history = columns(run, units)
    heads = [f"{column.name} ({column.unit})" for column in history]
    document = run_json(run, units, law) | {"history": {"file": HISTORY, "columns": heads}}
    contents = {
        HISTORY: _csv(heads, history),
        NUMBERS: json_text(document),
        SIMULATION: simulation_page(run, units, law, command=command),
    }
    FOLDER.write(out, contents)
    return out / SIMULATION


def _csv(heads: list[str], history: tuple[Column, ...]) -> str:
    """The history with nine significant digits; its header as ``read_recorded`` asks for."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(heads)
    rows = zip(*(column.values.tolist() for column in history), strict=True)
    writer.writerows([f"{value:.9g}" for value in row] for row in rows)
    return text.getvalue()
