"""Plots of a sweep over a grid: lines over one setting, maps over two."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import plotly.graph_objects as go
import xarray as xr
from numpy.typing import NDArray

from forcefeel.loader.parameters import TABLE, unit
from forcefeel.page.canvas import frame, line
from forcefeel.page.palette import IDEAL, LineStyle
from forcefeel.page.typography import number_text, unit_text
from forcefeel.simulation import RunStatus
from forcefeel.sweep import SweepResult
from forcefeel.sweep.page.plots import MIDDLE, Fill, axis_title, filled, parameter_title, tint
from forcefeel.sweep.summary import measure_unit
from forcefeel.units import UnitSystem

_GONE = "#D9DEE4"
_EVEN = 1e-6
"""Relative tolerance of equal steps, for rounding."""

_STABLE_SCALE = [[0.0, "#B3261E"], [0.4999, "#F6D9CF"], [0.5, "#E3F1EC"], [1.0, "#00664B"]]
_DAMPING_VIEW = 0.3
"""Damping ratio, to either side, at the ends of the colors of the stability map."""

_SQUARE = 400

_FINE_DECADES = 1.2
"""Decades of a logarithmic axis up to which 2 and 5 are labeled too, and not only marked."""

_FAR = 0.5
"""Extremes farther beyond the middle nine of ten, as a share of its width, are beyond the ends of the colors."""


def measure_map(
    result: SweepResult, measure: str, stability: xr.DataArray | None, system: UnitSystem
) -> tuple[go.Figure, str]:
    """A measure over both settings; gray where every run diverged, with the linear boundary of stability.

    Returns:
        The plot, and a remark if values lie beyond the ends of its colors.
    """
    measured_in = measure_unit(measure, result.sweep.loader.drive)
    z = result.map(measure).values.T * measured_in.from_si(1.0, system)
    low, high, cut = _limits(z)
    hover = f"%{{z:.3~g}} {unit_text(measured_in.shown(system))}"
    picture = _map(result, z, system, hover, colorscale="Viridis", zmin=low, zmax=high)
    picture.update_traces(colorbar=_bar(axis_title(measure, measured_in, system)), selector={"type": "heatmap"})
    if stability is not None:
        _boundary(picture, result, stability, system, "#FFFFFF")
    _nominal(picture, result, system)
    remark = "The colors end before the extremes; point at the map for the values." if cut else ""
    return _framed(picture, result, system), remark


def share_map(result: SweepResult, system: UnitSystem) -> go.Figure:
    """Share of the runs that settle over both settings."""
    z = 100 * result.share_map(RunStatus.SETTLED).values.T
    picture = _map(result, z, system, "%{z:.3~g} % of the runs settle", colorscale="Viridis", zmin=0, zmax=100)
    picture.update_traces(colorbar=_bar("Runs that settle, %"), selector={"type": "heatmap"})
    _nominal(picture, result, system)
    return _framed(picture, result, system)


def status_map(result: SweepResult, system: UnitSystem) -> go.Figure:
    """Status of the run at each point."""
    names, hues = list(STATUS_COLORS), list(STATUS_COLORS.values())
    share = np.stack([result.share_map(name).values.T for name in names])
    z = share.argmax(axis=0).astype(float)
    ends = np.repeat(np.linspace(0, 1, len(hues) + 1), 2)[1:-1]
    scale = [[float(end), hues[k // 2]] for k, end in enumerate(ends)]
    style = {"colorscale": scale, "zmin": -0.5, "zmax": len(hues) - 0.5, "showscale": False, "opacity": 0.85}
    picture = _map(result, z, system, "%{text}", text=np.array(names)[z.astype(int)], **style)
    for k, (name, hue) in enumerate(STATUS_COLORS.items()):
        if (z == k).any():
            marker = {"symbol": "square", "size": 11, "color": hue, "opacity": 0.85}
            picture.add_scatter(x=[None], y=[None], mode="markers", marker=marker, name=name)
    _nominal(picture, result, system)
    return _framed(picture, result, system)


def stability_map(result: SweepResult, stability: xr.DataArray, system: UnitSystem) -> go.Figure:
    """Least damping ratio of the linear model over both settings: red where it is unstable."""
    limits = {"zmin": -_DAMPING_VIEW, "zmax": _DAMPING_VIEW}
    picture = _map(result, stability.values.T, system, "ζ = %{z:.3~f}", colorscale=_STABLE_SCALE, **limits)
    picture.update_traces(colorbar=_bar("Least damping ratio"), selector={"type": "heatmap"})
    _boundary(picture, result, stability, system, IDEAL)
    _nominal(picture, result, system)
    return _framed(picture, result, system)


def measure_line(result: SweepResult, measure: str, system: UnitSystem, hue: str) -> go.Figure:
    """A measure over one setting: the median, and the middle nine of ten where several machines stand at each point."""
    (key,) = result.sweep.axes
    measured_in = measure_unit(measure, result.sweep.loader.drive)
    x, scale = _axis(result, key, system), measured_in.from_si(1.0, system)
    hover = f"%{{y:.4~g}} {unit_text(measured_in.shown(system))}"
    picture = go.Figure()
    single = result.sweep.machines == 1
    if not single:
        edges = {f"{100 * share:g} %": result.map(measure, share).values * scale for share in (0.05, 0.95)}
        filled(picture, x, edges, Fill("5 to 95 %", tint(hue, MIDDLE), hover))
    name = "nominal machine" if single else "median"
    picture.add_scatter(
        x=x,
        y=result.map(measure).values * scale,
        mode="lines+markers" if len(x) <= 60 else "lines",
        marker={"size": 5},
        line=line(LineStyle(hue, "solid", 2.4)),
        name=name,
        hovertemplate=hover,
    )
    frame(picture, 340, top=34)
    picture.update_layout(showlegend=not single)
    _setting(picture.update_xaxes, result, key, system)
    nominal = result.sweep.loader[key]
    if min(result.sweep.axes[key]) <= nominal <= max(result.sweep.axes[key]):
        picture.add_vline(
            unit(TABLE[key]).from_si(nominal, system), line={"color": IDEAL, "dash": "dash", "width": 1.2}
        )
    picture.update_yaxes(title_text=axis_title(measure, measured_in, system))
    return picture


def status_lines(result: SweepResult, system: UnitSystem) -> go.Figure:
    """Stacked shares of the status over one setting."""
    (key,) = result.sweep.axes
    x = _axis(result, key, system)
    picture = go.Figure()
    for status, hue in STATUS_COLORS.items():
        share = 100 * result.share_map(status).values
        if share.any():
            picture.add_scatter(
                x=x,
                y=share,
                mode="lines",
                stackgroup="one",
                name=status,
                line={"width": 0, "color": hue, "shape": "hvh"},
                fillcolor=tint(hue, 0.8),
                hovertemplate="%{y:.3~g} %",
            )
    frame(picture, 340, top=34)
    _setting(picture.update_xaxes, result, key, system)
    picture.update_yaxes(title_text="Runs, %", range=[0, 100])
    return picture


STATUS_COLORS = {"settled": "#009E73", "moving": "#E0A100", "diverged": "#B3261E", "impossible": "#8A939E"}
"""Color of each status."""


def _map(result: SweepResult, z: NDArray[np.float64], system: UnitSystem, hover: str, **style: Any) -> go.Figure:
    """The heat map of ``z`` (rows along the second setting)."""
    first, second = result.sweep.axes
    names = [parameter_title(key, system) for key in (first, second)]
    x, y = (_edges(_axis(result, key, system), logarithmic(result, key)) for key in (first, second))
    points = [_axis(result, key, system) for key in (first, second)]
    picture = go.Figure()
    picture.add_heatmap(
        x=x,
        y=y,
        z=z,
        customdata=np.dstack(np.meshgrid(*points)),
        hoverongaps=False,
        **style,
        hovertemplate=f"{names[0]} %{{customdata[0]:.4~g}}<br>{names[1]} %{{customdata[1]:.4~g}}<br><b>{hover}</b><extra></extra>",
    )
    return picture


def _boundary(picture: go.Figure, result: SweepResult, stability: xr.DataArray, system: UnitSystem, hue: str) -> None:
    """The line where the least damping ratio is zero."""
    if not stability.values.min() < 0 < stability.values.max():
        return
    first, second = (_axis(result, key, system) for key in result.sweep.axes)
    picture.add_contour(
        x=first,
        y=second,
        z=stability.values.T,
        contours={"start": 0, "end": 0, "size": 1, "coloring": "none"},
        line={"color": hue, "width": 2.4, "dash": "dot"},
        showscale=False,
        hoverinfo="skip",
        name="linear boundary of stability",
        showlegend=True,
    )


def _nominal(picture: go.Figure, result: SweepResult, system: UnitSystem) -> None:
    """A mark at the loader's own setting, if in view."""
    loader, axes = result.sweep.loader, result.sweep.axes
    if all(min(values) <= loader[key] <= max(values) for key, values in axes.items()):
        x, y = (unit(TABLE[key]).from_si(loader[key], system) for key in axes)
        marker = {"symbol": "circle-open", "size": 11, "color": "#FFFFFF", "line": {"width": 2.4, "color": "#FFFFFF"}}
        dot = {"symbol": "circle", "size": 6, "color": IDEAL}
        picture.add_scatter(x=[x], y=[y], mode="markers", marker=marker, showlegend=False, hoverinfo="skip")
        picture.add_scatter(x=[x], y=[y], mode="markers", marker=dot, name="the loader's setting", hoverinfo="skip")


