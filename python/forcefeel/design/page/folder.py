"""The report's folder: all files are computed first, then written, the page last."""

from pathlib import Path

from forcefeel.design.figure import Figure
from forcefeel.design.figure_data import figures
from forcefeel.design.law_comparison import LawComparison
from forcefeel.design.motor_design import MotorDesign
from forcefeel.design.page.motor_page import motor_page
from forcefeel.design.page.numbers import results_json
from forcefeel.design.page.page import page
from forcefeel.design.page.responses import csv, table
from forcefeel.design.workflow import Design
from forcefeel.page.folder import OutputFolder
from forcefeel.units import UnitSystem

PAGE, RESULTS, RESPONSES = "report.html", "results.json", "responses"
"""Names in the folder."""

FOLDER = OutputFolder("the report", (PAGE, RESULTS), (RESPONSES,))
"""Checked before the work, written after it."""


def write_report(
    design: Design | MotorDesign, out: Path, units: UnitSystem, tried: LawComparison | None = None, *, command: str = ""
) -> Path:
    """Writes ``report.html``, ``results.json`` and a table of values for each figure in ``responses/``.

    An existing report stays as it is until the new one is complete; other files in the folder are left alone.

    Args:
        design: What to report.
        out: The folder; created if it does not exist.
        units: The units of every number.
        tried: Laws that were tried, for a loader with a digital controller, as ``choice.best_law`` gives them.
        command: The command line, shown on the page.

    Returns:
        The path of the page.

    Raises:
        InputError: If ``out`` is a file, or cannot be made or written.

    Example:
        >>> ff.design.write_report(ff.design_loader(ff.elevator()), Path("report"), ff.UnitSystem.SI).name
        'report.html'
    """
    FOLDER.check(out)
    FOLDER.write(out, _contents(design, units, tried, command))
    return out / PAGE


def _contents(
    design: Design | MotorDesign, units: UnitSystem, tried: LawComparison | None, command: str
) -> dict[str, str]:
    """Each file's text by its name within the folder, the page last."""
    drawn = figures(design)
    tables = {f"{RESPONSES}/{figure.key}.csv": table(figure, units) for figure in drawn}
    return {
        **{name: csv(data) for name, data in tables.items()},
        RESULTS: results_json(design, drawn, tables, units, tried),
        PAGE: _page(design, drawn, tuple(tables), units, tried=tried, command=command),
    }


def _page(
    design: Design | MotorDesign,
    drawn: tuple[Figure, ...],
    files: tuple[str, ...],
    units: UnitSystem,
    *,
    tried: LawComparison | None,
    command: str,
) -> str:
    if isinstance(design, MotorDesign):
        return motor_page(design, drawn, files, units, tried=tried, command=command)
    return page(design, drawn, files, units, tried=tried, command=command)
