"""Plotly's script, by which a page draws its plots: one copy in a folder, beside the page."""

from functools import cache

from plotly.offline import get_plotlyjs

SCRIPT = "plotly.min.js"
"""Its name in the folder."""


@cache
def script() -> str:
    """The script."""
    return str(get_plotlyjs())
