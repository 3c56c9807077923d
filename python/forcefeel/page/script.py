"""Plotly's script, by which a page draws its plots: one copy in a folder, beside the page."""

from functools import cache

SCRIPT = "plotly.min.js"
"""Its name in the folder."""

CONFIG = {
    "responsive": True,
    "displaylogo": False,
    "displayModeBar": "hover",
    "showSendToCloud": False,
    "plotlyServerURL": "",
    "modeBarButtonsToRemove": ["select2d", "lasso2d", "zoomIn2d", "zoomOut2d"],
}
"""Plotly's configuration: no logo, nothing that sends a loader's data to anybody, and only the buttons that a reader uses."""


@cache
def script() -> str:
    """The script."""
    from plotly.offline import get_plotlyjs  # noqa: PLC0415  an extra; most folders hold no page

    return str(get_plotlyjs())
