"""Force and surface over position, both ways, from the samples of a sweep."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from forcefeel.errors import InputError
from forcefeel.qualification.records import Record

_SEEN = 5.0
"""Standard deviations of the noise by which a control that has moved is off its place."""
_COVERED = 0.8
"""Share of the travel that each direction covers at least."""
_STILL = 1e-6
"""Share of the travel within which a position without noise is the same."""

_Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Curves:
    """Curves over a grid of positions; not a number where a direction does not go.

    Attributes:
        position: The grid (points,).
        force_up_n, force_down_n: Force while the position rises and falls.
        surface_up_rad, surface_down_rad: The same of the surface; ``None`` if it was not recorded.
        neutral: Position at the beginning.
        moved: First sample that is off it.
        turns: Samples at which the control turns back.
        force_uncertainty_n: Standard uncertainty of a point.
    """

    position: _Array
    force_up_n: _Array
    force_down_n: _Array
    surface_up_rad: _Array | None
    surface_down_rad: _Array | None
    neutral: float
    moved: int
    turns: tuple[int, int]
    force_uncertainty_n: float


def curves_of(record: Record, force: _Array, points: int) -> Curves:
    """The curves of a sweep.

    Raises:
        InputError: If it does not go to both sides of where it began, or one direction is missing.
    """
    x = record.position
    low, high = float(x.min()), float(x.max())
    travel = high - low
    near = max(_SEEN * record.position_noise, 1.5 * record.position_resolution, _STILL * travel)
    off = np.abs(x - x[0]) > near
    if travel <= 4 * near or not off.any():
        raise InputError(f"{record.name}: has no sweep: the position stays at {record.shown(float(x[0]))}")
    moved = max(int(np.argmax(off)), 1)
    neutral = float(np.mean(x[:moved]))
    if not (low + 0.1 * travel < neutral < high - 0.1 * travel):
        raise InputError(
            f"{record.name}: begins at {record.shown(float(neutral))}, at {record.time_s[0]:.6g} s, and goes from "
            f"{record.shown(low)} to {record.shown(high)}; expected a sweep from neutral to both sides"
        )
    at_stop = (x >= high - near) | (x <= low + near)
    turns = _turns(x, high - near, low + near)
    legs = np.searchsorted(np.array(turns), np.arange(len(x)), side="right")
    first_up = bool(x[turns[0]] > neutral)
    rising = (legs != 1) == first_up
    last = len(x) - int(np.argmax(np.abs(x[::-1] - x[-1]) > near))
    usable = ~at_stop & (np.arange(len(x)) >= moved) & (np.arange(len(x)) < last)
    grid = np.linspace(low, high, points)
    each = [_binned(grid, x[usable & way], force[usable & way], near) for way in (rising, ~rising)]
    for (curve, _), way in zip(each, ("rises", "falls"), strict=True):
        if np.mean(np.isfinite(curve)) < _COVERED:
            raise InputError(
                f"{record.name}: covers {100 * np.mean(np.isfinite(curve)):.3g} % of the travel while the position {way}, "
                f"up to its end at {record.time_s[-1]:.6g} s; expected neutral, stop, opposite stop, neutral"
            )
    surface = record.surface_rad
    ways = (rising, ~rising)
    surfaces = (
        [_binned(grid, x[usable & way], surface[usable & way], near)[0] for way in ways]
        if surface is not None
        else (None, None)
    )
    in_bin = max(float(np.median([count for _, count in each])), 1.0)
    known = record.force_uncertainty_n / math.sqrt(in_bin)
    return Curves(grid, each[0][0], each[1][0], surfaces[0], surfaces[1], neutral, moved, turns, known)


def _turns(x: _Array, high: float, low: float) -> tuple[int, int]:
    """Last sample at the first stop before the other one, and last sample at the other stop."""
    at_high, at_low = np.flatnonzero(x >= high), np.flatnonzero(x <= low)
    one, other = (at_high, at_low) if at_high[0] < at_low[0] else (at_low, at_high)
    return int(one[one < other[0]][-1]), int(other[-1])


def _binned(grid: _Array, x: _Array, y: _Array, near: float) -> tuple[_Array, float]:
    """Means of ``y`` around each position of the grid, straight between them, and how many samples a mean is of."""
    if len(x) < 2:
        return np.full_like(grid, np.nan), 0.0
    step = grid[1] - grid[0]
    cell = np.round((x - grid[0]) / step).astype(np.intp)
    count = np.bincount(cell, minlength=len(grid))
    filled = count > 0
    with np.errstate(invalid="ignore", divide="ignore"):
        at, mean = (np.bincount(cell, values, minlength=len(grid)) / count for values in (x, y))
    curve = np.interp(grid, at[filled], mean[filled])
    # Beyond the samples, and where too many cells in a row are empty, nothing is known.
    curve[(grid < x.min() - step - near) | (grid > x.max() + step + near)] = np.nan
    after = np.clip(np.searchsorted(at[filled], grid), 1, max(int(filled.sum()) - 1, 1))
    neighbours = at[filled][np.minimum([after - 1, after], int(filled.sum()) - 1)]
    distance = np.min(np.abs(grid - neighbours), axis=0)
    curve[distance > max(5 * step, 2 * near)] = np.nan
    return curve, float(np.mean(count[filled]))
