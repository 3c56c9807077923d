"""A page from its template: in one file but for the script of its plots, which lies beside it, so that it opens offline."""

import re
from base64 import b64encode
from functools import cache
from hashlib import sha256
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

import jinja2
from markupsafe import Markup

from forcefeel.conclusions import capital
from forcefeel.page.palette import DARK
from forcefeel.page.script import CONFIG, SCRIPT
from forcefeel.page.typography import change_text, number_text, percent_text, prose_html, symbol_html, symbol_svg
from forcefeel.templating import environment

if TYPE_CHECKING:
    import plotly.graph_objects as go


def render(template: str, /, *, command: str, **values: Any) -> str:
    """The page of ``template`` with ``values``, the command that made it, the program's version and what draws its plots."""
    page = _templates().get_template(template)
    own = {"command": command, "version": version("forcefeel"), "script": SCRIPT, "config": CONFIG, "dark_colors": DARK}
    return with_policy(page.render(**own, **values))


def with_policy(page: str) -> str:
    """A page with its content security policy, in its head: no script but its own, no request but for its plots' script.

    An inline script is allowed by its hash, ``file:`` because Firefox takes no file for ``'self'``. Plotly sets styles by itself,
    and saves a picture by way of a ``blob:``.
    """
    hashes = {b64encode(sha256(script.encode()).digest()).decode(): None for script in _INLINE.findall(page)}
    sources = " ".join(["'self'", "file:", *(f"'sha256-{digest}'" for digest in hashes)])
    policy = f"default-src 'none'; script-src {sources}; {_OTHERS}"
    return page.replace("<head>\n", f'<head>\n<meta http-equiv="Content-Security-Policy" content="{policy}">\n', 1)


_INLINE = re.compile("<script>(.*?)</script>", re.DOTALL)
_OTHERS = "style-src 'unsafe-inline'; img-src data: blob:; base-uri 'none'; form-action 'none'"


def drawing(drawn: "go.Figure", key: str) -> Markup:
    """A plot for a page; ``key`` is its anchor."""
    from forcefeel.page.canvas import html  # noqa: PLC0415  Plotly is an extra, and a page may have no plot

    return html(drawn, key)


@cache
def _templates() -> jinja2.Environment:
    return environment(
        html=True,
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
