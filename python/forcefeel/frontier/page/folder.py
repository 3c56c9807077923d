"""Folder of a frontier: page and results, written completely or not at all."""

from pathlib import Path

from forcefeel.frontier import Frontier
from forcefeel.frontier.as_json import frontier_json
from forcefeel.frontier.page.page import frontier_page
from forcefeel.json_values import json_text
from forcefeel.page.folder import OutputFolder
from forcefeel.units import UnitSystem

PAGE, RESULTS = "frontier.html", "results.json"
"""File names."""

FOLDER = OutputFolder("the frontier", (PAGE, RESULTS))
"""Checked before the computation, written after it."""


def write_frontier(
    frontier: Frontier, out: Path, units: UnitSystem, *, replace: bool = False, command: str = ""
) -> Path:
    """Write ``results.json`` and ``frontier.html``, the page last; other files in the folder are not touched.

    Args:
        frontier: The frontier.
        out: The folder; made if it is not there.
        units: The units of every number.
        replace: Whether the new files may take the place of others.
        command: The command that asked for it, to stand on the page.

    Returns:
        The path of the page.

    Raises:
        InputError: If ``out`` is a file, holds files of these names that are not to be replaced, or cannot be written.

    Example:
        >>> grid = {"stiffness": "20, 100 %", "frequency": "1.5, 3 Hz", "damping": "0.3, 0.7"}
        >>> frontier = ff.find_frontier(ff.elevator(), "published", grid, changes={"column.inertia": 0.2}, arms=())
        >>> ff.frontier.write_frontier(frontier, Path("frontier"), ff.UnitSystem.SI).parent.name
        'frontier'
    """
    FOLDER.check(out, replace=replace)
    results = json_text(frontier_json(frontier, units))
    FOLDER.write(out, {RESULTS: results, PAGE: frontier_page(frontier, units, command=command)})
    return out / PAGE
