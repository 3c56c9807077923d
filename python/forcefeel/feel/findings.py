"""Conclusions of a fit as sentences: what the points show, and what they leave open."""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from forcefeel.conclusions import Conclusions, of_result
from forcefeel.feel.directions import Directions, both_ways
from forcefeel.feel.result import FeelFit, Source
from forcefeel.loader.parameters import ALTERNATIVES, TABLE, unit
from forcefeel.qualification.throw import Throw
from forcefeel.units import ANGLE, FORCE, UnitSystem, to_text

_DIGITS = 3
_GAP = 0.3
"""Share of the travel of the points above which a gap between neighbors is reported."""
_BEYOND = 1.1
"""Ratio of the throw to the farthest point above which the extrapolation is reported."""
_WIDE = 0.05
"""Share of the largest force above which the scatter is reported as large."""
_INSIDE = 0.1
"""Share of the travel from neutral that must hold points for breakout and deadband to be separable."""


@of_result
def feel_conclusions(fit: FeelFit, units: UnitSystem) -> Conclusions:
    """What an engineer should conclude from a fit.

    Example:
        >>> angle = np.radians([-8, -6, -4, -2, 2, 4, 6, 8])
        >>> points = ff.qualification.ForcePoints(angle, 300 * angle + 10 * np.sign(angle))
        >>> fit = ff.feel.fit_feel(points, ff.feel.FeelPlan(ff.digital_elevator()))
        >>> ff.feel.feel_conclusions(fit, ff.UnitSystem.SI).verdict.partition(": ")[2]
        'a straight spring, breakout.'
    """
    largest = to_text(FORCE.from_si(float(np.abs(fit.residual_n).max()), units), _DIGITS)
    verdict = f"The feel follows {len(fit.residual_n)} points within {largest} {FORCE.shown(units)}: {shape_text(fit)}."
    findings = (*_scatter(fit, units), *_open(fit, units), *_friction(fit), *_motion(fit, units), *_replaced(fit))
    return Conclusions(True, verdict, findings)


def shape_text(fit: FeelFit) -> str:
    """The parts of the programmed feel in words."""
    points = len(fit.curve_half_intervals_n)
    parts = [f"a force curve of {points} points" if points else "a straight spring"]
    rows = {"coulomb_friction": "friction", "preload": "preload", "hysteresis": "hysteresis"}
    rows |= {"breakout": "breakout", "deadband": "a deadband"}
    parts += [text for key, text in rows.items() if fit.row(f"feel.{key}")]
    return ", ".join([*parts, *(["soft stops"] if fit.shape.stop else [])])


def _scatter(fit: FeelFit, units: UnitSystem) -> Iterator[str]:
    share = fit.scatter_n / float(np.abs(fit.points.force_n).max())
    text = f"Scatter about the feel: {_force(fit.scatter_n, units)}, {to_text(100 * share, 2)} % of the largest force"
    yield f"{text}; large: check the points, or add a column for the flight condition." if share > _WIDE else f"{text}."
    if fit.points.condition:
        yield f"Flight condition: {fit.points.condition}."
    for first, other in fit.inseparable:
        yield f"{first} and {other} are correlated: the points fix their sum better than either."


def _open(fit: FeelFit, units: UnitSystem) -> Iterator[str]:
    """What the positions of the points leave open."""
    x = np.sort(fit.points.position)
    low, high = float(x[0]), float(x[-1])
    for side, reached, end in (("below", low, min(low, 0.0)), ("beyond", high, max(high, 0.0))):
        if reached * end <= 0:
            yield f"No point on the {'negative' if side == 'below' else 'positive'} side: the feel there mirrors the other side."
    throw = Throw.of(fit.loader)
    for end, reached, word in ((low, throw.low_rad, "below"), (high, throw.high_rad, "beyond")):
        if abs(reached) > _BEYOND * abs(end) and end * reached > 0:
            yield f"No point {word} {_angle(end, units)}: up to the throw of {_angle(reached, units)} the feel is extrapolated."
    stops = fit.loader["column.stop_low"], fit.loader["column.stop_high"]
    if low < stops[0] or high > stops[1]:
        yield f"Points lie beyond the column's end stops, {_angle(stops[0], units)} and {_angle(stops[1], units)}."
    gaps = [(float(b - a), float(a), float(b)) for a, b in pairwise(x.tolist())]
    width, begin, end = max(gaps)
    if width > _GAP * (high - low):
        yield f"No point between {_angle(begin, units)} and {_angle(end, units)}."
    nearest = float(np.abs(x).min())
    if fit.row("feel.breakout") and nearest > _INSIDE * float(np.abs(x).max()):
        yield (
            f"No point within {_angle(nearest, units)} of neutral: breakout is extrapolated, and a deadband would only lower it."
        )
    if not fit.shape.stop and fit.row("feel.soft_stop_high") is None:
        yield f"No soft stop shows between {_angle(low, units)} and {_angle(high, units)}."


