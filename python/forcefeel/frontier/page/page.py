"""Page of a frontier, the template filled with curves, maps, tables and text, and its folder."""

from pathlib import Path

from forcefeel.envelope.findings import WHOLE_WORST, name_text
from forcefeel.envelope.page.tolerance_table import tolerances
from forcefeel.frontier.as_json import frontier_json
from forcefeel.frontier.findings import GOAL, frontier_conclusions, geometry_text, tolerance_text
from forcefeel.frontier.page import maps as frontier_maps
from forcefeel.frontier.page import plots as frontier_plots
from forcefeel.frontier.page import tables as frontier_tables
from forcefeel.frontier.result import Frontier
from forcefeel.json_values import json_text
from forcefeel.loader.parameters import ELECTRIC
from forcefeel.page import machine
from forcefeel.page.folder import OutputFolder
from forcefeel.page.render import drawing, render
from forcefeel.page.typography import quantity_text
from forcefeel.units import ANGLE, UnitSystem

PAGE, RESULTS = "frontier.html", "results.json"

FOLDER = OutputFolder("the frontier", (PAGE, RESULTS))


def frontier_page(frontier: Frontier, units: UnitSystem, *, command: str = "") -> str:
    """The page, with numbers in ``units``."""
    plan = frontier.plan
    return render(
        "frontier/page/frontier.html.j2",
        command=command,
        loader=plan.given,
        plan=plan,
        motor=plan.loader.drive == ELECTRIC,
        law=name_text(frontier.law),
        goal=GOAL,
        goal_worst=f"{100 * WHOLE_WORST:.0f} %",
        inertia=tolerance_text(frontier.inertia_tolerance).replace(" ", "\N{NO-BREAK SPACE}"),
        conclusions=frontier_conclusions(frontier, units),
        curves=drawing(frontier_plots.shares(frontier), "shares"),
        tolerances=frontier_tables.tolerances(frontier),
        friction=frontier_tables.friction(frontier, units),
        panels=frontier_maps.panels(frontier, units),
        legend=frontier_maps.legend(frontier),
        spans=frontier_maps.spans(frontier, units),
        costs=frontier_tables.costs(frontier),
        hardware=frontier_tables.hardware(frontier),
        edges=frontier_tables.edges(frontier, units),
        grid=frontier_tables.grid(frontier, units),
        known=tolerances(plan.deviations),
        geometry=geometry_text(frontier),
        angle=quantity_text(plan.release_rad, ANGLE, units, 3),
        beyond=frontier.beyond_bound,
        parameters=machine.parameters(plan.given, units),
    )


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
