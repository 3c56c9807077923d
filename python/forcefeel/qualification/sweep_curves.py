"""The legs of a sweep, and its signals over position on each leg."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from forcefeel.errors import InputError
from forcefeel.qualification.records import Record

_SEEN = 5.0
"""Standard deviations of noise beyond which a control has moved."""
_COVERED = 0.8
"""Least share of the travel that each direction covers."""
_STILL = 1e-9
"""Share of the travel within which noise-free positions are equal."""

_Array = NDArray[np.float64]
_Mask = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Legs:
    """The legs of a sweep: out to one stop, across to the other, back to neutral.

    Attributes:
        grid: Positions of the curves (points,).
        position: Position of the samples (samples,).
        neutral: Position at the start.
        moved: First sample away from neutral.
        turns: Samples at which the control turns back.
        directions: Samples of rising and of falling position (samples,), without the stops.
        left: Samples since the control left the grid point of neutral (samples,). The force of a control at rest in its
            friction is any up to its limit, and its linkage gives a little under it: no curve has that force.
        near: Distance within which positions are equal.
    """

    grid: _Array
    position: _Array
    neutral: float
    moved: int
    turns: tuple[int, int]
    directions: tuple[_Mask, _Mask]
    left: _Mask
    near: float

    @classmethod
    def of(cls, record: Record, points: int) -> "Legs":
        """The legs of a record.

        Raises:
            InputError: If it does not go to both sides of its start, or one direction is missing.
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
        leg_number = np.searchsorted(np.array(turns), np.arange(len(x)), side="right")
        first_up = bool(x[turns[0]] > neutral)
        rising = (leg_number != 1) == first_up
        last = len(x) - int(np.argmax(np.abs(x[::-1] - x[-1]) > near))
        usable = ~at_stop & (np.arange(len(x)) >= moved) & (np.arange(len(x)) < last)
        grid = np.linspace(low, high, points)
        left = np.maximum.accumulate(np.abs(x - neutral) > (grid[1] - grid[0]) / 2)
        legs = cls(grid, x, neutral, moved, turns, (usable & rising, usable & ~rising), left, near)
        for curve, direction in zip(legs.curves(x), ("rises", "falls"), strict=True):
            if np.mean(np.isfinite(curve)) < _COVERED:
                raise InputError(
                    f"{record.name}: covers {100 * np.mean(np.isfinite(curve)):.3g} % of the travel while the position "
                    f"{direction}, up to its end at {record.time_s[-1]:.6g} s; expected neutral, stop, opposite stop, neutral"
                )
        return legs

    def curves(self, values: _Array, among: _Mask | None = None) -> tuple[_Array, _Array]:
        """Values over the grid while the position rises and while it falls; NaN where a direction has no samples.

        Args:
            values: Values of the samples (samples,).
            among: Mask of the used samples (samples,). Default: all.
        """
        used = self.left if among is None else self.left & among
        up, down = (direction & used for direction in self.directions)
        return self._binned(values, up), self._binned(values, down)

    @property
    def samples_a_point(self) -> float:
        """Median number of samples per point of a curve, at least one."""
        cells = [self._cells(direction) for direction in self.directions]
        return max(float(np.median([np.mean(np.unique(cell, return_counts=True)[1]) for cell in cells])), 1.0)

    def _cells(self, direction: _Mask) -> NDArray[np.intp]:
        """Index of the nearest grid point for each sample of a direction."""
        cell: NDArray[np.intp] = np.round(
            (self.position[direction] - self.grid[0]) / (self.grid[1] - self.grid[0])
        ).astype(np.intp)
        return cell

    def _binned(self, values: _Array, direction: _Mask) -> _Array:
        """Means of the values around each grid point, linearly interpolated."""
        x, y, grid = self.position[direction], values[direction], self.grid
        if len(x) < 2:
            return np.full_like(grid, np.nan)
        step, cell = grid[1] - grid[0], self._cells(direction)
        count = np.bincount(cell, minlength=len(grid))
        filled = count > 0
        with np.errstate(invalid="ignore", divide="ignore"):
            at, mean = (np.bincount(cell, signal, minlength=len(grid)) / count for signal in (x, y))
        curve = np.interp(grid, at[filled], mean[filled])
        # Beyond the samples, and across wide gaps, the curve is unknown.
        curve[(grid < x.min() - step - self.near) | (grid > x.max() + step + self.near)] = np.nan
        after = np.clip(np.searchsorted(at[filled], grid), 1, max(int(filled.sum()) - 1, 1))
        neighbors = at[filled][np.minimum([after - 1, after], int(filled.sum()) - 1)]
        distance = np.min(np.abs(grid - neighbors), axis=0)
        curve[distance > max(5 * step, 2 * self.near)] = np.nan
        return curve


def _turns(x: _Array, high: float, low: float) -> tuple[int, int]:
    """Last sample at the first stop before the other one, and last sample at the other stop."""
    at_high, at_low = np.flatnonzero(x >= high), np.flatnonzero(x <= low)
    first, other = (at_high, at_low) if at_high[0] < at_low[0] else (at_low, at_high)
    return int(first[first < other[0]][-1]), int(other[-1])
