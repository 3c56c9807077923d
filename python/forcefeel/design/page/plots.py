"""The figures drawn, one function per kind."""

from collections.abc import Callable

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from forcefeel.design.figure import Figure, Kind
from forcefeel.design.motor_design import MotorDesign
from forcefeel.design.motor_figures import FORCE, LOOP, POSITION, STEP
from forcefeel.design.page.stability import AnyDesign, departs, is_unstable
from forcefeel.page.canvas import add_curve, frame, line, mark_level
from forcefeel.page.palette import LineStyle, look
from forcefeel.page.signals import signal
from forcefeel.page.typography import parameter_text, unit_text
from forcefeel.tables.labeled_arrays import LabeledArrays
from forcefeel.units import UnitSystem

CUT = 2.5
"""An unstable curve is drawn until it leaves this many times the ideal's peak, or the valve's rating."""

_FREQUENCY_TICKS = (0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)
_MOST_TICKS = 10
"""That stand beside one another in half a page."""

_SAME = 1e-9
"""Relative; the end of a range that is the same but for rounding."""

_PAIRED = 76
"""Room for two lines of legend, so that plots side by side have their axes at the same height."""

_BESIDE = {"figure-08", "figure-09", FORCE, POSITION}
"""Frequency responses that stand side by side."""

_VIEW_BELOW, _VIEW_ABOVE = -0.6, 1.6
"""What is in view where a curve is unstable, in peaks of the ideal."""


def draw(figure: Figure, design: AnyDesign, system: UnitSystem) -> go.Figure:
    """``figure`` as a Plotly figure with the units of ``system``."""
    drawings: dict[Kind, Callable[[Figure, AnyDesign, UnitSystem], go.Figure]] = {
        Kind.VALVE: _valve,
        Kind.FREQUENCY: _frequency,
        Kind.TIME: _demand if figure.key in {"figure-14", STEP} else _time,
    }
    return drawings[figure.kind](figure, design, system)


def _valve(figure: Figure, design: AnyDesign, system: UnitSystem) -> go.Figure:
    picture = go.Figure()
    units = ["", ""]
    for position, (label, data) in enumerate(figure.curves.items()):
        pressure, flow = (_in_units(data, name, system) for name in ("load_pressure_pa", "flow_m3_per_s"))
        units = [unit_text(pressure[1]), unit_text(flow[1])]
        style = look(figure.key, label, position)
        add_curve(picture, pressure[0], flow[0], label.replace("%", " %"), style)
    supply = parameter_text(design.loader, "valve.supply_pressure", system)
    frame(picture, 440)
    picture.update_xaxes(title_text=f"Load pressure p, {units[0]} (supply {supply})")
    picture.update_yaxes(title_text=f"Flow q, {units[1]}", rangemode="tozero")
    return picture


def _frequency(figure: Figure, design: AnyDesign, system: UnitSystem) -> go.Figure:
    picture = make_subplots(rows=2, cols=1, shared_xaxes=True, vertical_spacing=0.05)
    for position, (label, data) in enumerate(figure.curves.items()):
        style = line(look(figure.key, label, position))
        frequency = data["frequency_hz"]
        for row, name, unit in ((1, "gain_db", "dB"), (2, "phase_deg", "°")):
            picture.add_scatter(
                x=frequency,
                y=data[name],
                name=label,
                legendgroup=label,
                showlegend=row == 1,
                line=style,
                mode="lines",
                hovertemplate=f"%{{y:.1f}} {unit}" if unit == "dB" else f"%{{y:.1f}}{unit}",
                row=row,
                col=1,
            )
    frame(picture, 560, top=_PAIRED if figure.key in _BESIDE else 32)
    mark_level(picture, 0.0, row=1)
    if figure.key in {"figure-08", "figure-10", LOOP}:
        mark_level(picture, -180.0, row=2)
    low, high = (float(frequency[end]) for end in (0, -1))
    ticks = [tick for tick in _FREQUENCY_TICKS if low * (1 - _SAME) <= tick <= high * (1 + _SAME)]
    if len(ticks) > _MOST_TICKS:
        ticks = [tick for tick in ticks if np.log10(tick) % 1 == 0]
    picture.update_xaxes(type="log", tickvals=ticks, ticktext=[f"{f:g}" for f in ticks])
    picture.update_xaxes(tickangle=0, range=[np.log10(low), np.log10(high)], unifiedhovertitle={"text": "%{x:.3~g} Hz"})
    picture.update_xaxes(title_text="Frequency, Hz", row=2, col=1)
    picture.update_yaxes(title_text="Gain, dB", row=1, col=1)
    picture.update_yaxes(title_text="Phase, deg", dtick=90, row=2, col=1)
    return picture


