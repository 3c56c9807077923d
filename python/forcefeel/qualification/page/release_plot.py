"""The plot of a release: both curves, with the compared quantities, their names and tolerances."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from forcefeel.page.canvas import add_curve, drawn, frame
from forcefeel.page.palette import IDEAL, LineStyle
from forcefeel.qualification.plan.result import Qualification, Result, Side
from forcefeel.qualification.plan.sentences import UNITS
from forcefeel.qualification.release import ReleaseFeatures
from forcefeel.qualification.rules import ReleaseRules

REFERENCE = LineStyle(IDEAL, "dot", 2.0)
BAND = "rgba(34,34,34,0.10)"
_TOLERANCE = "#6B7580"
_MOST_POINTS = 1200
_SHOWN = 1.25
"""Drawn duration, as a multiple of the longer of the two settling times."""
_ROOM = 0.06
"""Least distance between labels, as a share of the drawn duration: the width of a label on a phone."""

_Limits = Mapping[str, float]
"""Tolerances by quantity, in SI units."""


def release(result: Result, qualification: Qualification, color: str) -> go.Figure:
    """Position from each record's steady state over time from its release, with the tolerances of the reference."""
    assert result.measured
    assert result.reference
    picture = make_subplots(rows=1, cols=1)
    unit = UNITS[result.measured.record.position_unit]
    scale, unit_name = unit.from_si(1.0, qualification.system), unit.shown(qualification.system)
    reference = _features(result.reference)
    end = _SHOWN * max(span.settled_s - span.release_s.value for span in (_features(result.measured), reference))
    band = reference.band * scale
    gray = {"fillcolor": BAND, "line_width": 0, "layer": "below"}
    picture.add_hrect(-band, band, **gray, exclude_empty_subplots=False)  # the curves come after it
    for side, name, look in (
        (result.reference, "reference", REFERENCE),
        (result.measured, "measured", LineStyle(color, "solid", 2.4)),
    ):
        time = side.signals.time_s - _features(side).release_s.value
        seen = np.flatnonzero((time >= -0.05 * end) & (time <= end))
        kept = seen[drawn(side.record.position[seen], _MOST_POINTS)]
        position = (side.record.position[kept] - _features(side).steady.value) * scale
        add_curve(picture, time[kept], position, name, look, f"%{{y:.3~g}} {unit_name}")
    _marks(picture, result, qualification, color, _ROOM * end)
    frame(picture, 380)
    picture.update_xaxes(
        title_text="Time from release, s", range=[-0.03 * end, end], unifiedhovertitle={"text": "%{x:.3f} s"}
    )
    picture.update_yaxes(title_text=f"From steady state, {unit_name}", zeroline=True, zerolinecolor="#8A939E")
    return picture


def _marks(picture: go.Figure, result: Result, qualification: Qualification, color: str, room_s: float) -> None:
    """Compared times and overshoots of both curves, with names and tolerances on the reference."""
    assert result.measured
    assert result.reference
    limits = {verdict.quantity: verdict.tolerance for verdict in result.verdicts if np.isfinite(verdict.tolerance)}
    scale = UNITS[result.measured.record.position_unit].from_si(1.0, qualification.system)
    rules, reference = qualification.rules.release, _features(result.reference)
    for features, shade, fill in ((reference, IDEAL, "#FFFFFF"), (_features(result.measured), color, color)):
        _circles(picture, _judged_points(features, limits, rules, scale), shade, fill)
    _mark_spans(picture, reference, rules, limits, scale, room_s)
    _mark_overshoots(picture, reference, limits, scale, room_s)


def _mark_spans(
    picture: go.Figure, features: ReleaseFeatures, rules: ReleaseRules, limits: _Limits, scale: float, room_s: float
) -> None:
    """Tolerance of each time at its end, and a double arrow with its name."""
    spans = [span for span in _spans(features, rules) if span.name in limits]
    if not spans:
        return
    away = features.displacement.value * scale
    named, height = [spans[k] for k in _apart([span.end_s for span in spans], room_s)], rules.high * away
    x = [at for span in named for at in (span.end_s, span.end_s, None)]
    y = [at for span in named for at in (span.foot * away, height, None)]
    drop = {"color": _TOLERANCE, "width": 1, "dash": "dot"}
    picture.add_scatter(x=x, y=y, mode="lines", line=drop, showlegend=False, hoverinfo="skip")
    arrow = {"axref": "x", "ayref": "y", "arrowside": "end+start", "arrowhead": 2, "startarrowhead": 2}
    arrow |= {"arrowcolor": _TOLERANCE, "arrowwidth": 1}
    for span in named:
        picture.add_annotation(x=span.end_s, y=height, ax=span.start_s, ay=height, text="", **arrow)
        middle = (span.start_s + span.end_s) / 2
        picture.add_annotation(x=middle, y=height, text=span.name, showarrow=False, yanchor="bottom", yshift=1)
    foot = [span.foot * away for span in spans]
    width = [limits[span.name] for span in spans]
    _bars(picture, [span.end_s for span in spans], foot, "tolerance of times", error_x=width)


