"""Curves of a flight schedule over each axis: decay rate of its slowest oscillation, and its gains."""

import numpy as np
import plotly.graph_objects as go
from numpy.typing import NDArray
from plotly.subplots import make_subplots

from forcefeel import _core
from forcefeel.flight_schedule.axes import ScheduleAxis, mesh
from forcefeel.flight_schedule.result import ScheduleCheck
from forcefeel.flight_schedule.schedule import FlightSchedule
from forcefeel.loader.parameters import ELECTRIC
from forcefeel.page.canvas import ZERO, add_curve, frame
from forcefeel.page.palette import COMPENSATED, COMPLIANT, IDEAL, RIGID, LineStyle
from forcefeel.page.typography import number_text, unit_text
from forcefeel.units import Unit, UnitSystem

_PANEL_PX = 300
_SIGNALS = (
    ("load cell force", ("/N", "/N", "/lb"), LineStyle(COMPLIANT)),
    ("drive position", ("/m", "/cm", "/in"), LineStyle("#B57A00", "dashdot")),
    ("column angle", ("/rad", "/rad", "/rad"), LineStyle(RIGID, "dash")),
    ("feel's angle", ("/rad", "/rad", "/rad"), LineStyle(COMPENSATED)),
    ("feel's rate", (" s/rad", " s/rad", " s/rad"), LineStyle("#A8568A", "dot")),
)
"""Inputs of the command in the law's order, without the observer's state, and units of their gains per volt or ampere."""


def poles(check: ScheduleCheck) -> go.Figure:
    """Decay rate of the critical pole over each axis: the nominal plant, the worst case, and the programmed feel alone."""
    schedule = check.schedule
    picture = _panels(schedule)
    decay = check.poles.decay
    feel, _ = schedule.between(check.where)
    curves = (
        ("nominal plant", decay[0], LineStyle(COMPENSATED, "solid", 2.6)),
        ("worst case", _least(decay), LineStyle(COMPLIANT)),
        ("I, B, G alone", _ideal_decay(feel), LineStyle(IDEAL, "dot")),
    )
    for row, axis in enumerate(schedule.axes):
        x = axis.refined(check.refine)
        for name, values, look in curves:
            y = _least_over_others(check, values, row)
            _curve(picture, row, name, (x, y), look, "%{y:.3~g} 1/s")
            if name != "I, B, G alone":
                at = np.arange(len(x)) % check.refine == 0
                _marks(picture, row, x[at], y[at], look)
        _axis(picture, row, axis)
        picture.update_yaxes(title_text="Decay rate, 1/s", rangemode="tozero", row=row + 1, col=1, **ZERO)
    return picture


def gains(schedule: FlightSchedule, refine: int, units: UnitSystem) -> go.Figure:
    """Gain of the command on each signal over each axis, the other axes at their middle knot; as shares of the largest."""
    picture, of = _panels(schedule), "A" if schedule.loader.drive == ELECTRIC else "V"
    middle = [[axis.values[len(axis.values) // 2]] for axis in schedule.axes]
    for row, axis in enumerate(schedule.axes):
        along = axis.refined(refine)
        points = mesh([*middle[:row], along, *middle[row + 1 :]])
        command = schedule.between(points)[1].command[:, schedule.laws.states :]
        for (name, per, look), values in zip(_SIGNALS, command.T, strict=True):
            measured_in = Unit(*(f"{of}{end}" for end in per))
            largest = float(np.abs(values).max())
            if largest == 0:
                continue
            text = f"{number_text(measured_in.from_si(largest, units), 4)} {unit_text(measured_in.shown(units))}"
            label = name if len(schedule.axes) > 1 else f"{name}, of {text}"
            _curve(picture, row, label, (along, values / largest), look, f"%{{y:.3f}} of {text}")
            at = np.arange(len(along)) % refine == 0
            _marks(picture, row, along[at], values[at] / largest, look)
        _axis(picture, row, axis)
        picture.update_yaxes(title_text="Share of the largest", row=row + 1, col=1, **ZERO)
    return picture


def _panels(schedule: FlightSchedule) -> go.Figure:
    """A panel for each axis, one under the other."""
    count = len(schedule.axes)
    picture = make_subplots(rows=count, cols=1, vertical_spacing=0.22 / count)
    return frame(picture, _PANEL_PX * count + 90, top=60)


def _curve(
    picture: go.Figure,
    row: int,
    name: str,
    points: tuple[NDArray[np.float64], NDArray[np.float64]],
    look: LineStyle,
    hover: str,
) -> None:
    x, y = points
    if np.isfinite(y).any():
        add_curve(picture, x, y, name, look, hover, legendgroup=name, showlegend=row == 0, row=row + 1, col=1)


def _marks(picture: go.Figure, row: int, x: NDArray[np.float64], y: NDArray[np.float64], look: LineStyle) -> None:
    """Dots at the knots."""
    picture.add_scatter(
        x=x,
        y=y,
        mode="markers",
        marker={"color": look.color, "size": 6},
        showlegend=False,
        hoverinfo="skip",
        row=row + 1,
        col=1,
    )


def _axis(picture: go.Figure, row: int, axis: ScheduleAxis) -> None:
    title = f"{axis.name[:1].upper()}{axis.name[1:]}"
    unit = unit_text(axis.unit)
    picture.update_xaxes(title_text=f"{title}, {unit}" if unit else title, row=row + 1, col=1)


def _ideal_decay(feel: NDArray[np.float64]) -> NDArray[np.float64]:
    """``zeta w`` of each feel; NaN for an overdamped feel."""
    frequency, damping = _core.feel_frequencies(feel)
    return np.where(damping < 1, damping * frequency, np.nan)


def _least(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Smallest value of all cases; NaN if all are NaN."""
    least = np.where(np.isnan(values), np.inf, values).min(axis=0)
    return np.where(np.isinf(least) & (least > 0), np.nan, least)


def _least_over_others(check: ScheduleCheck, values: NDArray[np.float64], kept: int) -> NDArray[np.float64]:
    """Smallest value along one axis over all points of the others."""
    shape = [(len(axis.values) - 1) * check.refine + 1 for axis in check.schedule.axes]
    along = np.moveaxis(values.reshape(shape), kept, -1).reshape(-1, shape[kept])
    return _least(along)
