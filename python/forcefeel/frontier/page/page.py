"""Page of a frontier: the template filled with curves, maps, tables and text."""

from forcefeel.envelope.findings import WHOLE_WORST, name_text
from forcefeel.envelope.page.tolerance_table import tolerances
from forcefeel.frontier.findings import GOAL, frontier_conclusions, geometry_text, tolerance_text
from forcefeel.frontier.page import maps as frontier_maps
from forcefeel.frontier.page import plots as frontier_plots
from forcefeel.frontier.page import tables as frontier_tables
from forcefeel.frontier.result import Frontier
from forcefeel.loader.parameters import ELECTRIC
from forcefeel.page import machine
from forcefeel.page.render import drawing, render
from forcefeel.page.typography import quantity_text
from forcefeel.units import ANGLE, UnitSystem


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
