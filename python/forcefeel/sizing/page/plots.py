"""Force over speed at the grip: demands and capability."""

import plotly.graph_objects as go

from forcefeel.page.canvas import add_curve, frame
from forcefeel.page.palette import COMPENSATED, COMPLIANT, IDEAL, RIGID, LineStyle
from forcefeel.page.typography import heading_text
from forcefeel.sizing.demand import Duration
from forcefeel.sizing.result import DemandResult, Sizing
from forcefeel.units import FORCE, SPEED, UnitSystem

_CURVES = (LineStyle(COMPENSATED, "solid", 2.8), LineStyle(RIGID, "dash", 2.2))
_FEEL = ("diamond", "square")
_RULE = ("circle", "circle-open", "triangle-up")


def force_over_speed(sizing: Sizing, units: UnitSystem) -> go.Figure:
    """The drive's limits and the release as curves, held forces as marks at zero speed."""
    picture = go.Figure()
    for curve, look in zip(sizing.curves, _CURVES, strict=False):
        x, y = SPEED.from_si(1.0, units) * curve.speed_m_per_s, FORCE.from_si(1.0, units) * curve.force_n
        add_curve(picture, x, y, curve.name, look, "%{y:.3~g}")
    feel, rule = iter(_FEEL), iter(_RULE)
    for demand in sizing.demands:
        if demand.duration is Duration.MOVING:
            _path(picture, demand, units)
        else:
            symbol, color = (next(feel), COMPLIANT) if demand.programmed else (next(rule), IDEAL)
            _mark(picture, demand, units, symbol, color)
    frame(picture, 460, top=64, hover="closest")
    picture.update_xaxes(title_text=heading_text("Speed of the grip", SPEED, units), rangemode="tozero")
    picture.update_yaxes(title_text=heading_text("Force at the grip", FORCE, units), rangemode="tozero")
    return picture


def _path(picture: go.Figure, demand: DemandResult, units: UnitSystem) -> None:
    add_curve(
        picture,
        SPEED.from_si(1.0, units) * demand.path_speed_m_per_s,
        FORCE.from_si(1.0, units) * demand.path_force_n,
        demand.name,
        LineStyle(COMPLIANT),
        "%{x:.3~g}, %{y:.3~g}",
    )


def _mark(picture: go.Figure, demand: DemandResult, units: UnitSystem, symbol: str, color: str) -> None:
    picture.add_scatter(
        x=[0.0],
        y=[FORCE.from_si(demand.force_n, units)],
        mode="markers",
        name=demand.name,
        marker={"symbol": symbol, "size": 11, "color": color, "line": {"width": 2, "color": color}},
        cliponaxis=False,
        hovertemplate="%{y:.3~g}",
    )
