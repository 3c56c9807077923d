"""Plots of an identification: estimates, and responses and records with the model."""

import math

import numpy as np
import plotly.graph_objects as go
from numpy.typing import NDArray
from plotly.subplots import make_subplots

from forcefeel.bench.channels import channel_unit
from forcefeel.bench.identification.digits import NOT_DETERMINED, gain_unit
from forcefeel.bench.identification.result import Estimate, Fitted, Identification, Status
from forcefeel.bench.responses import Response
from forcefeel.loader.parameters import TABLE
from forcefeel.page.canvas import ZERO, add_curve, drawn, frame
from forcefeel.page.palette import COMPENSATED, COMPLIANT, IDEAL, RIGID, LineStyle
from forcefeel.page.typography import split_symbol, unit_text
from forcefeel.units import UnitSystem

MOST_POINTS = 2000
"""Most points of a drawn curve; a longer one is reduced to the extremes of each stretch."""

MOST_SWINGS, SHOWN_SWINGS = 100, 40
"""Most crossings of the mean of a channel drawn whole, and the number drawn otherwise."""

_NORMAL_95 = 1.96
_MEASURED, _FITTED, _BEFORE = (
    LineStyle("#8DBBDD", "solid", 3.4),
    LineStyle(COMPENSATED, "solid", 1.8),
    LineStyle(IDEAL, "dash", 1.6),
)
_MISSED, _BAND = "#A8568A", "rgba(138,147,158,0.22)"
_DB = 20 / math.log(10)
"""Decibels of a relative error."""

_TICKS = [mantissa * 10.0**power for power in range(-3, 4) for mantissa in (1, 2, 5)]
_SPARSE = [10.0**power for power in range(-3, 4)]
_WIDE_DECADES = 3.0
"""Number of decades above which only powers of ten are labeled, for small screens."""

_ROOM, _LEAST_LEFT = 1.15, 1e-6
"""Ratio of the axis range to the largest error, and the least error in percent, for data without noise."""

_ROW_PX = 46
_LOST, _VEIL = "#B3261E", "rgba(255,255,255,0.8)"


def estimates(identification: Identification) -> go.Figure:
    """Estimates with their 95 % intervals in percent of the file's value, and the file's tolerances."""
    picture = go.Figure()
    bounded = [estimate for estimate in identification.estimates if estimate.unknown.tolerance]
    determined = [estimate for estimate in identification.estimates if estimate.status is not Status.UNDETERMINED]
    lost = [estimate for estimate in identification.estimates if estimate.status is Status.UNDETERMINED]
    if bounded:
        low = np.array([_percent_off(estimate, estimate.unknown.low) for estimate in bounded])
        high = np.array([_percent_off(estimate, estimate.unknown.high) for estimate in bounded])
        picture.add_bar(
            y=[_symbol(estimate) for estimate in bounded],
            x=high - low,
            base=low,
            customdata=high,
            orientation="h",
            width=0.5,
            marker={"color": _BAND},
            name="the file's tolerance",
            hovertemplate="%{base:.3~g} to %{customdata:.3~g} %",
        )
    if determined:
        middle = np.array([_percent_off(estimate, estimate.value) for estimate in determined])
        bars = {
            "array": [_percent_off(estimate, estimate.high) for estimate in determined] - middle,
            "arrayminus": middle - [_percent_off(estimate, estimate.low) for estimate in determined],
        }
        picture.add_scatter(
            y=[_symbol(estimate) for estimate in determined],
            x=middle,
            error_x={"symmetric": False, "color": COMPENSATED, "thickness": 2.2, "width": 6, **bars},
            mode="markers",
            marker={"color": COMPENSATED, "size": 9},
            name="estimate, 95 %",
            hovertemplate="%{x:.3~g} %",
        )
    names = [_symbol(estimate) for estimate in identification.estimates]
    for estimate in lost:
        picture.add_annotation(
            y=_symbol(estimate), x=0, text=NOT_DETERMINED, font={"color": _LOST}, bgcolor=_VEIL, showarrow=False
        )
    frame(picture, _ROW_PX * len(names) + 120, top=60, hover="closest")
    picture.update_layout(showlegend=True)
    picture.update_xaxes(title_text="Off the file's value, %", **ZERO)
    picture.update_yaxes(
        categoryorder="array", categoryarray=names[::-1], range=[-0.6, len(names) - 0.4], tickfont={"size": 15}
    )
    return picture


