"""The report's folder: everything is computed and written aside first, then put in place, the page last."""

import contextlib
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path

from forcefeel.errors import InputError
from forcefeel.figure_data import figures
from forcefeel.report.numbers import results_json
from forcefeel.report.page import page
from forcefeel.report.responses import csv, table
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
    contents = _contents(design, units)
    with _explained(out), _staging(out) as aside:
        for name, text in contents.items():
            (aside / name).parent.mkdir(exist_ok=True)
            (aside / name).write_text(text, encoding="utf-8", newline="\n")
        (out / RESPONSES).mkdir(exist_ok=True)
        for name in contents:
            (aside / name).replace(out / name)
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


@contextlib.contextmanager
def _staging(out: Path) -> Iterator[Path]:
    """A folder within ``out``, so that a file moves into place in one step; gone afterwards."""
    made = _make(out)
    aside = Path(tempfile.mkdtemp(prefix=".forcefeel-", dir=out))
    try:
        yield aside
    except BaseException:
        shutil.rmtree(aside, ignore_errors=True)
        for folder in reversed(made):
            with contextlib.suppress(OSError):  # not empty: something of the report, or of others, is in it
                folder.rmdir()
        raise
    shutil.rmtree(aside, ignore_errors=True)


def _make(out: Path) -> list[Path]:
    """Makes ``out``; the folders that were not there before."""
    missing = [folder for folder in (*reversed(out.parents), out) if not folder.exists()]
    out.mkdir(parents=True, exist_ok=True)
    return missing


@contextlib.contextmanager
def _explained(out: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(
            f"{out}: cannot be written ({reason}); expected a folder that can be made or written"
        ) from error
