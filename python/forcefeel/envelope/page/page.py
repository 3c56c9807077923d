"""The page of an envelope: the template filled with maps, tables and words."""

from functools import cache
from importlib.metadata import version
from typing import Any

import jinja2
from markupsafe import Markup
from plotly.offline import get_plotlyjs

from forcefeel.envelope.as_json import releases
from forcefeel.envelope.findings import envelope_conclusions
from forcefeel.envelope.page import maps as envelope_maps
from forcefeel.envelope.page import plots as envelope_plots
from forcefeel.envelope.page import tables as envelope_tables
from forcefeel.envelope.page.tolerance_table import tolerances
from forcefeel.envelope.result import Envelope
from forcefeel.page import machine
from forcefeel.page.canvas import html
from forcefeel.page.typography import number_text, prose_html, quantity_text
from forcefeel.templating import environment
from forcefeel.units import ANGLE, UnitSystem


def envelope_page(found: Envelope, units: UnitSystem) -> str:
    """The whole page, numbers in ``units``."""
    plan = found.plan
    shares = [(name, found.shares(name)) for name in found.compensators]
    return (
        _environment()
        .get_template("envelope.html.j2")
        .render(
            loader=plan.given,
            plan=plan,
            version=version("forcefeel"),
            conclusions=envelope_conclusions(found, units),
            compensators=shares,
            shares=envelope_tables.shares(found),
            legend=envelope_maps.legend(found),
            shows_own=envelope_maps.shows_own(found),
            spans=envelope_maps.spans(found, units),
            nominal=envelope_maps.rows(found, worst=False),
            worst=envelope_maps.rows(found, worst=True),
            failures=envelope_tables.failures(found),
            cases=envelope_tables.cases(found),
            drawn=envelope_tables.drawn(found) if plan.machines else None,
            counted=envelope_tables.counted(found),
            tolerances=tolerances(plan.deviations),
            smallest=envelope_tables.smallest(found, units),
            impedance=Markup(html(envelope_plots.impedance(found), "impedance")),
            passive=envelope_tables.passive(found),
            grid=envelope_tables.grid(found, units),
            arms=envelope_tables.arms(found),
            angle=quantity_text(plan.release_rad, ANGLE, units, 3),
            releases=f"{releases(found):,}",
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
        "capital": envelope_tables.capital,
        "percent": lambda share: f"{number_text(100 * share, 3)} %",
    }
    templates.filters.update(filters)
    return templates