def response(fitted: Fitted, data: Response, units: UnitSystem) -> go.Figure:
    """Gain, phase and residual over frequency: measured, the file's model, the fitted one; coherence if known."""
    coherent = data.coherence is not None
    heights = [0.36, 0.28, 0.22, 0.14] if coherent else [0.42, 0.32, 0.26]
    rows = len(heights)
    picture = make_subplots(rows=rows, cols=1, shared_xaxes=True, vertical_spacing=0.04, row_heights=heights)
    written, scale = gain_unit(data, units)
    gains = {name: 20 * np.log10(scale * np.abs(value)) for name, value in _values(fitted).items()}
    _overlay(picture, 1, fitted.at, gains, _error(data, _DB), " dB")
    _overlay(picture, 2, fitted.at, phases(fitted), _error(data, 180 / np.pi), "°")
    _left_of_response(picture, fitted, data)
    if data.coherence is not None:
        _line(picture, 4, fitted.at, data.coherence, "coherence", LineStyle("#8A939E", "solid", 1.8))
        picture.update_yaxes(title_text="Coherence", range=[0, 1.05], dtick=0.5, row=4, col=1)
    frame(picture, 760 if coherent else 660, top=60)
    picture.update_yaxes(title_text=f"Gain, dB re 1 {unit_text(written)}", row=1, col=1)
    picture.update_yaxes(title_text="Phase, deg", row=2, col=1)
    low, high = math.log10(float(fitted.at.min())), math.log10(float(fitted.at.max()))
    room = 0.03 * max(high - low, 0.1)
    ticks = _SPARSE if high - low > _WIDE_DECADES else _TICKS
    picture.update_xaxes(type="log", tickvals=ticks, ticktext=[f"{tick:g}" for tick in ticks], tickangle=0)
    picture.update_xaxes(range=[low - room, high + room], unifiedhovertitle={"text": "%{x:.4~g} Hz"})
    picture.update_xaxes(title_text="Frequency, Hz", row=rows, col=1)
    return picture


def record(fitted: Fitted, units: UnitSystem) -> go.Figure:
    """A channel over time, measured and modeled, and its residual."""
    picture = make_subplots(rows=2, cols=1, vertical_spacing=0.14, row_heights=[0.66, 0.34])
    quantity = channel_unit(fitted.channel)
    scale, unit = quantity.from_si(1.0, units), unit_text(quantity.shown(units))
    measured, modeled, before = (scale * np.real(values) for values in (fitted.measured, fitted.modeled, fitted.before))
    hover = f"%{{y:.4~g}} {unit}"
    residual = measured - modeled
    displayed = stretch(measured, residual)
    for name, values, style in (
        ("measured", measured, _MEASURED),
        ("the file's model", before, _BEFORE),
        ("fitted", modeled, _FITTED),
    ):
        indices = displayed[drawn(values[displayed], MOST_POINTS)]
        _line(picture, 1, fitted.at[indices], values[indices], name, style, hover)
    indices = drawn(residual, MOST_POINTS)
    _line(
        picture,
        2,
        fitted.at[indices],
        residual[indices],
        "measured less fitted",
        LineStyle(_MISSED, "solid", 1.2),
        hover,
    )
    frame(picture, 520, top=60)
    picture.update_yaxes(title_text=f"{fitted.channel.replace('_', ' ').capitalize()}, {unit}", row=1, col=1)
    picture.update_yaxes(title_text=f"Residual, {unit}", row=2, col=1, **ZERO)
    for row, at in ((1, fitted.at[displayed]), (2, fitted.at)):
        picture.update_xaxes(range=[float(at[0]), float(at[-1])], title_text="Time, s", row=row, col=1)
    picture.update_xaxes(unifiedhovertitle={"text": "%{x:.4~f} s"})
    return picture


def phases(part: Fitted) -> dict[str, NDArray[np.float64]]:
    """Unwrapped phases in deg: the fitted model's along the lines, the measured ones within half a turn of it."""
    values = _values(part)
    fitted = np.unwrap(np.angle(values["fitted"]))
    before = np.unwrap(np.angle(values["the file's model"]))
    before += 2 * np.pi * np.round((fitted[0] - before[0]) / (2 * np.pi))
    measured = fitted + np.angle(values["measured"] / values["fitted"])
    return {
        "measured": np.degrees(measured),
        "the file's model": np.degrees(before),
        "fitted": np.degrees(fitted),
    }


