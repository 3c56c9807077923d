"""Curves of a frontier: share of the settings over the tolerance of the column's inertia."""

from math import isfinite

import plotly.graph_objects as go

from forcefeel.envelope.findings import WHOLE_WORST
from forcefeel.frontier.findings import tolerance_text
from forcefeel.frontier.result import Frontier
from forcefeel.page.canvas import frame, line
from forcefeel.page.palette import COMPENSATED, COMPLIANT, IDEAL, LineStyle

_TICKS = (0.001, 0.01, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 30)
_SAID = (0.001, 0.01, 0.1, 0.5, 1, 2, 5, 10, 20)
"""Ticks with a number; on a phone there is no space for others."""


def shares(frontier: Frontier) -> go.Figure:
    """Bound and achieved shares over the tolerance of the column's inertia, with the tightening that reaches the goal."""
    picture, tight = go.Figure(), frontier.tightening
    curves = (
        ("bound on any linear law", frontier.bound.errors, frontier.bound.shares, LineStyle(IDEAL, "dot")),
        (
            "inertia and geometry tightened",
            tight.inertia_and_geometry.tolerances,
            tight.inertia_and_geometry.shares,
            LineStyle(COMPENSATED, "solid", 2.8),
        ),
        (
            "all tightened in proportion",
            tight.all_in_proportion.tolerances,
            tight.all_in_proportion.shares,
            LineStyle(COMPLIANT, "dash"),
        ),
    )
    for name, tolerances, shares_of_rungs, look in curves:
        picture.add_scatter(
            x=[100 * tolerance for tolerance in tolerances],
            y=[100 * share for share in shares_of_rungs],
            mode="lines+markers",
            name=name,
            line=line(look),
            marker={"size": 6, "color": look.color},
            hovertemplate="%{y:.3~g} %",
        )
    frame(picture, 420, top=64)
    picture.add_hline(100 * WHOLE_WORST, line={"color": "#6B7580", "width": 1, "dash": "dash"})
    needed = tight.inertia_and_geometry.needed
    if isfinite(needed):
        picture.add_scatter(
            x=[100 * needed],
            y=[100 * WHOLE_WORST],
            mode="markers",
            name=f"goal reached at {tolerance_text(needed)}",
            marker={"size": 13, "symbol": "diamond-open", "color": COMPENSATED, "line": {"width": 2.5}},
            hovertemplate="%{x:.2~g} %",
        )
    picture.update_xaxes(
        type="log",
        title_text="Column's inertia known to, ± %",
        tickvals=_TICKS,
        ticktext=[f"{tick:g}" if tick in _SAID else "" for tick in _TICKS],
        tickangle=0,
        hoverformat=".3~g",
    )
    picture.update_yaxes(title_text="Pass in every case, % of settings", range=[0, 102])
    return picture
