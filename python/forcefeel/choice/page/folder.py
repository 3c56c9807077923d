"""The folder of laws that were tried: the page and the results, whole or not at all."""

from pathlib import Path

from forcefeel.choice import Choice, LawScores
from forcefeel.choice.as_json import choice_json
from forcefeel.choice.page.page import choice_page
from forcefeel.json_values import json_text
from forcefeel.page.folder import OutputFolder
from forcefeel.units import UnitSystem

PAGE, RESULTS = "law.html", "results.json"
"""Names in the folder."""

FOLDER = OutputFolder("the laws", (PAGE, RESULTS))
"""Checked before the work, written after it."""


def write_choice(
    scored: LawScores, choice: Choice | None, out: Path, units: UnitSystem, *, replace: bool = False, command: str = ""
) -> Path:
    """Writes ``results.json`` and ``law.html``, the page last.

    What is there stays until the new files are complete; other files in the folder are left alone.

    Args:
        scored: The laws.
        choice: The choice among them; ``None`` for one law that was asked for by name.
        out: The folder; made if it is not there.
        units: The units of every number but those of the law in ``results.json``, which are SI.
        replace: Whether the new files may take the place of others.
        command: The command that asked for it, to stand on the page.

    Returns:
        The path of the page.

    Raises:
        InputError: If ``out`` is a file, holds files of these names that are not to be replaced, or cannot be written.

    Example:
        >>> import forcefeel as ff
        >>> from pathlib import Path
        >>> scored = ff.choice.score_laws(ff.digital_elevator(), ("published", "robust"), over_envelope=False)
        >>> ff.choice.write_choice(scored, None, Path("choice"), ff.UnitSystem.SI).parent.name
        'choice'
    """
    FOLDER.check(out, replace=replace)
    results = json_text(choice_json(scored, choice, units))
    FOLDER.write(out, {RESULTS: results, PAGE: choice_page(scored, choice, units, command=command)})
    return out / PAGE
