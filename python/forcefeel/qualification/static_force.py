"""The force of a sweep without what its motion takes: what it would take to go ever so slowly.

``F`` force · ``x`` position, ``v`` and ``a`` its speed and acceleration · ``S(x)`` spring · ``F_c`` friction · ``B`` damping ·
``I`` inertia, both as the grip feels them

``F = S(x) + F_c sgn v + B v + I a``. At a position that is passed both ways the spring is the same, and half the width of the loop
is ``(F_up - F_down) / 2 = F_c + B (v_up - v_down) / 2 + I (a_up - a_down) / 2``. Friction is the same over the middle of the
travel, and the motion is not: a sweep slows down at its stops and passes neutral twice, each time at another speed. So B and I
follow from the width by least squares, in which places where the loop is not that count less: knees, and where the control sticks.

A sweep of one speed throughout does not tell damping from friction: its friction is that at its speed.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from forcefeel.qualification.records import Record
from forcefeel.qualification.sweep_curves import Legs

MIDDLE = 0.8
"""Share of the travel, around its middle, over which friction is read."""
_SPEED_KNOWN = 0.02
"""Of the mean speed: what noise may leave of a speed."""
_LONGEST = 0.02
"""Share of a record over which a speed is read at most."""
_MOVES = 1e-3
"""Share of the mean speed below which a control sticks."""
_TOLD_APART = 0.05
"""Share by which the speed differs over the travel, from which on it is told from friction."""
_SURE = 4.0
"""Standard errors of B and I from which on there are any."""
_ROUNDS = 50
"""Of least squares with new weights: half of them towards the least sum of magnitudes."""
_FAR = 3.0
"""Usual deviations from which on a place counts little."""
_ROUNDING = 1e-12
"""Of the largest force."""

_Array = NDArray[np.float64]
_Mask = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class StaticForce:
    """The force of a sweep without what its motion takes.

    Attributes:
        force_n: Of each sample (samples,).
        moving: Samples at which the control goes where it has not been on its leg (samples,): where it sticks, friction is any, and
            where it comes back, a hysteresis is.
        uncertainty_n: Standard uncertainty of what was taken off at the usual speed.
    """

    force_n: _Array
    moving: _Mask
    uncertainty_n: float


def static_force(record: Record, force: _Array, legs: Legs) -> StaticForce:
    """Takes damping and inertia off the force of a sweep.

    Args:
        record: The sweep.
        force: Its force, N (samples,).
        legs: Its ways.
    """
    mean_speed = 2 * float(np.ptp(record.position)) / record.duration_s
    speed, acceleration, reach = _motion(record, mean_speed)
    direction = legs.directions[0].astype(float) - legs.directions[1]
    sticks = speed * direction <= _MOVES * mean_speed
    # What was read across a sample at which it sticks is the motion of neither.
    moving = ~np.convolve(sticks, np.ones(2 * reach + 3), "same").astype(bool) & _new_ground(legs)
    grid = legs.grid
    middle = np.abs(grid - (grid[0] + grid[-1]) / 2) <= MIDDLE / 2 * (grid[-1] - grid[0])
    halves = [np.subtract(*legs.curves(values, moving)) / 2 for values in (force, speed, acceleration)]
    known = middle & np.all(np.isfinite(halves), axis=0)
    width, v, a = (half[known] for half in halves)
    taken, uncertainty = np.zeros(2), 0.0
    if len(v) > 4 and np.std(v) > _TOLD_APART * np.sqrt(np.mean(v**2)):
        for terms in (np.column_stack([v, a]), v[:, np.newaxis]):
            coefficients, errors = _robust(np.column_stack([np.ones_like(v), terms]), width)
            if coefficients[1] > 0 and coefficients[-1] > _SURE * errors[-1]:
                taken[: terms.shape[1]] = coefficients[1:]
                uncertainty = float(errors[1] * np.median(v))
                break
    return StaticForce(force - taken[0] * speed - taken[1] * acceleration, moving, uncertainty)


def _new_ground(legs: Legs) -> _Mask:
    """Samples at which a leg has come farther than before."""
    x, new_ground = legs.position, np.empty(len(legs.position), dtype=bool)
    first, other = legs.turns
    for leg in (slice(None, first + 1), slice(first + 1, other + 1), slice(other + 1, None)):
        direction = np.sign(x[leg][-1] - x[leg][0])
        new_ground[leg] = direction * x[leg] >= np.maximum.accumulate(direction * x[leg]) - legs.near
    return new_ground


def _motion(record: Record, mean_speed: float) -> tuple[_Array, _Array, int]:
    """Speed and acceleration of the samples, by a parabola through as many neighbours as noise asks for; how many to a side."""
    from scipy.signal import savgol_filter  # noqa: PLC0415  only here

    h, x = record.step_s, record.position
    noise = math.hypot(record.position_noise, record.position_resolution / math.sqrt(12))
    # The slope of a parabola through n samples has the variance 12 sigma^2 / (h^2 n^3).
    needed = (12 * (noise / (h * _SPEED_KNOWN * mean_speed)) ** 2) ** (1 / 3)
    reach = max(int(min(needed, _LONGEST * len(x)) / 2), 1)
    even = np.arange(record.time_s[0], record.time_s[-1] + h / 2, h)
    smooth = np.interp(even, record.time_s, x)
    speed, acceleration = (
        np.interp(record.time_s, even, savgol_filter(smooth, 2 * reach + 1, 2, deriv=order, delta=h))
        for order in (1, 2)
    )
    return speed, acceleration, reach


def _robust(terms: _Array, width: _Array) -> tuple[_Array, _Array]:
    """Coefficients of the terms by least squares in which what is far off counts little, and their standard errors.

    Neighbouring places miss alike where it is no noise that they miss; they count as so many fewer.
    """
    scale = np.max(np.abs(terms), axis=0)
    terms, weights = terms / scale, np.ones(len(width))
    nothing = _ROUNDING * float(np.max(np.abs(width))) + math.sqrt(np.finfo(float).tiny)
    for k in range(_ROUNDS):
        root = np.sqrt(weights)
        coefficients, *_ = np.linalg.lstsq(terms * root[:, np.newaxis], width * root)
        left = width - terms @ coefficients
        usual = 1.4826 * float(np.median(np.abs(left))) + nothing
        far = np.abs(left) / (_FAR * usual)
        count: _Array = 1 / np.maximum(far, _ROUNDING) if 2 * k < _ROUNDS else 1 / (1 + far**2) ** 2
        weights = count / np.max(count)
    missed = left * np.sqrt(weights)
    squares = float(missed @ missed)
    alike = float(np.clip(float(missed[1:] @ missed[:-1]) / max(squares, nothing**2), 0.0, 1 - 1 / len(width)))
    degrees = max(float(np.sum(weights)) - terms.shape[1], 1.0)
    variance = squares / degrees * (1 + alike) / (1 - alike)
    covariance = np.linalg.pinv(terms.T @ (terms * weights[:, np.newaxis])) * variance
    return coefficients / scale, np.sqrt(np.diag(covariance)) / scale
