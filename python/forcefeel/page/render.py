"""A page from its template: everything in one file, so that it opens offline."""

from functools import cache
from importlib.metadata import version
from typing import Any

import jinja2
import plotly.graph_objects as go
from markupsafe import Markup
from plotly.offline import get_plotlyjs

from forcefeel.conclusions import capital
from forcefeel.page.canvas import html
from forcefeel.page.typography import change_text, number_text, percent_text, prose_html, symbol_html, symbol_svg
from forcefeel.templating import environment


def render(template: str, /, **values: Any) -> str:
    """The page of ``template`` with ``values``, the program's version and Plotly's script."""
    page = _templates().get_template(template)
    return page.render(version=version("forcefeel"), plotly_js=Markup(get_plotlyjs()), **values)


def drawing(drawn: go.Figure, key: str) -> Markup:
    """A plot for a page; ``key`` is its anchor."""
    return Markup(html(drawn, key))


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
