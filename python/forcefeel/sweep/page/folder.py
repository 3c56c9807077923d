"""Report of a sweep in its folder: page, summary and band of responses, whole or not at all."""

import csv
import io
from pathlib import Path

from forcefeel.json_values import json_text
from forcefeel.page.folder import OutputFolder
from forcefeel.sweep import SweepResult
from forcefeel.sweep.as_json import sweep_json
from forcefeel.sweep.folder import CHUNKS, PLAN, RUNS
from forcefeel.sweep.page.page import sweep_page
from forcefeel.sweep.summary import Summary
from forcefeel.units import ANGLE, UnitSystem

PAGE, SUMMARY, ENVELOPE = "sweep.html", "summary.json", "envelope.csv"
"""Names in the folder."""

FOLDER = OutputFolder("the sweep", (PAGE, SUMMARY, ENVELOPE))
"""Files of the report."""

RUNS_FOLDER = OutputFolder("the sweep", (PLAN, RUNS), (CHUNKS,), plots=False)
"""Files of the runs."""


def write_sweep(
    result: SweepResult, summary: Summary, out: Path, units: UnitSystem, law: str = "original", *, command: str = ""
) -> Path:
    """Write ``sweep.html``, ``summary.json`` and, for a sweep without grid, ``envelope.csv``.

    Existing files stay until the new ones are complete; other files in the folder are kept.

    Args:
        result: The sweep.
        summary: Its summary.
        out: The folder; created if missing.
        units: The units of every number.
        law: Name of the law.
        command: The command, for the page.

    Returns:
        The path of the page.

    Raises:
        InputError: If ``out`` is a file, or cannot be made or written.

    Example:
        >>> found = ff.run_sweep(ff.Sweep(ff.elevator(), ff.Scenario(ff.Step(100.0), 0.5), runs=32))
        >>> ff.sweep.write_sweep(found, ff.sweep.summarize(found), Path("sweep"), ff.UnitSystem.SI).parent.name
        'sweep'
    """
    FOLDER.check(out)
    contents = {
        SUMMARY: json_text(sweep_json(result, summary, units)),
        PAGE: sweep_page(result, summary, units, law, command=command),
    }
    if not result.sweep.axes:
        contents = {ENVELOPE: _envelope(result, units), **contents}
    FOLDER.write(out, contents)
    return out / PAGE


def _envelope(result: SweepResult, units: UnitSystem) -> str:
    """The edges of the band over time."""
    band = result.envelope
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["time (s)", *(f"{edge} ({ANGLE.shown(units)})" for edge in band["edge"].values)])
    columns = band["column_angle_rad"].values * ANGLE.from_si(1.0, units)
    for time, *angles in zip(band["time_s"].values.tolist(), *columns.tolist(), strict=True):
        writer.writerow([f"{time:.9g}", *(f"{angle:.9g}" for angle in angles)])
    return text.getvalue()