def stretch(measured: NDArray[np.float64], residual: NDArray[np.float64]) -> NDArray[np.intp]:
    """Samples of the overlay: all, or for a channel with many swings, some about the largest residual."""
    count, swings = len(measured), int(np.count_nonzero(np.diff(np.signbit(measured - np.mean(measured)))))
    if swings <= MOST_SWINGS:
        return np.arange(count)
    samples = max(count * SHOWN_SWINGS // swings, 2)
    first = min(max(int(np.argmax(np.abs(residual))) - samples // 2, 0), count - samples)
    return np.arange(first, first + samples)


def _values(fitted: Fitted) -> dict[str, NDArray[np.complex128]]:
    return {
        "measured": np.asarray(fitted.measured, dtype=np.complex128),
        "the file's model": np.asarray(fitted.before, dtype=np.complex128),
        "fitted": np.asarray(fitted.modeled, dtype=np.complex128),
    }


def _overlay(
    picture: go.Figure,
    row: int,
    abscissa: NDArray[np.float64],
    curves: dict[str, NDArray[np.float64]],
    error: NDArray[np.float64] | None,
    unit: str,
) -> None:
    """Measured points with their bars over the two models' lines."""
    hover = f"%{{y:.4~g}}{unit}"
    for name, style in (("the file's model", _BEFORE), ("fitted", _FITTED)):
        _line(picture, row, abscissa, curves[name], name, style, hover)
    bars = {} if error is None else {"error_y": {"array": error, "color": RIGID, "thickness": 1.2, "width": 2}}
    picture.add_scatter(
        x=abscissa,
        y=curves["measured"],
        mode="markers",
        marker={"color": RIGID, "size": 6},
        name="measured" if error is None else "measured, 95 %",
        showlegend=row == 1,
        hovertemplate=hover,
        row=row,
        col=1,
        **bars,
    )


def _left_of_response(picture: go.Figure, fitted: Fitted, data: Response) -> None:
    """Real and imaginary part of ``ln(G_measured / G_model)`` in percent, and the band of 95 % of the noise."""
    error = 100 * np.log(np.asarray(fitted.measured, dtype=np.complex128) / fitted.modeled)
    limit = 100 * _NORMAL_95 * _noise(fitted, data)
    picture.add_scatter(
        x=np.concatenate([fitted.at, fitted.at[::-1]]),
        y=np.concatenate([limit, -limit[::-1]]),
        fill="toself",
        mode="lines",
        line={"width": 0},
        fillcolor=_BAND,
        name="95 % of the noise",
        hoverinfo="skip",
        row=3,
        col=1,
    )
    for name, values, symbol in (("gain", error.real, "circle"), ("phase", error.imag, "circle-open")):
        picture.add_scatter(
            x=fitted.at,
            y=values,
            mode="markers",
            marker={"color": _MISSED if name == "gain" else COMPLIANT, "size": 5, "symbol": symbol},
            name=f"{name}'s error",
            hovertemplate="%{y:.3~g} %" if name == "gain" else "%{y:.3~g} % of a rad",
            row=3,
            col=1,
        )
    # The axis fits the points; lines of a wide band may leave the panel.
    view = _ROOM * max(float(np.abs(error.real).max()), float(np.abs(error.imag).max()), _LEAST_LEFT)
    picture.update_yaxes(title_text="Residual, %", range=[-view, view], row=3, col=1, **ZERO)


def _noise(fitted: Fitted, data: Response) -> NDArray[np.float64]:
    """Estimated standard deviation of each line, in proportion to the stated one if there is any."""
    if data.deviation is None or len(data.deviation) != len(fitted.at):
        return np.full(len(fitted.at), fitted.noise)
    return fitted.noise / float(np.sqrt(np.mean(data.deviation**2))) * data.deviation


def _line(
    picture: go.Figure,
    row: int,
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    name: str,
    style: LineStyle,
    hover: str = "%{y:.3~g}",
) -> None:
    add_curve(
        picture,
        x,
        y,
        name,
        style,
        hover,
        legendgroup=name,
        showlegend=row != 4 and all(trace.name != name for trace in picture.data),
        row=row,
        col=1,
    )


def _error(data: Response, scale: float) -> NDArray[np.float64] | None:
    """95 % bars of the points, if their deviation is known."""
    return None if data.deviation is None else _NORMAL_95 * scale * data.deviation


def _percent_off(estimate: Estimate, value: float) -> float:
    return 100 * (value - estimate.unknown.nominal) / estimate.unknown.scale


def _symbol(estimate: Estimate) -> str:
    """The parameter's letter as Plotly sets it."""
    base, index, dashes = split_symbol(TABLE[estimate.unknown.key].symbol)
    return f"<i>{base}</i>{f'<sub>{index}</sub>' if index else ''}{dashes}"
