"""The plots of a qualification: measured and reference curves with the tolerance band."""

import numpy as np
import plotly.graph_objects as go
from numpy.typing import NDArray
from plotly.subplots import make_subplots

from forcefeel.page.canvas import add_curve, frame
from forcefeel.page.palette import COMPENSATED, COMPLIANT, RIGID, LineStyle
from forcefeel.qualification import ForcePoints
from forcefeel.qualification.page.release_plot import BAND, REFERENCE, release
from forcefeel.qualification.plan.result import Qualification, Result, Side
from forcefeel.qualification.plan.sentences import UNITS
from forcefeel.qualification.sweep import SweepFeatures
from forcefeel.qualification.tolerance import Tolerance
from forcefeel.units import FORCE, factor

_COLORS = {"original": COMPLIANT, "published": COMPENSATED, "converged": RIGID}

_Array = NDArray[np.float64]


def color(section: str) -> str:
    """The color of a law."""
    return _COLORS.get(section, COMPENSATED)


def sweep(result: Result, qualification: Qualification, section: str) -> go.Figure:
    """Force over position in both directions; for a medium or fast sweep, the force minus that of the slow one."""
    assert result.measured
    assert result.reference
    picture = make_subplots(rows=1, cols=1)
    system = qualification.system
    measured, reference = _curves(result.measured), _curves(result.reference)
    unit = UNITS[result.measured.record.position_unit]
    scale, force = unit.from_si(1.0, system), FORCE.from_si(1.0, system)
    rule = _rule(result)
    hover = f"%{{x:.3~g}} {unit.shown(system)}, %{{y:.3~g}} {FORCE.shown(system)}"
    for k, direction in enumerate(("up", "down")):
        at, curve = reference[direction]
        limit = rule.limit(curve, system=system)
        _band(picture, at * scale, (curve - limit) * force, (curve + limit) * force, first=k == 0)
    for curves, name, look in (
        (reference, "reference", REFERENCE),
        (measured, "measured", LineStyle(color(section), "solid", 2.2)),
    ):
        for direction in ("up", "down"):
            at, curve = curves[direction]
            add_curve(
                picture,
                at * scale,
                curve * force,
                name,
                look,
                f"{name}, {direction}: {hover}<extra></extra>",
                legendgroup=name,
                showlegend=direction == "up",
            )
    if isinstance(result.reference.record, ForcePoints):
        picture.update_traces(
            selector={"name": "reference"}, mode="markers", marker={"size": 9, "color": REFERENCE.color}
        )
    frame(picture, 420, hover="closest")
    what = "Force" if result.measured.slow is None else "Above the slow sweep"
    picture.update_xaxes(title_text=f"Position from neutral, {unit.shown(system)}")
    picture.update_yaxes(title_text=f"{what}, {FORCE.shown(system)}", zeroline=True, zerolinecolor="#8A939E")
    return picture


def small_inputs(result: Result, section: str) -> go.Figure:
    """Body rate over time."""
    assert result.measured
    assert result.reference
    picture = make_subplots(rows=1, cols=1)
    degrees = factor("rad", "deg")
    limit = next((verdict.tolerance for verdict in result.verdicts if np.isfinite(verdict.tolerance)), 0.0) * degrees
    for side, name, look in (
        (result.reference, "reference", REFERENCE),
        (result.measured, "measured", LineStyle(color(section), "solid", 2.4)),
    ):
        rate = side.signals.body_rate_rad_per_s
        if rate is None:
            continue
        time = side.signals.time_s - side.signals.time_s[0]
        if side is result.reference:
            _band(picture, time, rate * degrees - limit, rate * degrees + limit, first=True)
        add_curve(picture, time, rate * degrees, name, look)
    frame(picture, 380)
    picture.update_xaxes(title_text="Time, s")
    picture.update_yaxes(title_text="Body rate, deg/s")
    return picture


def _band(picture: go.Figure, x: _Array, low: _Array, high: _Array, *, first: bool) -> None:
    known = np.isfinite(low) & np.isfinite(high)
    picture.add_scatter(
        x=np.concatenate([x[known], x[known][::-1]]),
        y=np.concatenate([low[known], high[known][::-1]]),
        fill="toself",
        fillcolor=BAND,
        line={"width": 0},
        mode="lines",
        name="tolerance",
        legendgroup="tolerance",
        showlegend=first,
        hoverinfo="skip",
    )


def _curves(side: Side) -> dict[str, tuple[_Array, _Array]]:
    """Position from neutral and force in each direction, minus the force of the slow sweep where there is one."""
    swept = side.features
    assert isinstance(swept, SweepFeatures)  # a sweep's result
    at = swept.position - swept.neutral
    curves = {}
    for direction in ("up", "down"):
        force = _way(swept, direction)
        if side.slow is not None:
            slow = side.slow
            force = force - np.interp(
                at, slow.position - slow.neutral, _way(slow, direction), left=np.nan, right=np.nan
            )
        curves[direction] = at, force
    return curves


def _way(swept: SweepFeatures, direction: str) -> _Array:
    return swept.force_up_n if direction == "up" else swept.force_down_n


def _rule(result: Result) -> Tolerance:
    compared = {"force", "dynamic increment"}
    return next(tolerance for tolerance in result.trial.test.tolerances if tolerance.quantity in compared)


def drawn(result: Result, qualification: Qualification, section: str) -> go.Figure | None:
    """The plot of a test; ``None`` where nothing can be drawn."""
    if result.measured is None or result.reference is None:
        return None
    match result.trial.test.kind:
        case "release":
            return release(result, qualification, color(section))
        case "small inputs":
            return small_inputs(result, section)
        case "freeplay":  # of the static sweep
            return None
        case "static" if any(verdict.rule.quantity == "surface" for verdict in result.verdicts):
            return None
    return sweep(result, qualification, section)
