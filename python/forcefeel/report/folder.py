"""The report's folder: everything is computed and written aside first, then put in place, the page last."""

from pathlib import Path

from forcefeel.errors import InputError
from forcefeel.figure_data import figures
from forcefeel.report.numbers import results_json
from forcefeel.report.page import page
from forcefeel.report.responses import csv, table
from forcefeel.report.staging import write_together
from forcefeel.units import UnitSystem
from forcefeel.workflow import Design

PAGE, RESULTS, RESPONSES = "report.html", "results.json", "responses"
"""Names in the folder."""


def write_report(design: Design, out: Path, units: UnitSystem) -> Path:
    """Writes ``report.html``, ``results.json`` and ``responses/figure-*.csv``.

    An existing report stays as it is until the new one is complete; other files in the folder are left alone.

    Args:
        design: What to report.
        out: The folder; made if it is not there.
        units: The units of every number.

    Returns:
        The path of the page.

    Raises:
        InputError: If ``out`` is a file, or cannot be made or written.
    """
    check_folder(out)
    write_together(out, _contents(design, units))
    return out / PAGE


def _contents(design: Design, units: UnitSystem) -> dict[str, str]:
    """Each file's text by its name within the folder, the page last."""
    drawn = figures(design)
    tables = {f"{RESPONSES}/{figure.key}.csv": table(figure, units) for figure in drawn}
    return {
        **{name: csv(data) for name, data in tables.items()},
        RESULTS: results_json(design, drawn, tables, units),
        PAGE: page(design, drawn, tuple(tables), units),
    }


def check_folder(out: Path) -> None:
    """Refuses what would fail halfway: a file where a folder is wanted, or a folder where a file is.

    Raises:
        InputError: If so.
    """
    if out.exists() and not out.is_dir():
        raise InputError(f"{out}: is a file; expected a folder for the report; name another one, or move the file away")
    for name in (PAGE, RESULTS):
        if (out / name).is_dir():
            raise InputError(f"{out / name}: is a folder; expected to write a file of that name; move the folder away")
    responses = out / RESPONSES
    if responses.exists() and not responses.is_dir():
        raise InputError(f"{responses}: is a file; expected a folder for the curves; move the file away")
