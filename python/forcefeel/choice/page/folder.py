"""Folder of a comparison of laws: page and results, written completely or not at all."""

from pathlib import Path

from forcefeel.choice import Choice, LawScores
from forcefeel.choice.as_json import choice_json
from forcefeel.choice.page.page import choice_page
from forcefeel.json_values import json_text
from forcefeel.page.folder import OutputFolder
from forcefeel.units import UnitSystem

PAGE, RESULTS = "law.html", "results.json"
"""File names."""

FOLDER = OutputFolder("the laws", (PAGE, RESULTS))
"""Checked before the computation, written after it."""


def write_choice(
    scored: LawScores, choice: Choice | None, out: Path, units: UnitSystem, *, replace: bool = False, command: str = ""
) -> Path:
    """Write ``results.json`` and ``law.html``, the page last.

    Existing files stay until the new ones are complete; other files in the folder are not touched.

    Args:
        scored: The laws with their scores.
        choice: The choice; ``None`` for one law requested by name.
        out: The folder; created if missing.
        units: Units of all numbers except those of the law in ``results.json``, which are SI.
        replace: Whether existing files may be replaced.
        command: Command line to show on the page.

    Returns:
        The path of the page.

    Raises:
        InputError: If ``out`` is a file, contains such files and ``replace`` is false, or cannot be written.

    Example:
        >>> scored = ff.choice.score_laws(ff.digital_elevator(), ("published", "robust"), over_envelope=False)
        >>> ff.choice.write_choice(scored, None, Path("choice"), ff.UnitSystem.SI).parent.name
        'choice'
    """
    FOLDER.check(out, replace=replace)
    results = json_text(choice_json(scored, choice, units))
    FOLDER.write(out, {RESULTS: results, PAGE: choice_page(scored, choice, units, command=command)})
    return out / PAGE
