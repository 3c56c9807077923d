"""The page of a frontier: the template filled with curves, maps, tables and words."""

from functools import cache
from importlib.metadata import version
from typing import Any

import jinja2
from markupsafe import Markup
from plotly.offline import get_plotlyjs

from forcefeel.envelope.findings import WHOLE_WORST, name_text
from forcefeel.envelope.page.tolerance_table import tolerances
from forcefeel.frontier.findings import GOAL, frontier_conclusions, geometry_text, tolerance_text
from forcefeel.frontier.page import maps as frontier_maps
from forcefeel.frontier.page import plots as frontier_plots
from forcefeel.frontier.page import tables as frontier_tables
from forcefeel.frontier.result import Frontier
from forcefeel.page import machine
from forcefeel.page.canvas import html
from forcefeel.page.typography import number_text, prose_html, quantity_text
from forcefeel.templating import environment
from forcefeel.units import ANGLE, UnitSystem


def frontier_page(found: Frontier, units: UnitSystem) -> str:
    """The whole page, numbers in ``units``."""
    plan = found.plan
    return (
        _environment()
        .get_template("frontier.html.j2")
        .render(
            loader=plan.given,
            plan=plan,
            version=version("forcefeel"),
            law=name_text(found.compensator),
            goal=GOAL,
            goal_worst=f"{100 * WHOLE_WORST:.0f} %",
            inertia=tolerance_text(found.inertia_tolerance).replace(" ", "\N{NO-BREAK SPACE}"),
            conclusions=frontier_conclusions(found, units),
            curves=Markup(html(frontier_plots.shares(found), "shares")),
            tolerances=frontier_tables.tolerances(found),
            panels=frontier_maps.panels(found),
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
            plotly_js=Markup(get_plotlyjs()),
        )
    )


@cache
def _environment() -> jinja2.Environment:
    templates = environment(html=True)
    filters: dict[str, Any] = {
        "prose": prose_html,
        "commas": lambda number: f"{number:,}",
        "percent": lambda share: f"{number_text(100 * share, 3)} %",
    }
    templates.filters.update(filters)
    return templates