def _mark_overshoots(
    picture: go.Figure, features: ReleaseFeatures, limits: _Limits, scale: float, room_s: float
) -> None:
    """Tolerance of each overshoot, with its name beyond it."""
    tops = [overshoot for overshoot in _overshoots(features, scale) if overshoot[0] in limits]
    if not tops:
        return
    for side in (tops[::2], tops[1::2]):
        for k in _apart([time for _, time, _ in side], room_s):
            name, time, top = side[k]
            outward = 1 if top > 0 else -1
            where = {"y": top + outward * limits[name] * scale, "yanchor": "bottom" if top > 0 else "top"}
            picture.add_annotation(x=time, text=name, showarrow=False, yshift=3 * outward, **where)
    names, at, height = zip(*tops, strict=True)
    _bars(picture, at, height, "tolerance of overshoots", error_y=[limits[name] * scale for name in names])


def _apart(times_s: list[float], room_s: float) -> list[int]:
    """Indices of rising times with room for a label: the first, and each far enough from the last labeled one."""
    kept: list[int] = []
    for k, time in enumerate(times_s):
        if not kept or time - times_s[kept[-1]] >= room_s:
            kept.append(k)
    return kept


@dataclass(frozen=True)
class _Span:
    """A compared time.

    Attributes:
        name: Its name, such as ``P0``.
        start_s, end_s: Start and end from the release.
        foot: Position at its end as a share of Ad.
    """

    name: str
    start_s: float
    end_s: float
    foot: float


def _spans(features: ReleaseFeatures, rules: ReleaseRules) -> list[_Span]:
    """All times that can be compared for a release."""
    low = features.rise_time.value
    high = low - features.fall_time.value
    passes = _crossings(features)
    spans = [_Span("fall time", high, low, rules.low), _Span("rise time", 0.0, low, rules.low)]
    spans += [_Span("P0", high, end, 0.0) for end in passes[:1]]
    return spans + [_Span(f"P{n}", *ends, 0.0) for n, ends in enumerate(pairwise(passes[::2]), start=1)]


def _crossings(features: ReleaseFeatures) -> list[float]:
    return [time - features.release_s.value for time in features.crossing_times_s]


def _overshoots(features: ReleaseFeatures, scale: float) -> list[tuple[str, float, float]]:
    """Name, time from the release and position of each."""
    sign = -1.0 if features.displacement.value > 0 else 1.0
    both = zip(features.overshoots, features.overshoot_times_s, strict=False)
    return [
        (f"A{k + 1}", time - features.release_s.value, sign * (-1.0) ** k * size.value * scale)
        for k, (size, time) in enumerate(both)
    ]


def _judged_points(
    features: ReleaseFeatures, judged: Collection[str], rules: ReleaseRules, scale: float
) -> list[tuple[float, float]]:
    """Ends of the compared times, zero crossings up to the last of them, and compared overshoots."""
    away = features.displacement.value * scale
    spans = [span for span in _spans(features, rules) if span.name in judged]
    last = max((span.end_s for span in spans), default=0.0)
    points = [(span.start_s, rules.high * away) for span in spans if span.name in {"P0", "fall time"}]
    points += [(span.end_s, span.foot * away) for span in spans if span.foot]
    points += [(time, 0.0) for time in _crossings(features) if time <= last and "P0" in judged]
    return points + [(time, top) for name, time, top in _overshoots(features, scale) if name in judged]


def _circles(picture: go.Figure, points: list[tuple[float, float]], shade: str, fill: str) -> None:
    if not points:
        return
    x, y = zip(*points, strict=True)
    marker = {"size": 7, "color": fill, "line": {"color": shade, "width": 1.6}}
    picture.add_scatter(x=x, y=y, mode="markers", marker=marker, showlegend=False, hoverinfo="skip")


def _bars(picture: go.Figure, x: object, y: object, name: str, **errors: object) -> None:
    ((kind, size),) = errors.items()
    bar = {"type": "data", "array": size, "color": _TOLERANCE, "thickness": 2, "width": 5}
    marker = {"size": 4, "color": _TOLERANCE}
    picture.add_scatter(x=x, y=y, mode="markers", name=name, marker=marker, hoverinfo="skip", **{kind: bar})


def _features(side: Side) -> ReleaseFeatures:
    assert isinstance(side.features, ReleaseFeatures)  # a release's result
    return side.features
