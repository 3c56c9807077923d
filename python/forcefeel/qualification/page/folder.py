"""The folder of a qualification: its page, its numbers, and its PDF, whole or not at all."""

from pathlib import Path

from forcefeel.json_values import json_text
from forcefeel.page.chromium import page_pdf
from forcefeel.page.folder import OutputFolder
from forcefeel.qualification.page.page import qualification_page
from forcefeel.qualification.programme.as_json import qualification_json
from forcefeel.qualification.programme.result import Qualification

PAGE, NUMBERS, PDF = "qualification.html", "results.json", "qualification.pdf"
"""Names in the folder."""

FOLDER = OutputFolder("the qualification", (PAGE, NUMBERS, PDF))
"""Checked before the work, written after it."""


def write_qualification(found: Qualification, out: Path, *, pdf: bool = False, command: str = "") -> Path:
    """Writes ``qualification.html``, ``results.json`` and, if asked for, ``qualification.pdf``.

    What is there stays until the new files are complete; other files in the folder are left alone.

    Args:
        found: What to report.
        out: The folder; made if it is not there.
        pdf: Print the page too; it takes a Chromium.
        command: The command that asked for it, to stand on the page.

    Returns:
        The path of the page.

    Raises:
        InputError: If ``out`` is a file or cannot be made or written, or the PDF cannot be printed.

    Example:
        >>> import forcefeel as ff
        >>> from pathlib import Path
        >>> setup = ff.qualification.QualificationSetup(tests=("release-25-positive",))
        >>> found = ff.qualify_loader(ff.elevator(), setup)
        >>> ff.qualification.write_qualification(found, Path("tests-of-mine")).parent.name
        'tests-of-mine'
    """
    FOLDER.check(out)
    page = qualification_page(found, (NUMBERS, PDF) if pdf else (NUMBERS,), command=command)
    numbers = json_text(qualification_json(found))
    contents: dict[str, str | bytes] = {NUMBERS: numbers, PAGE: page}
    if pdf:
        contents = {PDF: page_pdf(page), **contents}
    FOLDER.write(out, contents)
    return out / PAGE
