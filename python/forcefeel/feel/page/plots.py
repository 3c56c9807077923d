"""The plots of a fitted feel: force over position with the points, and the release over time."""

import numpy as np
import plotly.graph_objects as go

from forcefeel.feel.result import FeelFit, ReleaseFit
from forcefeel.page.canvas import ZERO, add_curve, drawn, frame
from forcefeel.page.palette import COMPENSATED, COMPLIANT, IDEAL, RIGID, LineStyle
from forcefeel.page.typography import heading_text
from forcefeel.units import ANGLE, FORCE, UnitSystem

_MOST_POINTS = 2000
"""Points and samples that are drawn; a plot has no more pixels."""
_WAYS = (("rising", 1.0, RIGID, "triangle-up"), ("falling", -1.0, COMPLIANT, "triangle-down"))
_STILL = ("without direction", 0.0, IDEAL, "circle")


def force_over_angle(fit: FeelFit, units: UnitSystem) -> go.Figure:
    """The programmed feel in both directions, and the measured points."""
    picture = go.Figure()
    angle, force = ANGLE.from_si(1.0, units), FORCE.from_si(1.0, units)
    hover = f"%{{x:.3~g}} {ANGLE.shown(units)}, %{{y:.3~g}} {FORCE.shown(units)}"
    lines = {"feel, rising": (fit.up_n, RIGID), "feel, falling": (fit.down_n, COMPLIANT)}
    if np.array_equal(fit.up_n, fit.down_n):
        lines = {"feel": (fit.up_n, COMPENSATED)}
    for name, (values, color) in lines.items():
        add_curve(picture, angle * fit.angle_rad, force * values, name, LineStyle(color, "solid", 2.2), hover)
    points = fit.points
    for name, direction, color, symbol in (*_WAYS, _STILL):
        which = np.flatnonzero(points.directions == direction)
        if not len(which):
            continue
        which = which[drawn(points.force_n[which], _MOST_POINTS)]
        picture.add_scatter(
            x=angle * points.position[which],
            y=force * points.force_n[which],
            mode="markers",
            name=f"points, {name}",
            marker={"symbol": symbol, "size": 9, "color": color, "line": {"width": 1, "color": "#FFFFFF"}},
            hovertemplate=hover,
        )
    frame(picture, 460, top=64, hover="closest")
    picture.update_xaxes(title_text=heading_text("Position from neutral", ANGLE, units), **ZERO)
    picture.update_yaxes(title_text=heading_text("Force at the grip", FORCE, units), **ZERO)
    return picture


def release_over_time(release: ReleaseFit, units: UnitSystem) -> go.Figure:
    """The recorded release and the programmed feel's."""
    picture = go.Figure()
    angle, record = ANGLE.from_si(1.0, units), release.record
    kept = drawn(record.position, _MOST_POINTS)
    add_curve(picture, record.time_s[kept], angle * record.position[kept], "record", LineStyle(COMPLIANT))
    shown = (release.time_s >= record.time_s[0]) & (release.time_s <= record.time_s[-1])
    time, position = release.time_s[shown], release.angle_rad[shown]
    kept = drawn(position, _MOST_POINTS)
    add_curve(picture, time[kept], angle * position[kept], "feel", LineStyle(COMPENSATED, "dash", 2.4))
    frame(picture, 380, top=48)
    picture.update_xaxes(title_text="Time, s")
    picture.update_yaxes(title_text=heading_text("Position", ANGLE, units), **ZERO)
    return picture
