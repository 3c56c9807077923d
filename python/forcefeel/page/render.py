"""A page from its template: in one file but for the script of its plots, which lies beside it, so that it opens offline."""

from functools import cache
from importlib.metadata import version
from typing import Any

import jinja2
import plotly.graph_objects as go
from markupsafe import Markup

from forcefeel.conclusions import capital
from forcefeel.page.canvas import CONFIG, html
from forcefeel.page.palette import DARK
from forcefeel.page.script import SCRIPT
from forcefeel.page.typography import change_text, number_text, percent_text, prose_html, symbol_html, symbol_svg
from forcefeel.templating import environment


def render(template: str, /, *, command: str, **values: Any) -> str:
    """The page of ``template`` with ``values``, the command that made it, the program's version and what draws its plots."""
    page = _templates().get_template(template)
    own = {"command": command, "version": version("forcefeel"), "script": SCRIPT, "config": CONFIG, "dark_colors": DARK}
    return page.render(**own, **values)


def drawing(drawn: go.Figure, key: str) -> Markup:
    """A plot for a page; ``key`` is its anchor."""
    return html(drawn, key)


@cache
def _templates() -> jinja2.Environment:
    templates = environment(html=True)
    templates.filters.update(
        capital=capital,
        change=change_text,
        commas=lambda number: f"{number:,}",
        number=number_text,
        percent=percent_text,
        prose=prose_html,
        share=lambda share: f"{number_text(100 * share, 3)} %",
        span=symbol_svg,
        symbol=symbol_html,
    )
    return templates
