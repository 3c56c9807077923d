"""The folder of a frontier: its page and its results, whole or not at all."""

import json
from pathlib import Path

from forcefeel.errors import InputError
from forcefeel.frontier import Frontier
from forcefeel.frontier.plain import plain_frontier
from forcefeel.report.frontier_page import frontier_page
from forcefeel.report.staging import write_together
from forcefeel.units import UnitSystem

PAGE, RESULTS = "frontier.html", "results.json"
"""Names in the folder."""


def write_frontier(found: Frontier, out: Path, units: UnitSystem, *, replace: bool = False) -> Path:
    """Writes ``results.json`` and ``frontier.html``, the page last; other files in the folder are left alone.

    Args:
        found: The frontier.
        out: The folder; made if it is not there.
        units: The units of every number.
        replace: Whether the new files may take the place of others.

    Returns:
        The path of the page.

    Raises:
        InputError: If ``out`` is a file, holds files of these names that are not to be replaced, or cannot be written.
    """
    check_frontier_folder(out, replace=replace)
    results = json.dumps(plain_frontier(found, units), indent=1, ensure_ascii=False, allow_nan=False) + "\n"
    write_together(out, {RESULTS: results, PAGE: frontier_page(found, units)})
    return out / PAGE


def check_frontier_folder(out: Path, *, replace: bool) -> None:
    """Refuses what would fail halfway: a file where a folder is wanted, a folder where a file is, files of somebody else.

    Raises:
        InputError: If so.
    """
    if out.exists() and not out.is_dir():
        raise InputError(
            f"{out}: is a file; expected a folder for the frontier; name another one, or move the file away"
        )
    for name in (PAGE, RESULTS):
        if (out / name).is_dir():
            raise InputError(f"{out / name}: is a folder; expected to write a file of that name; move the folder away")
        if (out / name).exists() and not replace:
            raise InputError(f"{out}: holds {name} already; name another folder with --out, or --replace to replace it")
