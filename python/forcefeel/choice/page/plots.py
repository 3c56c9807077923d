"""Plots of a comparison of laws: nominal and worst-case shares, margins and noise as bars, the release."""

from dataclasses import dataclass
from math import degrees, isfinite

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from forcefeel.choice import Choice, LawScores, Score
from forcefeel.choice.rule import LEAST_GAIN, LEAST_PERIODS, LEAST_PHASE_RAD
from forcefeel.envelope.findings import WHOLE_NOMINAL, WHOLE_WORST
from forcefeel.loader.loader import FEEL_SETTING
from forcefeel.page.canvas import ZERO, add_curve, frame
from forcefeel.page.palette import COMPENSATED, IDEAL, RIGID, LineStyle
from forcefeel.units import FORCE, UnitSystem

_MARK = "#6B7580"
_SHOWN_PERIODS = 6


def trade_off(scored: LawScores, choice: Choice | None) -> go.Figure:
    """Worst-case share over nominal share, a point for each law."""
    picture = go.Figure()
    points = [(score, *_percent(score)) for score in scored.scores if score.over]
    for (score, x, y), rise in zip(points, _rises(points), strict=True):
        right = x < 50
        picture.add_annotation(
            x=x,
            y=y,
            text=score.name,
            arrowhead=0,
            arrowwidth=1,
            arrowcolor=_MARK,
            standoff=8,
            ax=12 if right else -12,
            ay=-rise,
            xanchor="left" if right else "right",
        )
    for chosen, name, color, size in ((False, "not chosen", RIGID, 11), (True, "chosen", COMPENSATED, 16)):
        some = [point for point in points if (choice is not None and point[0].name == choice.chosen) is chosen]
        if some:
            picture.add_scatter(
                x=[point[1] for point in some],
                y=[point[2] for point in some],
                mode="markers",
                name=name,
                marker={"size": size, "color": color, "symbol": "diamond" if chosen else "circle"},
                customdata=[point[0].name for point in some],
                hovertemplate="%{customdata}: %{x:.3~g} % nominally, %{y:.3~g} % in every case<extra></extra>",
            )
    frame(picture, 430, top=40, hover="closest")
    picture.add_vline(100 * WHOLE_NOMINAL, line={"color": _MARK, "dash": "dash", "width": 1})
    picture.add_hline(100 * WHOLE_WORST, line={"color": _MARK, "dash": "dash", "width": 1})
    picture.update_xaxes(title_text="Passes with the nominal plant, % of the settings", range=[-4, 104])
    picture.update_yaxes(title_text="Passes in every case, %", range=[-4, 112], tickvals=[0, 20, 40, 60, 80, 100])
    picture.update_layout(showlegend=choice is not None)
    return picture


def _percent(score: Score) -> tuple[float, float]:
    shares = score.over.shares if score.over else None
    return (100 * shares.nominal_share, 100 * shares.worst_case_share) if shares else (np.nan, np.nan)


_Point = tuple[Score, float, float]


def _rises(points: list[_Point]) -> list[float]:
    """Height of each label above its point in pixels, without overlaps even on a narrow page."""
    placed: list[tuple[float, float]] = []
    rises = [0.0] * len(points)
    for index in sorted(range(len(points)), key=lambda k: points[k][1:], reverse=True):
        _, x, y = points[index]
        left = x if x < 50 else x - _WIDE
        rise = _LEAST_RISE
        while any(abs(left - other) < _WIDE and abs(y * _PIXELS + rise - top) < _LINE for other, top in placed):
            rise += _LINE
        placed.append((left, y * _PIXELS + rise))
        rises[index] = rise
    return rises


_LEAST_RISE, _LINE = 16.0, 16.0
"""Pixels from a point to its label, and from one label to the next above it."""

_WIDE = 40.0
"""Percent of the axis that a label may take on a phone."""

_PIXELS = 3.0
"""Pixels of height for a percent."""


@dataclass(frozen=True)
class _Row:
    """One row of bars: title, a value for each law, and the required value, if any."""

    title: str
    values: list[float]
    required: float | None = None


