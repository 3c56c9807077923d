"""The page of a frontier: the template filled with curves, maps, tables and words."""

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


def frontier_page(found: Frontier, units: UnitSystem, *, command: str = "") -> str:
    """The whole page, numbers in ``units``."""
    plan = found.plan
    return render(
        "frontier/page/frontier.html.j2",
        command=command,
        loader=plan.given,
        plan=plan,
        motor=plan.loader.drive == ELECTRIC,
        law=name_text(found.law),
        goal=GOAL,
        goal_worst=f"{100 * WHOLE_WORST:.0f} %",
        inertia=tolerance_text(found.inertia_tolerance).replace(" ", "\N{NO-BREAK SPACE}"),
        conclusions=frontier_conclusions(found, units),
        curves=drawing(frontier_plots.shares(found), "shares"),
        tolerances=frontier_tables.tolerances(found),
        friction=frontier_tables.friction(found, units),
        panels=frontier_maps.panels(found, units),
        legend=frontier_maps.legend(found),
        spans=frontier_maps.spans(found, units),
        costs=frontier_tables.costs(found),
        hardware=frontier_tables.hardware(found),
        edges=frontier_tables.edges(found, units),
        grid=frontier_tables.grid(found, units),
        known=tolerances(plan.deviations),
        geometry=geometry_text(found),
        angle=quantity_text(plan.release_rad, ANGLE, units, 3),
        beyond=found.beyond_bound,
        parameters=machine.parameters(plan.given, units),
    )
