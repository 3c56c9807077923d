"""A static sweep of a control: neutral, stop, opposite stop, neutral, with the force that it takes.

``F_up``, ``F_down`` force while the position rises and falls · ``M = (F_up + F_down) / 2`` what the spring takes ·
``(F_up - F_down) / 2`` friction, half the width of the loop
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from forcefeel.errors import InputError
from forcefeel.qualification.figures import Figure, combined
from forcefeel.qualification.records import PositionUnit, Record
from forcefeel.qualification.sweep_curves import Curves, curves_of

_MIDDLE = 0.8
"""Share of the travel, around its middle, over which friction is the median."""
_SIDE = (0.02, 0.20)
"""Shares of the travel from neutral between which the gradient of a side is read."""
_ONSET = (0.03, 0.15)
"""Shares of the largest spring force between which the spring's line is laid back to where its force begins."""
_SLOPE = 0.03
"""Share of the travel over which the force's rise after the first move is read."""

_Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SweepFeatures:
    """What the static tests compare. Positions in rad or m, forces in N.

    Attributes:
        name: Of the record.
        position: Grid of positions (points,), from stop to stop.
        force_up_n, force_down_n: Force while the position rises and falls (points,); not a number where it was not.
        surface_up_rad, surface_down_rad: The same of the surface; ``None`` if it was not recorded.
        friction_curve_n: Half the loop's width (points,).
        force_uncertainty_n: Standard uncertainty of a point of the curves.
        breakout: Force at which the position first moves.
        friction: Median of half the loop's width over the middle of the travel.
        freeplay: Travel around neutral over which the spring takes no force.
        centring: Largest distance from neutral at which the control rests without a force, coming from either side.
        gradient: Slope of the spring force near neutral, mean of both sides.
        gradient_low, gradient_high: Of the side below and above neutral.
        neutral: Where it began.
        stops: Lowest and highest position.
        duration_s: How long the sweep took.
        position_unit: ``rad`` or ``m``.
    """

    name: str
    position: _Array
    force_up_n: _Array
    force_down_n: _Array
    surface_up_rad: _Array | None
    surface_down_rad: _Array | None
    friction_curve_n: _Array
    force_uncertainty_n: float
    breakout: Figure
    friction: Figure
    freeplay: Figure
    centring: Figure
    gradient: Figure
    gradient_low: Figure
    gradient_high: Figure
    neutral: float
    stops: tuple[float, float]
    duration_s: float
    position_unit: PositionUnit


def measure_sweep(record: Record, *, points: int = 401) -> SweepFeatures:
    """The features of a sweep to both stops.

    Args:
        record: Begins at neutral, goes to one stop, to the other and back, with the force.
        points: Positions at which the curves are given; samples between two of them are averaged.

    Raises:
        InputError: With the record's name and a time: no force, no way to both sides, a direction that is missing.
    """
    if record.force_n is None:
        raise InputError(
            f"{record.name}: expected a force beside the position; record it, or name its column 'force (N)'"
        )
    if not 21 <= points <= 10_001:
        raise InputError(f"points: expected 21 to 10001, got {points}")
    curves = curves_of(record, record.force_n, points)
    x, up, down = curves.position, curves.force_up_n, curves.force_down_n
    spring, friction = (up + down) / 2, (up - down) / 2
    low, high = (_side(curves, spring, sign, record.position_unit) for sign in (-1.0, 1.0))
    gradient = Figure((low.value + high.value) / 2, combined(low.uncertainty, high.uncertainty) / 2, low.unit)
    middle = np.abs(x - (x[0] + x[-1]) / 2) <= _MIDDLE / 2 * (x[-1] - x[0])
    return SweepFeatures(
        name=record.name,
        position=x,
        force_up_n=up,
        force_down_n=down,
        surface_up_rad=curves.surface_up_rad,
        surface_down_rad=curves.surface_down_rad,
        friction_curve_n=friction,
        force_uncertainty_n=curves.force_uncertainty_n,
        breakout=_breakout(record, record.force_n, curves),
        friction=_median(friction[middle & np.isfinite(friction)], curves.force_uncertainty_n),
        freeplay=_freeplay(curves, spring, record.position_unit),
        centring=_centring(curves, record.position_unit),
        gradient=gradient,
        gradient_low=low,
        gradient_high=high,
        neutral=curves.neutral,
        stops=(float(x[0]), float(x[-1])),
        duration_s=record.duration_s,
        position_unit=record.position_unit,
    )


