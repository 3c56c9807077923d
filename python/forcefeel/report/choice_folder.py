"""The folder of methods that were tried: the page and the results, whole or not at all."""

import json
from pathlib import Path

from forcefeel.choice import Choice, Scored
from forcefeel.choice.plain import plain_choice
from forcefeel.errors import InputError
from forcefeel.report.choice_page import choice_page
from forcefeel.report.staging import write_together
from forcefeel.units import UnitSystem

PAGE, RESULTS = "compensate.html", "results.json"
"""Names in the folder."""


def write_choice(scored: Scored, choice: Choice | None, out: Path, units: UnitSystem, *, replace: bool = False) -> Path:
    """Writes ``results.json`` and ``compensate.html``, the page last.

    What is there stays until the new files are complete; other files in the folder are left alone.

    Args:
        scored: The methods.
        choice: The choice among them; ``None`` for one method that was asked for by name.
        out: The folder; made if it is not there.
        units: The units of every number but those of the law in ``results.json``, which are SI.
        replace: Whether the new files may take the place of others.

    Returns:
        The path of the page.

    Raises:
        InputError: If ``out`` is a file, holds files of these names that are not to be replaced, or cannot be written.
    """
    check_choice_folder(out, replace=replace)
    results = json.dumps(plain_choice(scored, choice, units), indent=1, ensure_ascii=False, allow_nan=False) + "\n"
    write_together(out, {RESULTS: results, PAGE: choice_page(scored, choice, units)})
    return out / PAGE


def check_choice_folder(out: Path, *, replace: bool) -> None:
    """Refuses what would fail halfway: a file where a folder is wanted, a folder where a file is, files of somebody else.

    Raises:
        InputError: If so.
    """
    if out.exists() and not out.is_dir():
        raise InputError(
            f"{out}: is a file; expected a folder for the methods; name another one, or move the file away"
        )
    for name in (PAGE, RESULTS):
        if (out / name).is_dir():
            raise InputError(f"{out / name}: is a folder; expected to write a file of that name; move the folder away")
        if (out / name).exists() and not replace:
            raise InputError(f"{out}: holds {name} already; name another folder with --out, or --replace to replace it")
