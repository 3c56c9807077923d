"""Plotly's script, by which a page draws its plots: one copy in a folder, beside the page."""

from functools import cache

SCRIPT = "plotly.min.js"
"""Its name in the folder."""


@cache
def script() -> str:
    """The script."""
    from plotly.offline import get_plotlyjs  # noqa: PLC0415  an extra; most folders hold no page

    return str(get_plotlyjs())
