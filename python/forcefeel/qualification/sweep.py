"""A static sweep of a control: neutral, stop, opposite stop, neutral, with its force.

``F_up``, ``F_down`` force while the position rises and falls · ``M = (F_up + F_down) / 2`` spring force ·
``(F_up - F_down) / 2`` friction, half the width of the loop
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from forcefeel.errors import InputError
from forcefeel.qualification.breakout import NEAR, breakout
from forcefeel.qualification.figures import Figure, combined
from forcefeel.qualification.records import PositionUnit, Record
from forcefeel.qualification.static_force import MIDDLE, StaticForce, static_force
from forcefeel.qualification.sweep_curves import Legs

_SIDE = (0.02, 0.20)
"""Shares of the travel from neutral between which the gradient of a side is fitted."""
_ONSET = (0.03, 0.15)
"""Shares of the largest spring force between which the spring's line is fitted and extrapolated to zero force."""
_ONWARD = 0.01
"""Distance beyond a deadband's end at which the gradient fit begins, as a share of the travel."""
_SIDES = (-1.0, 1.0)
"""Below and above neutral."""
_SURE = 3.0
"""Standard uncertainties within which a force equals zero or another force."""
_AFTER = 9
"""Samples after the first motion that show whether the force falls."""

_Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SweepFeatures:
    """Features that the static tests compare; positions in rad or m, forces in N.

    Attributes:
        name: Name of the record.
        position: Grid of positions (points,), from stop to stop.
        force_up_n, force_down_n: Force while the position rises and falls (points,); NaN where it was not covered.
        surface_up_rad, surface_down_rad: Surface position likewise; ``None`` if it was not recorded.
        friction_curve_n: Half the loop's width (points,).
        force_uncertainty_n: Standard uncertainty of a point of the curves.
        breakout_low, breakout_high: Force at which the control leaves neutral, below and above it.
        friction: Median of half the loop's width over the middle of the travel.
        freeplay: Travel around neutral without spring force.
        centring: Largest distance from neutral at which the control rests without force, from either side.
        gradient: Slope of the spring force near neutral, mean of both sides.
        gradient_low, gradient_high: Slope below and above neutral.
        neutral: Position at the start.
        stops: Lowest and highest position.
        duration_s: Duration of the sweep.
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
    breakout_low: Figure
    breakout_high: Figure
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

    def breakout(self, side: Literal["positive", "negative"]) -> Figure:
        """Force at which the control leaves neutral, above or below it."""
        return self.breakout_high if side == "positive" else self.breakout_low


def measure_sweep(record: Record, *, points: int = 401) -> SweepFeatures:
    """The features of a sweep to both stops.

    Args:
        record: Sweep from neutral to one stop, the other stop and back, with force.
        points: Number of positions of the curves; samples around each are averaged.

    Raises:
        InputError: With the record's name and a time: no force, no travel to both sides, or a missing direction.

    Example:
        >>> time = np.linspace(0.0, 60.0, 3001)
        >>> angle = 0.3 * np.interp(time, [0, 15, 45, 60], [0.0, 1.0, -1.0, 0.0])
        >>> features = ff.qualification.measure_sweep(ff.qualification.Record(time, angle, 600.0 * angle))
        >>> type(features).__name__
        'SweepFeatures'
    """
    if record.force_n is None:
        raise InputError(f"{record.name}: expected a force for the position; record it, or name its column 'force (N)'")
    if not 21 <= points <= 10_001:
        raise InputError(f"points: expected 21 to 10001, got {points}")
    legs = Legs.of(record, points)
    x, known = legs.grid, record.force_uncertainty_n / math.sqrt(legs.samples_a_point)
    up, down = legs.curves(record.force_n)
    surface = (None, None) if record.surface_rad is None else legs.curves(record.surface_rad)
    static = static_force(record, record.force_n, legs)
    static_up, static_down = legs.curves(static.force_n, static.moving)
    spring, friction = (static_up + static_down) / 2, (static_up - static_down) / 2
    middle = np.abs(x - (x[0] + x[-1]) / 2) <= MIDDLE / 2 * (x[-1] - x[0])
    rubbing = _median(friction[middle & np.isfinite(friction)], combined(known, static.uncertainty_n))
    breakout_low, breakout_high = breakouts = _breakouts(record, static, legs)
    low, high = (
        _side(legs, spring, known, sign, broken.value - rubbing.value, record.position_unit)
        for sign, broken in zip(_SIDES, breakouts, strict=True)
    )
    gradient = Figure((low.value + high.value) / 2, combined(low.uncertainty, high.uncertainty) / 2, low.unit)
    return SweepFeatures(
        name=record.name,
        position=x,
        force_up_n=up,
        force_down_n=down,
        surface_up_rad=surface[0],
        surface_down_rad=surface[1],
        friction_curve_n=friction,
        force_uncertainty_n=known,
        breakout_low=breakout_low,
        breakout_high=breakout_high,
        friction=rubbing,
        freeplay=_freeplay(legs, spring, known, record.position_unit),
        centring=_centring(record, static.force_n, legs),
        gradient=gradient,
        gradient_low=low,
        gradient_high=high,
        neutral=legs.neutral,
        stops=(float(x[0]), float(x[-1])),
        duration_s=record.duration_s,
        position_unit=record.position_unit,
    )


def _breakouts(record: Record, static: StaticForce, legs: Legs) -> list[Figure]:
    """The force at which the control leaves neutral, below and above it.

    Static friction adds equally to both sides. It is visible only on the side where the control leaves neutral from rest.
    """
    known = [_built_up(record, static, legs, sign) for sign in _SIDES]
    away = _breakaway(record, static, legs, known)
    return [
        Figure(side.value + away.value, combined(side.uncertainty, away.uncertainty, static.uncertainty_n), "N")
        for side in known
    ]


def _near(static: StaticForce, legs: Legs, sign: float) -> tuple[_Array, _Array]:
    """Distance from neutral, and force away from it, of the samples near neutral on the way out to a side."""
    first, (turn, other) = legs.moved, legs.turns
    out = sign * (legs.position - legs.neutral)
    leg = slice(first, turn + 1) if out[turn] > 0 else slice(turn, other + 1)
    near = (out[leg] > legs.near) & (out[leg] <= NEAR * (legs.grid[-1] - legs.grid[0])) & static.moving[leg]
    return out[leg][near], sign * static.force_n[leg][near]


def _built_up(record: Record, static: StaticForce, legs: Legs, sign: float) -> Figure:
    """The force that has built up on the way out to a side."""
    return breakout(*_near(static, legs, sign), record.force_uncertainty_n)


def _breakaway(record: Record, static: StaticForce, legs: Legs, known: Sequence[Figure]) -> Figure:
    """Static friction at rest beyond the built-up force, which falls as the control breaks away."""
    assert record.force_n is not None  # a sweep has a force
    above = bool(legs.position[legs.turns[0]] > legs.neutral)
    sign, built_up = _SIDES[above], known[above]
    last, first = (sign * float(record.force_n[legs.moved - back]) for back in (1, 0))
    _, force = _near(static, legs, sign)
    falls = len(force) and last > float(np.median(force[:_AFTER])) + _SURE * record.force_uncertainty_n
    if not (falls and last > built_up.value):
        return Figure(0.0, 0.0, "N")
    return Figure(last - built_up.value, combined(record.force_uncertainty_n, (first - last) / math.sqrt(12)), "N")


def _median(values: _Array, each: float) -> Figure:
    if not len(values):
        return Figure(math.nan, math.nan, "N")
    scatter = 1.4826 * float(np.median(np.abs(values - np.median(values))))
    return Figure(
        float(np.median(values)), combined(1.2533 * scatter / math.sqrt(len(values)), each / math.sqrt(2)), "N"
    )


def _side(legs: Legs, spring: _Array, known_n: float, sign: float, built_up_n: float, unit: PositionUnit) -> Figure:
    """Slope of the spring force on one side of neutral, beyond breakout and deadband."""
    x, travel = legs.grid, legs.grid[-1] - legs.grid[0]
    off = sign * (x - legs.neutral)
    begin, _ = _begin(legs, spring, known_n, sign, max(built_up_n, 0.0))
    nearest = max(_SIDE[0] * travel, begin + _ONWARD * travel) if math.isfinite(begin) else _SIDE[0] * travel
    near = (off >= nearest) & (off <= nearest + (_SIDE[1] - _SIDE[0]) * travel) & np.isfinite(spring)
    _, slope, _, known = _line(x[near], spring[near])
    return Figure(slope, known, f"N/{unit}")


def _begin(legs: Legs, spring: _Array, known_n: float, sign: float, built_up_n: float = 0.0) -> tuple[float, float]:
    """Distance from neutral at which a side's spring force begins, and its standard deviation."""
    known = np.isfinite(spring)
    most = float(np.max(np.abs(spring[known]), initial=0.0))
    size, off = sign * spring - built_up_n, sign * (legs.grid - legs.neutral)
    onset = max(_ONSET[0] * most, _SURE * known_n)
    beyond = known & (off > 0) & (size > onset)
    begins_at = float(np.min(size[beyond], initial=np.inf))
    rising = beyond & (size <= begins_at + (_ONSET[1] - _ONSET[0]) * most)
    # Position over force, extrapolated to zero force. The spring begins no farther than where its force is seen: the steep rise
    # of a breakout, which no line fits, leaves no more in doubt than an even distribution up to there.
    begin, _, deviation, _ = _line(size[rising], off[rising])
    return begin, min(deviation, float(np.min(off[beyond], initial=np.inf)) / math.sqrt(12))


