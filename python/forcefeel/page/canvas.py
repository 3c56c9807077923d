"""The frame that every plot shares: fonts, axes, legend and how it behaves in the page."""

from typing import Any

import numpy as np
import plotly.graph_objects as go
from markupsafe import Markup
from numpy.typing import ArrayLike, NDArray
from plotly.io.json import to_json_plotly

from forcefeel.page.description import described
from forcefeel.page.palette import LineStyle
from forcefeel.page.script import SCRIPT

_INK, _GRID, _AXIS = "#222222", "#E4E7EB", "#8A939E"
_MARK = "#6B7580"
_FONT = 'system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif'

_TOOLS_PX = 30
"""Room right of the curves, in which the tool bar stands: above them it would hide the legend."""

ZERO = {"zeroline": True, "zerolinecolor": _MARK, "zerolinewidth": 1.5}
"""For an axis whose zero matters."""

_AXIS_STYLE = {
    "gridcolor": _GRID,
    "linecolor": _AXIS,
    "zeroline": False,
    "showline": True,
    "mirror": True,
    "ticks": "outside",
    "tickcolor": _AXIS,
    "exponentformat": "power",
    "hoverformat": ".4~g",
    "title": {"standoff": 8, "font": {"size": 13}},
}

# A template is checked once; as settings of each axis of each figure the same would be checked again and again.
_TEMPLATE = go.layout.Template(
    layout={
        "autosize": True,
        "font": {"family": _FONT, "size": 13, "color": _INK},
        "paper_bgcolor": "rgba(0,0,0,0)",
        "plot_bgcolor": "#FFFFFF",
        "hoverlabel": {"bgcolor": "#FFFFFF", "bordercolor": _AXIS},
        "legend": {
            "orientation": "h",
            "x": 0,
            "xanchor": "left",
            "y": 1.01,
            "yanchor": "bottom",
            "font": {"size": 12.5},
        },
        "modebar": {
            "orientation": "v",
            "bgcolor": "rgba(255,255,255,0.85)",
            "color": "#9AA3AD",
            "activecolor": _INK,
        },
        "xaxis": _AXIS_STYLE,
        # Long tick labels push the title away from the axis.
        "yaxis": _AXIS_STYLE | {"automargin": True},
    }
)


def frame(picture: go.Figure, height: int, *, top: int = 32, hover: str = "x unified") -> go.Figure:
    """Gives ``picture`` the shared look.

    Args:
        picture: The plot.
        height: Height in pixels; the width is the page's.
        top: Room for the legend in pixels; it takes more if it needs more.
        hover: Plotly's hover mode.
    """
    margin = {"l": 66, "r": _TOOLS_PX, "t": top, "b": 48}
    return picture.update_layout(template=_TEMPLATE, height=height, margin=margin, hovermode=hover)


def line(look: LineStyle) -> dict[str, Any]:
    """Plotly's line for a look."""
    return {"color": look.color, "dash": look.dash, "width": look.width, "simplify": False}


def add_curve(
    picture: go.Figure, x: ArrayLike, y: ArrayLike, name: str, look: LineStyle, hover: str | None = None, **more: Any
) -> None:
    """Adds a line to a plot; ``more`` as Plotly takes it, such as ``row`` and ``col`` of the panel."""
    picture.add_scatter(x=x, y=y, mode="lines", name=name, line=line(look), hovertemplate=hover, **more)


def mark_level(picture: go.Figure, level: float, *, row: int) -> None:
    """Draws a thin line across one panel at a value that matters, such as 0 dB."""
    if level == 0:
        picture.update_yaxes(**ZERO, row=row, col=1)
    else:
        picture.add_hline(level, row=row, col=1, line={"color": _MARK, "width": 1})


def html(picture: go.Figure, name: str) -> Markup:
    """The plot as a piece of HTML that the page's script draws; without it, a sentence that says what is missing."""
    document = picture.to_plotly_json()
    return _PLOT.format(
        name=name,
        says=described(picture),
        script=SCRIPT,
        data=Markup(to_json_plotly(document["data"])),
        layout=Markup(to_json_plotly(document["layout"])),
    )


_PLOT = Markup(
    '<div id="{name}" class="plotly-graph-div" role="group" aria-label="{says}"><p class="missing">This plot is drawn by {script}, '
    "which did not load: it must lie in one folder with this page, as forcefeel writes them.</p></div>\n"
    '<script>draw("{name}", {data}, {layout})</script>'
)


def drawn(values: NDArray[np.float64], most: int) -> NDArray[np.intp]:
    """Which samples are drawn: all up to ``most``, or of each stretch the lowest and the highest, so that no extreme is lost."""
    count = len(values)
    if count <= most:
        return np.arange(count)
    stretches = most // 2
    length = -(-count // stretches)
    padded = np.pad(values, (0, stretches * length - count), mode="edge").reshape(stretches, length)
    starts = np.arange(stretches) * length
    kept = np.concatenate([[0, count - 1], starts + padded.argmin(axis=1), starts + padded.argmax(axis=1)])
    return np.unique(np.minimum(kept, count - 1))
