"""Plots of a Monte Carlo sweep: band of responses, distributions and correlations of the measures."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import plotly.graph_objects as go
from numpy.typing import NDArray

from forcefeel.conclusions import capital
from forcefeel.loader.parameters import TABLE, unit
from forcefeel.page.canvas import add_curve, frame
from forcefeel.page.palette import COMPENSATED, COMPLIANT, IDEAL, RIGID, LineStyle
from forcefeel.page.typography import heading_text, unit_text
from forcefeel.sweep import SweepResult
from forcefeel.sweep.summary import Spread, Summary, measure_name, measure_unit
from forcefeel.units import Unit, UnitSystem

MOST_POINTS = 1000
"""Most points of a drawn curve over time."""

_BINS = 50
_BEYOND = 0.5
"""Room beside the middle 98 %, as a share of their width; the few runs farther out are not in view."""

_RANKED = 8
_SLICES = 24
"""Runs of one parameter's values in so many slices of as many runs each."""

MIDDLE = 0.30
"""Opacity of the band of the middle nine of ten."""

_MARK = LineStyle(IDEAL, "dash", 1.6)
_IDEAL = LineStyle(IDEAL, "dot", 2.0)


def color(law: str) -> str:
    """The color of a law, as in the design report."""
    return COMPLIANT if law == "original" else COMPENSATED