def _freeplay(legs: Legs, spring: _Array, known_n: float, unit: PositionUnit) -> Figure:
    """Distance between the onsets of both sides; zero where they overlap, as with a preloaded spring."""
    begins, deviations = zip(*(_begin(legs, spring, known_n, sign) for sign in _SIDES), strict=True)
    bin_known = (legs.grid[1] - legs.grid[0]) / math.sqrt(12)
    width = sum(begins)
    return Figure(max(width, 0.0) if math.isfinite(width) else math.nan, combined(bin_known, *deviations), unit)


def _centring(record: Record, force: _Array, legs: Legs) -> Figure:
    """Position of zero force on the ways back, the farther one from neutral."""
    turn, other = legs.turns
    position = combined(record.position_noise, record.position_resolution / math.sqrt(12))
    rests: list[Figure] = []
    for leg in (slice(turn, other + 1), slice(other, len(force))):
        x, size = record.position[leg] - legs.neutral, force[leg]
        passes = np.flatnonzero(np.sign(size[:-1]) != np.sign(size[1:]))
        if not len(passes):
            continue
        k = int(passes[np.argmin(np.abs(x[passes]))])
        share = size[k] / (size[k] - size[k + 1])
        at, near = float(x[k] + share * (x[k + 1] - x[k])), np.abs(size) <= _SURE * record.force_uncertainty_n
        if near.sum() > 2:
            at = float(np.mean(x[near]))
        # A jump of the force bounds the position only by two samples.
        known = combined(float(np.std(x[near])) if near.any() else 0.0, abs(float(x[k + 1] - x[k])) / 2, position)
        rests.append(Figure(at, known, record.position_unit))
    if not rests:
        return Figure(math.nan, math.nan, record.position_unit)
    farther = max(rests, key=lambda rest: abs(rest.value))
    return replace(farther, value=abs(farther.value))


def _line(x: _Array, y: _Array) -> tuple[float, float, float, float]:
    """Value at zero and slope of the line through points by least squares, and their standard deviations."""
    if len(x) < 3 or np.ptp(x) == 0:
        return math.nan, math.nan, math.nan, math.nan
    center = float(np.mean(x))
    squares = float(np.sum((x - center) ** 2))
    slope = float(np.sum((x - center) * (y - np.mean(y)))) / squares
    level = float(np.mean(y))
    variance = float(np.sum((y - level - slope * (x - center)) ** 2)) / (len(x) - 2)
    at_zero = math.sqrt(variance * (1 / len(x) + center**2 / squares))
    return level - slope * center, slope, at_zero, math.sqrt(variance / squares)