def bars(scored: LawScores, units: UnitSystem) -> go.Figure:
    """Margins, noise and current of each law at the loader's own setting, a row each."""
    rows = _rows(scored, units)
    names = [score.name for score in scored.scores]
    picture = make_subplots(rows=len(rows), cols=1, shared_xaxes=True, vertical_spacing=0.055)
    for k, row in enumerate(rows, start=1):
        known = [value if isfinite(value) else None for value in row.values]
        picture.add_bar(x=names, y=known, marker_color=RIGID, row=k, col=1, hovertemplate="%{y:.3~g}<extra></extra>")
        if row.required is not None:
            picture.add_hline(row.required, line={"color": _MARK, "dash": "dash", "width": 1}, row=k, col=1)
    frame(picture, 118 * len(rows) + 70, top=14, hover="closest")
    for k, row in enumerate(rows, start=1):
        picture.update_yaxes(title_text=row.title, rangemode="tozero", nticks=4, row=k, col=1)
        picture.update_yaxes(title_font_size=11.5, row=k, col=1)
    picture.update_xaxes(ticks="", type="category", automargin=True)
    picture.update_layout(showlegend=False, bargap=0.45)
    return picture


def _rows(scored: LawScores, units: UnitSystem) -> list[_Row]:
    stable = [score.own if score.own.stable else None for score in scored.scores]
    period_ms = 1e3 * scored.plan.loader["controller.period"]
    rows = [
        _Row("Gain may grow,<br>times", [own.margins.gain_up if own else np.nan for own in stable], LEAST_GAIN),
        _Row(
            "Phase,<br>deg",
            [degrees(own.margins.phase_rad) if own else np.nan for own in stable],
            degrees(LEAST_PHASE_RAD),
        ),
        _Row(
            "Delay,<br>ms",
            [1e3 * own.margins.delay_s if own else np.nan for own in stable],
            LEAST_PERIODS * period_ms if period_ms else None,
        ),
        _Row("Peak current,<br>%", [100 * own.demand.current if own else np.nan for own in stable], 100.0),
    ]
    noise = [own.noise if own else None for own in stable]
    if scored.sampled:
        rows += [
            _Row(
                "Noise, angle,<br>0.001 deg", [1e3 * degrees(level.angle_rad) if level else np.nan for level in noise]
            ),
            _Row(
                f"Noise, hand,<br>{FORCE.shown(units)}",
                [FORCE.from_si(level.force_n, units) if level else np.nan for level in noise],
            ),
        ]
    return rows


def release(scored: LawScores, scores: tuple[Score, ...]) -> go.Figure:
    """Release at the loader's own setting with each stable law, and with I, B and G alone."""
    picture = go.Figure()
    inertia, _, stiffness = (scored.plan.loader[key] for key in FEEL_SETTING)
    end = _SHOWN_PERIODS * 2 * np.pi * (inertia / stiffness) ** 0.5
    looks = (
        LineStyle(COMPENSATED, "solid", 2.8),
        *(LineStyle(color, "dashdot") for color in ("#0072B2", "#D55E00", "#A8568A", "#B57A00")),
    )
    for k, score in enumerate(score for score in scores if score.own.stable):
        released = score.own.release
        seen = released.time_s <= end
        add_curve(
            picture,
            released.time_s[seen],
            np.degrees(released.angle_rad[seen]),
            score.name,
            looks[k % len(looks)],
            "%{y:.3f}°",
        )
    ideal = scores[0].own.release
    seen = ideal.time_s <= end
    add_curve(
        picture,
        ideal.time_s[seen],
        np.degrees(ideal.ideal_rad[seen]),
        "I, B, G alone",
        LineStyle(IDEAL, "dot"),
        "%{y:.3f}°",
    )
    frame(picture, 360, top=40)
    picture.update_xaxes(title_text="Time, s", range=[0, end])
    picture.update_yaxes(title_text="Column angle, deg", **ZERO)
    return picture