def band(result: SweepResult, nominal: NDArray[np.float64], ideal: NDArray[np.float64] | None, hue: str) -> go.Figure:
    """Column angle over time: all of the sample, nine of ten, the median, the nominal loader and the ideal feel if given, rad."""
    envelope = result.envelope
    time = envelope["time_s"].values
    every = max(1, -(-len(time) // MOST_POINTS))
    time = time[::every]
    edges = {
        str(edge): np.degrees(envelope["column_angle_rad"].sel(edge=edge).values[::every])
        for edge in envelope["edge"].values
    }
    picture = go.Figure()
    for low, high, name, opacity in (("lowest", "highest", "all", 0.16), ("5 %", "95 %", "5 to 95 %", MIDDLE)):
        filled(picture, time, {low: edges[low], high: edges[high]}, Fill(name, tint(hue, opacity), "%{y:.2f}°"))
    curves = [
        ("median", edges["median"], LineStyle(hue, "solid", 2.4)),
        ("nominal", np.degrees(nominal[::every]), _MARK),
    ]
    if ideal is not None:
        curves.append(("ideal feel", np.degrees(ideal[::every]), _IDEAL))
    for name, angle, style in curves:
        add_curve(picture, time, angle, name, style, "%{y:.2f}°")
    frame(picture, 460)
    picture.update_xaxes(
        title_text="Time, s", range=[0, float(envelope["time_s"].values[-1])], unifiedhovertitle={"text": "%{x:.3f} s"}
    )
    picture.update_yaxes(title_text="Column angle, deg")
    return picture


@dataclass(frozen=True)
class Fill:
    """Style of a band.

    Attributes:
        name: In the legend.
        color: Its color.
        hover: Plotly template of the hover text at its edges.
    """

    name: str
    color: str
    hover: str


def filled(picture: go.Figure, x: NDArray[np.float64], edges: dict[str, NDArray[np.float64]], fill: Fill) -> None:
    """Add a band between two named edges, the lower first."""
    fills: dict[str, dict[str, Any]] = {"none": {"showlegend": False}, "tonexty": {"fillcolor": fill.color}}
    for (edge, y), (mode, style) in zip(edges.items(), fills.items(), strict=True):
        picture.add_scatter(
            x=x,
            y=y,
            mode="lines",
            line={"color": "rgba(0,0,0,0)", "width": 0},
            fill=mode,
            name=fill.name,
            legendgroup=fill.name,
            hovertemplate=f"{fill.hover}<extra>{edge}</extra>",
            **style,
        )


def histogram(
    values: NDArray[np.float64], spread: Spread, along: str, system: UnitSystem, hue: str
) -> tuple[go.Figure, int]:
    """Distribution of a measure: share of the runs over its value, the middle nine of ten full, median and nominal marked.

    The title of the axis is ``along``.

    Returns:
        The plot, and the number of runs outside its range.
    """
    measured_in = spread.unit
    scale = measured_in.from_si(1.0, system)
    room = _BEYOND * (spread.quantile(0.99) - spread.quantile(0.01))
    low, high = max(spread.lowest, spread.quantile(0.01) - room), min(spread.highest, spread.quantile(0.99) + room)
    if not low < high:
        low, high = spread.lowest, spread.highest
    counts, edges = np.histogram(values, bins=_BINS, range=(low, high))
    middles, width = (edges[:-1] + edges[1:]) / 2 * scale, (edges[1] - edges[0]) * scale
    heights = 100 * counts / spread.runs
    inside = (middles >= spread.quantile(0.05) * scale) & (middles <= spread.quantile(0.95) * scale)
    picture = go.Figure()
    unit = unit_text(measured_in.shown(system))
    for selected, name, opacity in ((inside, "5 to 95 %", 0.75), (~inside, "beyond", 0.30)):
        picture.add_bar(
            x=middles[selected],
            y=heights[selected],
            width=width,
            name=name,
            marker={"color": tint(hue, opacity), "line": {"width": 0}},
            hovertemplate=f"%{{x:.4~g}} {unit}: %{{y:.2~g}} % of the runs<extra></extra>",
        )
    top = float(heights.max()) * 1.06
    for name, position, style in (
        ("median", spread.quantile(0.5), LineStyle(IDEAL, "solid", 1.8)),
        ("nominal", spread.nominal, _MARK),
    ):
        if np.isfinite(position):
            add_curve(
                picture, [position * scale] * 2, [0, top], name, style, f"{name} %{{x:.4~g}} {unit}<extra></extra>"
            )
    frame(picture, 320, top=34, hover="closest")
    picture.update_layout(bargap=0, barmode="overlay")
    picture.update_xaxes(
        title_text=along,
        range=[(low * scale) - width, (high * scale) + width],
    )
    picture.update_yaxes(title_text="Runs, %", range=[0, top])
    return picture, spread.runs - int(counts.sum())


def tornado(measure: str, summary: Summary, system: UnitSystem) -> go.Figure:
    """Rank correlations of a measure, the largest on top, and the range of chance."""
    row = summary.correlations.sel(measure=measure)
    ranking = [
        (str(key), float(rho)) for key, rho in zip(row["parameter"].values, row.values, strict=True) if np.isfinite(rho)
    ]
    ranking = sorted(ranking, key=lambda row: -abs(row[1]))[:_RANKED][::-1]
    rho = np.array([row[1] for row in ranking])
    picture = go.Figure()
    for selected, name, hue in ((rho >= 0, "rises with it", COMPLIANT), (rho < 0, "falls with it", RIGID)):
        picture.add_bar(
            x=rho[selected],
            y=[two_lines(ranking[k][0]) for k in np.flatnonzero(selected)],
            orientation="h",
            name=name,
            marker={"color": hue, "opacity": 0.8},
            hovertemplate="%{x:+.2f}<extra></extra>",
            showlegend=bool(selected.any()),
        )
    picture.add_vrect(-summary.chance, summary.chance, fillcolor="#8A939E", opacity=0.25, line_width=0)
    frame(picture, 80 + 36 * max(len(ranking), 2), top=34, hover="closest")
    picture.update_layout(barmode="overlay", bargap=0.25)
    picture.update_xaxes(
        title_text="Rank correlation", range=[-1, 1], dtick=0.5, zeroline=True, zerolinecolor="#6B7580"
    )
    picture.update_yaxes(
        categoryorder="array",
        categoryarray=[two_lines(key) for key, _ in ranking],
        automargin=True,
        showgrid=False,
        ticks="",
        tickfont={"size": 12},
    )
    return picture


def slices(result: SweepResult, measure: str, key: str, system: UnitSystem, hue: str) -> go.Figure:
    """A measure over one parameter while all others vary too: median and middle nine of ten of equal slices of the sample."""
    values, along = result.sample[measure].values, result.sample[key].values
    finite = np.isfinite(values)
    order = np.argsort(along[finite], kind="stable")
    parts = [part for part in np.array_split(order, min(_SLICES, max(1, len(order) // 20))) if len(part)]
    measured_in, of = measure_unit(measure, result.sweep.loader.drive), unit(TABLE[key])
    x = np.array([np.median(along[finite][part]) for part in parts]) * of.from_si(1.0, system)
    y = np.array([np.quantile(values[finite][part], (0.05, 0.5, 0.95)) for part in parts]) * measured_in.from_si(
        1.0, system
    )
    picture = go.Figure()
    hover = f"%{{y:.4~g}} {unit_text(measured_in.shown(system))}"
    filled(picture, x, {"5 %": y[:, 0], "95 %": y[:, 2]}, Fill("5 to 95 %", tint(hue, MIDDLE), hover))
    add_curve(picture, x, y[:, 1], "median", LineStyle(hue, "solid", 2.4), hover)
    frame(picture, 320, top=34)
    picture.update_xaxes(title_text=parameter_title(key, system))
    picture.update_yaxes(title_text=axis_title(measure, measured_in, system))
    return picture


def title(measure: str) -> str:
    """``Overshoot``."""
    return capital(measure_name(measure))


def axis_title(measure: str, measured_in: Unit, system: UnitSystem) -> str:
    """``Overshoot, %``."""
    return heading_text(title(measure), measured_in, system)


def parameter_title(key: str, system: UnitSystem) -> str:
    """``Linkage stiffness k, lb/in``."""
    words = key.replace(".", " ").replace("_", " ")
    return heading_text(f"{words[0].upper()}{words[1:]}", unit(TABLE[key]), system)


def two_lines(key: str) -> str:
    """A parameter's part above its name, so that a plot has room beside them."""
    return key.replace("_", " ").replace(".", "<br>")


def tint(color: str, opacity: float) -> str:
    """``color`` with an opacity."""
    red, green, blue = (int(color[k : k + 2], 16) for k in (1, 3, 5))
    return f"rgba({red},{green},{blue},{opacity})"