def _friction(fit: FeelFit) -> Iterator[str]:
    """How friction and hysteresis were told from breakout."""
    points, stated = fit.points, fit.row("feel.coulomb_friction")
    if fit.directions is Directions.OUTWARD:
        yield "The file states no direction, and the points lie on one line: each is taken as moving away from neutral."
    if fit.directions is Directions.ASSIGNED:
        yield (
            "The file states no direction: points above the mean curve are taken as on the way up. A column 'direction' or "
            "'time (s)' would prove it."
        )
    if not both_ways(points.position, points.directions):
        if not any(row and row.source is Source.STATED for row in (stated, fit.row("feel.breakout"))):
            yield (
                "Friction and breakout cannot be told apart without points on the way back: their sum is programmed as breakout. "
                "State --friction to divide it."
            )
        return
    if fit.row("feel.hysteresis") is None:
        yield (
            "Hysteresis cannot be told from friction without points in the order of time, right after each reversal."
            if not points.in_order
            else "No hysteresis shows: the force jumps where the control turns back."
        )


def _motion(fit: FeelFit, units: UnitSystem) -> Iterator[str]:
    """Where frequency and damping come from."""
    rows = {key: fit.row(f"feel.{key}") for key in ("natural_frequency", "damping_ratio")}
    kept = [key for key, row in rows.items() if row and row.source is Source.LOADER]
    if kept:
        values = " and ".join(_row_text(fit, key, units) for key in kept)
        yield f"The data leave {' and '.join(key.replace('_', ' ') for key in kept)} open: {values}, as of the loader."
    if fit.release is not None:
        release = fit.release
        scatter = f"{to_text(ANGLE.from_si(release.scatter_rad, units), 2)} {ANGLE.shown(units)}"
        yield f"The release of {release.record.name} follows the feel within {scatter} r.m.s."
        if abs(release.offset_rad) > 3 * release.scatter_rad:
            yield f"Its positions are {_angle(release.offset_rad, units)} off the neutral of the points."
    if fit.row("feel.soft_stop_damping"):
        yield "No point shows the damping of the soft stops: feel.soft_stop_damping keeps the damping ratio of the spring."
    if fit.curve_half_intervals_n:
        yield "Frequency and damping ratio hold for feel.stiffness, the mean slope of the curve over the middle half of its travel."


def _replaced(fit: FeelFit) -> Iterator[str]:
    off = [
        key for key in fit.replaced if key.startswith("feel.") and fit.row(key) is None and key != "feel.force_curve"
    ]
    if off:
        yield f"Switched off in the loader's former feel: {', '.join(off)}."


def _row_text(fit: FeelFit, key: str, units: UnitSystem) -> str:
    row = fit.row(f"feel.{key}")
    assert row is not None  # frequency and damping ratio are always there
    measured_in = unit(ALTERNATIVES[row.key])
    return f"{to_text(measured_in.from_si(row.value_si, units), _DIGITS)} {measured_in.shown(units)}".rstrip()


def row_cells(fit: FeelFit, units: UnitSystem) -> Iterator[tuple[str, str, str, str, str]]:
    """Name, value, interval, unit and source of each row, for terminal and page."""
    for row in fit.rows:
        if fit.curve_half_intervals_n and row.key == "feel.stiffness":
            largest = FORCE.from_si(max(fit.curve_half_intervals_n), units)
            count = f"{len(fit.curve_half_intervals_n)} points"
            yield "feel.force_curve", count, f"at most {to_text(largest, 2)}", FORCE.shown(units), str(Source.POINTS)
        measured_in = unit((TABLE | ALTERNATIVES)[row.key])
        half = "" if row.half_interval_si is None else to_text(abs(measured_in.from_si(row.half_interval_si, units)), 2)
        value = to_text(measured_in.from_si(row.value_si, units), 4)
        yield row.key, value, half, measured_in.shown(units), str(row.source)


def _force(value: float, units: UnitSystem) -> str:
    return f"{to_text(FORCE.from_si(value, units), _DIGITS)} {FORCE.shown(units)}"


def _angle(value: float, units: UnitSystem) -> str:
    return f"{to_text(ANGLE.from_si(value, units), _DIGITS)} {ANGLE.shown(units)}"
