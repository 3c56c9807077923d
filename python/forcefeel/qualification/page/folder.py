"""The folder of a qualification: page, results and PDF, written completely or not at all."""

from pathlib import Path

from forcefeel.json_values import json_text
from forcefeel.page.chromium import page_pdf
from forcefeel.page.folder import OutputFolder
from forcefeel.qualification.page.page import cockpit_page, qualification_page
from forcefeel.qualification.plan.as_json import cockpit_json, qualification_json
from forcefeel.qualification.plan.cockpit import CockpitQualification
from forcefeel.qualification.plan.result import Qualification
from forcefeel.units import Json, UnitSystem

PAGE, NUMBERS, PDF = "qualification.html", "results.json", "qualification.pdf"
"""Names in the folder."""

FOLDER = OutputFolder("the qualification", (PAGE, NUMBERS, PDF))
"""Checked before the work, written after it."""


def write_qualification(qualification: Qualification, out: Path, *, pdf: bool = False, command: str = "") -> Path:
    """Writes ``qualification.html``, ``results.json`` and, with ``pdf``, ``qualification.pdf``.

    Existing files stay until the new ones are complete; other files in the folder are not changed.

    Args:
        qualification: The qualification to report.
        out: The folder; created if it does not exist.
        pdf: Print the page too; requires Chromium.
        command: The command line, shown on the page.

    Returns:
        The path of the page.

    Raises:
        InputError: If ``out`` is a file or cannot be made or written, or the PDF cannot be printed.

    Example:
        >>> setup = ff.qualification.QualificationSetup(tests=("release-25-positive",))
        >>> qualification = ff.qualify_loader(ff.elevator(), setup)
        >>> ff.qualification.write_qualification(qualification, Path("my-tests")).parent.name
        'my-tests'
    """
    FOLDER.check(out)
    return _written(
        out,
        qualification_page(qualification, _beside(pdf), command=command),
        qualification_json(qualification),
        pdf=pdf,
    )


def write_cockpit(
    cockpit: CockpitQualification, out: Path, units: UnitSystem, *, pdf: bool = False, command: str = ""
) -> Path:
    r"""Writes the same files for a cockpit: one test guide over its axes.

    Args:
        cockpit: The qualification of each axis.
        out: The folder; made if it is not there.
        units: The units of the results.
        pdf: Print the page too; it takes a Chromium.
        command: The command that asked for it, to stand on the page.

    Returns:
        The path of the page.

    Raises:
        InputError: As ``write_qualification``.

    Example:
        >>> size = Path("cockpit.toml").write_text('[axes]\nyaw = "rudder-pedals"\n', encoding="utf-8")
        >>> one_test = ff.qualification.QualificationSetup(tests=("release-25-positive",))
        >>> cockpit = ff.qualification.qualify_cockpit(ff.loader.read_project("cockpit.toml"), lambda loader: one_test)
        >>> ff.qualification.write_cockpit(cockpit, Path("guide"), ff.UnitSystem.US).name
        'qualification.html'
    """
    FOLDER.check(out)
    return _written(out, cockpit_page(cockpit, _beside(pdf), command=command), cockpit_json(cockpit, units), pdf=pdf)


def _beside(pdf: bool) -> tuple[str, ...]:
    """Names of the other files in the folder."""
    return (NUMBERS, PDF) if pdf else (NUMBERS,)


def _written(out: Path, page: str, numbers: dict[str, Json], *, pdf: bool) -> Path:
    contents: dict[str, str | bytes] = {NUMBERS: json_text(numbers), PAGE: page}
    if pdf:
        contents = {PDF: page_pdf(page), **contents}
    FOLDER.write(out, contents)
    return out / PAGE
