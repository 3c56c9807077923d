"""The folder of a sizing: page and results, written completely or not at all."""

from pathlib import Path

from forcefeel.json_values import json_text
from forcefeel.page.folder import OutputFolder
from forcefeel.sizing.as_json import cockpit_json, sizing_json
from forcefeel.sizing.cockpit import CockpitSizing
from forcefeel.sizing.page.page import cockpit_page, sizing_page
from forcefeel.sizing.result import Sizing
from forcefeel.units import UnitSystem

PAGE, RESULTS = "size.html", "results.json"
"""Names in the folder."""

FOLDER = OutputFolder("the sizing", (PAGE, RESULTS))
"""Checked before it is written."""


def write_sizing(sizing: Sizing, out: Path, units: UnitSystem, *, replace: bool = False, command: str = "") -> Path:
    """Writes ``results.json`` and ``size.html``, the page last; other files in the folder are left alone.

    Args:
        sizing: The sizing.
        out: The folder; created if it does not exist.
        units: The units of every number.
        replace: Whether existing files may be replaced.
        command: The command line, shown on the page.

    Returns:
        The path of the page.

    Raises:
        InputError: If ``out`` is a file, contains files of these names without ``replace``, or cannot be written.

    Example:
        >>> sizing = ff.sizing.size_drive(ff.elevator())
        >>> ff.sizing.write_sizing(sizing, Path("size"), ff.UnitSystem.US).name
        'size.html'
    """
    FOLDER.check(out, replace=replace)
    results = json_text(sizing_json(sizing, units))
    FOLDER.write(out, {RESULTS: results, PAGE: sizing_page(sizing, units, command=command)})
    return out / PAGE


def write_cockpit(
    cockpit: CockpitSizing, out: Path, units: UnitSystem, *, replace: bool = False, command: str = ""
) -> Path:
    r"""Writes ``results.json`` and ``size.html`` of a cockpit's drives, the page last.

    Args:
        cockpit: The sizing of each axis.
        out: The folder; created if it does not exist.
        units: The units of every number.
        replace: Whether existing files may be replaced.
        command: The command line, shown on the page.

    Returns:
        The path of the page.

    Raises:
        InputError: As ``write_sizing``.

    Example:
        >>> size = Path("cockpit.toml").write_text('[axes]\npitch = "elevator-electric"\n', encoding="utf-8")
        >>> cockpit = ff.sizing.size_cockpit(ff.loader.read_project("cockpit.toml"))
        >>> ff.sizing.write_cockpit(cockpit, Path("size"), ff.UnitSystem.US).name
        'size.html'
    """
    FOLDER.check(out, replace=replace)
    results = json_text(cockpit_json(cockpit, units))
    FOLDER.write(out, {RESULTS: results, PAGE: cockpit_page(cockpit, units, command=command)})
    return out / PAGE
