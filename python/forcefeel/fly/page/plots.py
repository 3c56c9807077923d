"""The plots of a report in flight: force over load factor and speed with the limits, time histories of the maneuvers."""

import numpy as np
import plotly.graph_objects as go
from numpy.typing import NDArray
from plotly.subplots import make_subplots

from forcefeel.conclusions import capital
from forcefeel.fly.maneuvers import Maneuver
from forcefeel.fly.report import FORCE_OVER_SPEED, HISTORIES, FlightReport, Point
from forcefeel.fly.rules import FlightVerdict
from forcefeel.page.canvas import ZERO, add_curve, drawn, frame
from forcefeel.page.palette import COMPENSATED, COMPLIANT, LineStyle
from forcefeel.page.typography import heading_text
from forcefeel.units import AIRSPEED, ANGLE, ANGULAR_VELOCITY, FORCE, LOAD_FACTOR, Unit, UnitSystem

_LOADER, _FEEL, _LIMIT = (
    LineStyle(COMPLIANT, "solid", 2.4),
    LineStyle(COMPENSATED, "dash"),
    LineStyle("#B3261E", "dot", 1.8),
)
_MOST_POINTS = 1500
_HAND = {"force": FORCE, "control": ANGLE}
_OF_AXIS = {
    "pitch": {"load_factor": LOAD_FACTOR, "calibrated_airspeed": AIRSPEED},
    "roll": {"roll_rate": ANGULAR_VELOCITY, "bank": ANGLE},
    "yaw": {"yaw_rate": ANGULAR_VELOCITY, "sideslip": ANGLE},
}
_TITLES = {"calibrated_airspeed": "Airspeed"}
"""Where the name is too long for an axis."""


def drawn_states(maneuver: Maneuver, axis: str) -> dict[str, Unit]:
    """States that are drawn, with their units: those that a rule compares, else those of the axis."""
    return HISTORIES.get(maneuver.name, _OF_AXIS[axis])


def force_over_load_factor(report: FlightReport, units: UnitSystem) -> go.Figure:
    """The held pulls, and the limits of a force per g or at the limit load factor."""
    picture = go.Figure()
    still = report.case.trim.state()["load_factor"]
    flown = _add_held(picture, report.pulls, "load_factor", LOAD_FACTOR, (still, units))
    ends = np.array([still, max(flown, default=still)])
    for verdict in report.verdicts:
        if verdict.quantity == "force per g" and verdict.unit:
            _add_limit(picture, verdict, ends, -FORCE.from_si(verdict.limit, units) * (ends - still))
        if verdict.quantity == "force at the limit load factor" and verdict.unit:
            at = report.case.trim.data.limit_load_factor
            level = np.full(2, -FORCE.from_si(verdict.limit, units))
            _add_limit(picture, verdict, np.array([at - 0.3 * (at - still), at]), level)
    frame(picture, 420, top=64, hover="closest")
    picture.update_xaxes(title_text="Load factor, g")
    picture.update_yaxes(title_text=heading_text("Force at the grip, push positive", FORCE, units), **ZERO)
    return picture


def force_over_speed(report: FlightReport, units: UnitSystem) -> go.Figure:
    """The held speeds, and the least average gradient through the trim speed."""
    picture = go.Figure()
    trim = report.case.speed_m_per_s
    flown = _add_held(picture, report.speeds, "speed_m_per_s", AIRSPEED, (trim, units))
    ends = np.array([min(flown, default=trim), max(flown, default=trim)])
    for verdict in report.verdicts:
        if verdict.quantity == "average force over speed" and verdict.unit:
            slope = FORCE_OVER_SPEED.from_si(verdict.limit, UnitSystem.SI)
            level = FORCE.from_si(1.0, units) * slope * (ends - trim)
            _add_limit(picture, verdict, AIRSPEED.from_si(1.0, units) * ends, level)
    frame(picture, 420, top=64, hover="closest")
    picture.update_xaxes(title_text=heading_text("Calibrated airspeed", AIRSPEED, units))
    picture.update_yaxes(title_text=heading_text("Force at the grip, push positive", FORCE, units), **ZERO)
    return picture


def _add_held(
    picture: go.Figure, points: tuple[Point, ...], name: str, unit: Unit, trim: tuple[float, UnitSystem]
) -> list[float]:
    """Points through the loader and the line of the feel, from the trimmed flight on; their positions in SI."""
    at_trim, units = trim
    held = sorted(
        ((getattr(point.held, name), point.held.force_n, point.held.feel_n) for point in points if point.held),
        key=lambda row: float(row[0]),
    )
    hover = f"%{{x:.4~g}} {unit.shown(units)}, %{{y:.3~g}} {FORCE.shown(units)}"
    scale, force = unit.from_si(1.0, units), FORCE.from_si(1.0, units)
    line = np.array(sorted([*((x, feel) for x, _, feel in held), (at_trim, 0.0)])).T
    add_curve(picture, scale * line[0], force * line[1], "feel alone", _FEEL, hover)
    picture.add_scatter(
        x=[scale * x for x, _, _ in held],
        y=[force * y for _, y, _ in held],
        mode="markers",
        name="with the loader",
        marker={"size": 10, "color": COMPLIANT, "line": {"width": 1, "color": "#FFFFFF"}},
        hovertemplate=hover,
    )
    return [x for x, _, _ in held]


def _add_limit(picture: go.Figure, verdict: FlightVerdict, x: NDArray[np.float64], y: NDArray[np.float64]) -> None:
    name = f"{verdict.rule.number.partition(' ')[0]}, {verdict.bound}"
    add_curve(picture, x, y, name, _LIMIT)


_LEAST = {"control": 0.1}
"""Value that an axis has at least, in its displayed unit: the noise of a sensor is not to fill it."""


def histories(maneuver: Maneuver, axis: str, units: UnitSystem) -> go.Figure:
    """Force, control angle and states over time, through the loader and on the feel alone."""
    drawings = _HAND | drawn_states(maneuver, axis)
    picture = make_subplots(rows=len(drawings), cols=1, shared_xaxes=True, vertical_spacing=0.04)
    for name, look, flown in (("with the loader", _LOADER, maneuver.flown), ("feel alone", _FEEL, maneuver.alone)):
        rows = {"force": flown.force_n, "control": flown.angle_rad, **flown.states}
        for k, (key, unit) in enumerate(drawings.items(), 1):
            title = _TITLES.get(key, capital(key.replace("_", " ")))
            values = unit.from_si(1.0, units) * rows[key]
            kept = drawn(values, _MOST_POINTS)
            hover = f"%{{y:.3~g}} {unit.shown(units)}"
            more = {"row": k, "col": 1, "showlegend": k == 1, "legendgroup": name}
            add_curve(picture, flown.time_s[kept], values[kept], name, look, hover, **more)
            least = [_LEAST[key] * sign for sign in (-1, 1)] if key in _LEAST else None
            picture.update_yaxes(
                title_text=heading_text(title, unit, units),
                exponentformat="none",  # an altitude is read in plain numbers
                autorangeoptions={"include": least},
                row=k,
                col=1,
            )
    frame(picture, 80 + 135 * len(drawings), top=48)
    picture.update_xaxes(title_text="Time, s", row=len(drawings), col=1)
    return picture