def _breakout(record: Record, force: _Array, curves: Curves) -> Figure:
    """The force when the position leaves neutral, less what the spring took until the move was seen."""
    x, first = record.position, curves.moved
    away = np.abs(x - curves.neutral)
    near = np.arange(len(x)) >= first
    near &= (np.arange(len(x)) <= curves.turns[0]) & (
        away <= away[first] + _SLOPE * (curves.position[-1] - curves.position[0])
    )
    slope = _line(away[near], np.abs(force[near]))[1]
    slope = max(slope, 0.0) if math.isfinite(slope) else 0.0
    # With static friction the force falls as the control breaks away: then the last sample before it says more.
    value = max(abs(float(force[first])) - slope * float(away[first]), abs(float(force[first - 1])))
    stepped = abs(abs(float(force[first])) - abs(float(force[first - 1]))) / math.sqrt(12)
    position = combined(record.position_noise, record.position_resolution / math.sqrt(12))
    return Figure(max(value, 0.0), combined(record.force_uncertainty_n, slope * position, stepped), "N")


def _median(values: _Array, each: float) -> Figure:
    if not len(values):
        return Figure(math.nan, math.nan, "N")
    scatter = 1.4826 * float(np.median(np.abs(values - np.median(values))))
    return Figure(
        float(np.median(values)), combined(1.2533 * scatter / math.sqrt(len(values)), each / math.sqrt(2)), "N"
    )


def _side(curves: Curves, spring: _Array, sign: float, unit: PositionUnit) -> Figure:
    """Slope of the spring force on one side of neutral."""
    x, travel = curves.position, curves.position[-1] - curves.position[0]
    off = sign * (x - curves.neutral)
    there = (off >= _SIDE[0] * travel) & (off <= _SIDE[1] * travel) & np.isfinite(spring)
    _, slope, _, known = _line(x[there], spring[there])
    return Figure(slope, known, f"N/{unit}")


def _freeplay(curves: Curves, spring: _Array, unit: PositionUnit) -> Figure:
    """Between where the lines of both sides begin; nothing where they meet before, as with a spring that is preloaded."""
    x, known = curves.position, np.isfinite(spring)
    most = float(np.max(np.abs(spring[known]), initial=0.0))
    begins, uncertainty = [], [(x[1] - x[0]) / math.sqrt(12)]
    for sign in (-1.0, 1.0):
        size, off = sign * spring, sign * (x - curves.neutral)
        onset = max(_ONSET[0] * most, 3 * curves.force_uncertainty_n)
        beyond = known & (off > 0) & (size > onset)
        begins_at = float(np.min(size[beyond], initial=np.inf))
        rising = beyond & (size <= begins_at + (_ONSET[1] - _ONSET[0]) * most)
        # Position over force: where the force is nothing.
        begin, _, deviation, _ = _line(size[rising], off[rising])
        begins.append(begin)
        uncertainty.append(deviation)
    width = sum(begins)
    return Figure(max(width, 0.0) if math.isfinite(width) else math.nan, combined(*uncertainty), unit)


def _centring(curves: Curves, unit: PositionUnit) -> Figure:
    x, bin_known = curves.position, (curves.position[1] - curves.position[0]) / math.sqrt(3)
    rests, known = [], []
    for force in (curves.force_up_n, curves.force_down_n):
        finite = np.isfinite(force)
        at, size = x[finite], force[finite]
        passes = np.flatnonzero((size[:-1] <= 0) & (size[1:] > 0))
        if not len(passes):
            continue
        nearest = passes[np.argmin(np.abs(at[passes] - curves.neutral))]
        slope = (size[nearest + 1] - size[nearest]) / (at[nearest + 1] - at[nearest])
        rests.append(float(at[nearest] - size[nearest] / slope) - curves.neutral)
        known.append(curves.force_uncertainty_n / float(slope))
    if not rests:
        return Figure(math.nan, math.nan, unit)
    return Figure(max(map(abs, rests)), combined(max(known), bin_known), unit)


def _line(x: _Array, y: _Array) -> tuple[float, float, float, float]:
    """Value at zero and slope of the line through points by least squares, and their standard deviations."""
    if len(x) < 3 or np.ptp(x) == 0:
        return math.nan, math.nan, math.nan, math.nan
    centre = float(np.mean(x))
    squares = float(np.sum((x - centre) ** 2))
    slope = float(np.sum((x - centre) * (y - np.mean(y)))) / squares
    level = float(np.mean(y))
    variance = float(np.sum((y - level - slope * (x - centre)) ** 2)) / (len(x) - 2)
    at_zero = math.sqrt(variance * (1 / len(x) + centre**2 / squares))
    return level - slope * centre, slope, at_zero, math.sqrt(variance / squares)