def _framed(picture: go.Figure, result: SweepResult, system: UnitSystem) -> go.Figure:
    frame(picture, _SQUARE, top=34, hover="closest")
    picture.update_layout(plot_bgcolor=_GONE)
    first, second = result.sweep.axes
    _setting(picture.update_xaxes, result, first, system)
    _setting(picture.update_yaxes, result, second, system)
    picture.update_xaxes(showgrid=False)
    picture.update_yaxes(showgrid=False)
    return picture


def _setting(update: Callable[..., Any], result: SweepResult, key: str, system: UnitSystem) -> None:
    edges = _edges(_axis(result, key, system), logarithmic(result, key))
    title = parameter_title(key, system)
    if not logarithmic(result, key):
        update(title_text=title, range=edges[[0, -1]].tolist())
        return
    low, high = np.log10(edges[[0, -1]]).tolist()
    named = (1, 2, 5) if high - low < _FINE_DECADES else (1,)
    ticks = [(step, step * 10.0**power) for power in range(math.floor(low), math.ceil(high) + 1) for step in (1, 2, 5)]
    ticks = [(step, tick) for step, tick in ticks if low <= math.log10(tick) <= high]
    texts = [number_text(tick, 3) if step in named else "" for step, tick in ticks]
    update(title_text=title, range=[low, high], type="log", tickvals=[tick for _, tick in ticks], ticktext=texts)


