"""The static force of a sweep: its force minus damping and inertia.

``F`` force · ``x`` position, ``v`` and ``a`` its speed and acceleration · ``S(x)`` spring · ``F_c`` friction · ``B`` damping and
``I`` inertia at the grip

``F = S(x) + F_c sgn v + B v + I a``. The spring is the same in both directions, so half the width of the loop is
``(F_up - F_down) / 2 = F_c + B (v_up - v_down) / 2 + I (a_up - a_down) / 2``. Over the middle of the travel friction is constant
and speed is not: a sweep slows down at its stops and passes neutral at two speeds. B and I follow from the width by robust least
squares, which gives less weight to knees and to positions where the control sticks.

At constant speed, damping and friction are inseparable: the estimated friction is that at this speed.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from forcefeel.qualification.records import Record
from forcefeel.qualification.sweep_curves import Legs

MIDDLE = 0.8
"""Share of the travel, around its middle, over which friction is estimated."""
_SPEED_KNOWN = 0.02
"""Allowed noise of a speed, as a share of the mean speed."""
_LONGEST = 0.02
"""Longest window of a speed, as a share of the record."""
_MOVES = 1e-3
"""Share of the mean speed below which a control sticks."""
_SEPARABLE = 0.05
"""Relative variation of the speed over the travel above which damping and friction are separable."""
_SURE = 4.0
"""Least B and I in standard errors; smaller estimates are set to zero."""
_ROUNDS = 50
"""Iterations of reweighted least squares; the first half minimizes the sum of magnitudes."""
_FAR = 3.0
"""Robust scale, in standard deviations, above which a residual has little weight."""
_ROUNDING = 1e-12
"""Rounding, as a share of the largest force."""

_Array = NDArray[np.float64]
_Mask = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class StaticForce:
    """The static force of a sweep.

    Attributes:
        force_n: Static force of each sample (samples,).
        moving: Samples at which the control advances on its leg (samples,); friction is undefined where it sticks, and
            hysteresis where it moves back.
        uncertainty_n: Standard uncertainty of the subtracted force at the median speed.
    """

    force_n: _Array
    moving: _Mask
    uncertainty_n: float


def static_force(record: Record, force: _Array, legs: Legs) -> StaticForce:
    """Subtracts damping and inertia from the force of a sweep, N (samples,), by its legs."""
    mean_speed = 2 * float(np.ptp(record.position)) / record.duration_s
    speed, acceleration, reach = _motion(record, mean_speed)
    direction = legs.directions[0].astype(float) - legs.directions[1]
    sticks = speed * direction <= _MOVES * mean_speed
    # A speed whose window includes a sticking sample is invalid.
    moving = ~np.convolve(sticks, np.ones(2 * reach + 3), "same").astype(bool) & _new_ground(legs)
    grid = legs.grid
    middle = np.abs(grid - (grid[0] + grid[-1]) / 2) <= MIDDLE / 2 * (grid[-1] - grid[0])
    halves = [np.subtract(*legs.curves(values, moving)) / 2 for values in (force, speed, acceleration)]
    known = middle & np.all(np.isfinite(halves), axis=0)
    width, v, a = (half[known] for half in halves)
    taken, uncertainty = np.zeros(2), 0.0
    if len(v) > 4 and np.std(v) > _SEPARABLE * np.sqrt(np.mean(v**2)):
        for terms in (np.column_stack([v, a]), v[:, np.newaxis]):
            coefficients, errors = _robust(np.column_stack([np.ones_like(v), terms]), width)
            if coefficients[1] > 0 and coefficients[-1] > _SURE * errors[-1]:
                taken[: terms.shape[1]] = coefficients[1:]
                uncertainty = float(errors[1] * np.median(v))
                break
    return StaticForce(force - taken[0] * speed - taken[1] * acceleration, moving, uncertainty)


def _new_ground(legs: Legs) -> _Mask:
    """Samples at which a leg advances beyond its earlier positions."""
    x, new_ground = legs.position, np.empty(len(legs.position), dtype=bool)
    first, other = legs.turns
    for leg in (slice(None, first + 1), slice(first + 1, other + 1), slice(other + 1, None)):
        direction = np.sign(x[leg][-1] - x[leg][0])
        new_ground[leg] = direction * x[leg] >= np.maximum.accumulate(direction * x[leg]) - legs.near
    return new_ground


def _motion(record: Record, mean_speed: float) -> tuple[_Array, _Array, int]:
    """Speed and acceleration by a moving parabola whose window depends on noise, and its half width in samples."""
    h, x = record.step_s, record.position
    noise = math.hypot(record.position_noise, record.position_resolution / math.sqrt(12))
    # The slope of a parabola through n samples has the variance 12 sigma^2 / (h^2 n^3).
    needed = (12 * (noise / (h * _SPEED_KNOWN * mean_speed)) ** 2) ** (1 / 3)
    reach = max(int(min(needed, _LONGEST * len(x)) / 2), 1)
    even = np.arange(record.time_s[0], record.time_s[-1] + h / 2, h)
    smooth = np.interp(even, record.time_s, x)
    speed, acceleration = (np.interp(record.time_s, even, slope / h**order) for order, slope in _slopes(smooth, reach))
    return speed, acceleration, reach


def _slopes(values: _Array, reach: int) -> Iterator[tuple[int, _Array]]:
    """Order, and first and second derivative per sample, of the parabola through each sample's ``2 reach + 1`` neighbors.

    The filter of Savitzky and Golay (Analytical Chemistry 36, 1964): the first and last parabola serve up to the ends. SciPy's
    brings its statistics with it, which take longer to import than a qualification to compute.
    """
    at = np.arange(-reach, reach + 1.0)
    _, linear, square = np.linalg.pinv(np.vander(at, 3, increasing=True))
    bend = np.convolve(values, 2 * square[::-1], mode="valid")
    slope = np.convolve(values, linear[::-1], mode="valid")
    yield 1, np.concatenate([slope[0] + bend[0] * at[:reach], slope, slope[-1] + bend[-1] * at[reach + 1 :]])
    yield 2, np.pad(bend, reach, mode="edge")


def _robust(terms: _Array, width: _Array) -> tuple[_Array, _Array]:
    """Coefficients of the terms by robust least squares, and their standard errors.

    Systematic residuals are correlated between neighbors; the correlation enlarges the standard errors.
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