def _time(figure: Figure, design: AnyDesign, system: UnitSystem) -> go.Figure:
    picture = make_subplots(rows=1, cols=1)
    _angle_panel(picture, figure, design, row=1)
    frame(picture, 420, top=_PAIRED)
    picture.update_xaxes(title_text="Time, s", range=[0, _end(figure)], unifiedhovertitle={"text": "%{x:.3f} s"})
    return picture


def _demand(figure: Figure, design: AnyDesign, system: UnitSystem) -> go.Figure:
    """Column angle, and below it what the valve gives, as percent of its ratings, or the motor of its limits."""
    whole = _OF_MOTOR if isinstance(design, MotorDesign) else _OF_VALVE
    panels = tuple(panel for panel in whole if np.isfinite(design.loader[panel[-1]]))
    heights = [0.5, 0.25, 0.25][: 1 + len(panels)]
    picture = make_subplots(rows=len(heights), cols=1, shared_xaxes=True, vertical_spacing=0.05, row_heights=heights)
    _angle_panel(picture, figure, design, row=1)
    for row, (name, title, rating) in enumerate(panels, start=2):
        _share_panel(picture, figure, design, name, design.loader[rating], row)
        text = f"{title}, % of<br>{parameter_text(design.loader, rating, system)}"
        picture.update_yaxes(title_text=text, row=row, col=1)
    frame(picture, 720 if len(heights) == 3 else 280 + 160 * len(heights))
    picture.update_xaxes(range=[0, _end(figure)], unifiedhovertitle={"text": "%{x:.3f} s"})
    picture.update_xaxes(title_text="Time, s", row=len(heights), col=1)
    return picture


_OF_VALVE = (
    ("valve_current_a", "Current", "valve.rated_current"),
    ("actuator_flow_m3_per_s", "Flow", "valve.rated_flow"),
)
_OF_MOTOR = (
    ("motor_current_a", "Current", "current_loop.current_limit"),
    ("motor_voltage_v", "Voltage", "current_loop.voltage_limit"),
)
"""Curve, title, and the row that it is a share of."""


def _angle_panel(picture: go.Figure, figure: Figure, design: AnyDesign, *, row: int) -> None:
    """Column angle in degrees; unstable curves are cut where they leave the picture."""
    peak = float(np.degrees(np.max(np.abs(figure.curves["ideal feel"]["column_angle_rad"]))))
    for position, (label, data) in enumerate(figure.curves.items()):
        bad = is_unstable(design, figure.key, label)
        angle = np.degrees(data["column_angle_rad"])
        time, angle = _cut(data["time_s"], angle, CUT * peak) if bad else (data["time_s"], angle)
        add_curve(
            picture,
            time,
            angle,
            f"{label} (unstable)" if bad else label,
            look(figure.key, label, position),
            "%{y:.2f}°",
            legendgroup=label,
            row=row,
            col=1,
        )
    picture.update_yaxes(title_text="Column angle, deg", row=row, col=1)
    if departs(design, figure):
        picture.update_yaxes(range=[_VIEW_BELOW * peak, _VIEW_ABOVE * peak], row=row, col=1)


def _share_panel(picture: go.Figure, figure: Figure, design: AnyDesign, name: str, rated: float, row: int) -> None:
    """A demand on the drive as percent of its rating; the ideal feel makes none."""
    largest = 0.0
    for position, (label, data) in enumerate(figure.curves.items()):
        if name not in data:
            continue
        time, share = data["time_s"], 100 * data[name] / rated
        if is_unstable(design, figure.key, label):
            time, share = _cut(time, share, CUT * 100)
        largest = max(largest, float(np.max(np.abs(share))))
        style: LineStyle = look(figure.key, label, position)
        add_curve(picture, time, share, label, style, "%{y:.1f} %", legendgroup=label, showlegend=False, row=row, col=1)
    if largest > 60:  # the rating is worth showing once the demand comes near it
        for level in (-100.0, 100.0):
            mark_level(picture, level, row=row)
        picture.update_yaxes(range=[-150, 150], row=row, col=1)


def _cut(time: np.ndarray, values: np.ndarray, limit: float) -> tuple[np.ndarray, np.ndarray]:
    """A curve up to the first sample beyond ``limit``; the whole of it is in the table of values."""
    beyond = np.flatnonzero(np.abs(values) > limit)
    last = int(beyond[0]) + 1 if len(beyond) else len(values)
    return time[:last], np.clip(values[:last], -limit, limit)


def _in_units(data: LabeledArrays, name: str, system: UnitSystem) -> tuple[np.ndarray, str]:
    axis = signal(name, data.unit(name), system)
    return (data[name] * axis.scale, axis.unit) if axis else (data[name], "")


def _end(figure: Figure) -> float:
    return float(next(iter(figure.curves.values()))["time_s"][-1])