def _axis(result: SweepResult, key: str, system: UnitSystem) -> NDArray[np.float64]:
    return np.array(result.sweep.axes[key]) * unit(TABLE[key]).from_si(1.0, system)


def logarithmic(result: SweepResult, key: str) -> bool:
    """Whether a grid's values are even in proportion."""
    values = np.array(result.sweep.axes[key])
    if len(values) < 3 or values[0] <= 0:
        return False
    ratios = values[1:] / values[:-1]
    return bool(np.ptp(ratios) < _EVEN * ratios[0] and np.ptp(np.diff(values)) > _EVEN * values[-1])


def _edges(points: NDArray[np.float64], log: bool) -> NDArray[np.float64]:
    """The edges of the cells about the points."""
    along = np.log(points) if log else points
    middle = (along[1:] + along[:-1]) / 2
    edges = np.concatenate([[2 * along[0] - middle[0]], middle, [2 * along[-1] - middle[-1]]])
    return np.exp(edges) if log else edges


def _limits(z: NDArray[np.float64]) -> tuple[float, float, bool]:
    """The ends of the colors, and whether values lie beyond."""
    finite = z[np.isfinite(z)]
    if not len(finite):
        return 0.0, 1.0, False
    low, first, last, high = np.quantile(finite, (0.0, 0.05, 0.95, 1.0)).tolist()
    room = _FAR * (last - first)
    ends = max(low, first - room) if room else low, min(high, last + room) if room else high
    return *ends, ends != (low, high)


def _bar(title: str) -> dict[str, object]:
    return {
        "title": {"text": title, "side": "right", "font": {"size": 13}},
        "thickness": 12,
        "outlinewidth": 0,
        "exponentformat": "power",
    }
