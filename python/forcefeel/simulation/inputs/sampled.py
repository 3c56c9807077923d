"""A sampled input: linear within each step, with jumps between steps.

Piecewise linear inputs are sampled from points in order of time; a jump is two points at one time.
"""

import math
from dataclasses import dataclass
from numbers import Real
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from forcefeel.errors import InputError
from forcefeel.units import show

# Of a step. Times in decimals are off by k * 3e-16 steps at step k: a third of this at the most steps there may be.
ROUNDING = 1e-6
_MOST_STEPS = 10**9

Bound = Literal["finite number", "number above 0", "number of 0 or more"]


class Sampled(NamedTuple):
    """An input over the steps ``t_k = k h`` to ``t_{k+1}``, k from 0 to n - 1; straight within each.

    Attributes:
        start: The n values just after ``t_k``, in the unit of what was sampled.
        end: The n values just before ``t_{k+1}``; differs from the next ``start`` only where the input jumps.
    """

    start: NDArray[np.float64]
    end: NDArray[np.float64]

    @property
    def pairs(self) -> NDArray[np.float64]:
        """Both, (n, 2), as the engine takes an input."""
        return np.column_stack(self)


@dataclass(frozen=True)
class Grid:
    """The times ``t_k = k h`` of a run.

    Attributes:
        step_s: The step h.
        steps: How many steps, n.
    """

    step_s: float
    steps: int

    @classmethod
    def of(cls, time_s: float, step_s: float) -> "Grid":
        """The grid of a run of ``time_s``.

        Raises:
            InputError: If a time is not finite and above zero, or the run is not a whole number of steps to rounding (a
                millionth of a step), or more than a thousand million of them.
        """
        check_number("run", "time_s", time_s, "number above 0")
        check_number("run", "step_s", step_s, "number above 0")
        if time_s / step_s > _MOST_STEPS:
            raise InputError(
                f"run: expected at most {_MOST_STEPS} steps, got {time_s:.15g} s in steps of {step_s:.15g} s"
            )
        steps = round(time_s / step_s)
        if steps < 1 or abs(time_s / step_s - steps) > ROUNDING:
            raise InputError(f"run: ends at {_between(time_s, step_s)}")
        return cls(float(step_s), steps)

    @property
    def times_s(self) -> NDArray[np.float64]:
        """All n + 1 times."""
        return np.arange(self.steps + 1, dtype=np.float64) * self.step_s

    @property
    def end_s(self) -> float:
        """The last time."""
        return self.steps * self.step_s

    def index(self, owner: str, jump_s: float) -> int:
        """Which k has ``t_k = jump_s``.

        Raises:
            InputError: If none has; the message names the two nearest times.
        """
        k = round(jump_s / self.step_s)
        if abs(jump_s / self.step_s - k) > ROUNDING:
            raise InputError(f"{owner}: jumps at {_between(jump_s, self.step_s)}")
        return k


def _between(time_s: float, step_s: float) -> str:
    below = math.floor(time_s / step_s)
    return (
        f"{time_s:.15g} s, between the steps' times {below * step_s:.15g} s and {(below + 1) * step_s:.15g} s; "
        f"expected a multiple of the step of {step_s:.15g} s, so take one of the two or another step"
    )


def through_points(owner: str, grid: Grid, times_s: ArrayLike, values: ArrayLike) -> Sampled:
    """Straight lines through points, sampled; beyond the first and last point their values hold.

    Args:
        owner: Name for messages.
        grid: The times of the run.
        times_s: Times of the points, non-decreasing; a time that stands twice is a jump.
        values: Values of the points.

    Raises:
        InputError: If a jump within the run is not at a time of the grid, or three points coincide with one such time to
            rounding, so that a pulse would be lost.
    """
    times, heights = np.asarray(times_s, dtype=np.float64), np.asarray(values, dtype=np.float64)
    jumps = times[1:][times[1:] == times[:-1]]
    for jump in jumps[(jumps > 0) & (jumps < grid.end_s)]:
        grid.index(owner, float(jump))
    with np.errstate(over="ignore", invalid="ignore"):  # times far beyond the run are on no grid
        nearest = np.rint(times / grid.step_s)
        on_grid = np.abs(times / grid.step_s - nearest) <= ROUNDING
        times = np.where(on_grid, nearest * grid.step_s, times)
    lost = times[2:][times[2:] == times[:-2]]
    if (lost := lost[(lost >= 0) & (lost < grid.end_s)]).size:
        raise InputError(
            f"{owner}: comes and goes within {ROUNDING:g} of a step at {lost[0]:.15g} s; expected {grid.step_s:.15g} s at "
            "least; let it last longer or take a smaller step"
        )
    t = grid.times_s
    return frozen(
        _on_line(times, heights, np.searchsorted(times, t[:-1], side="right") - 1, t[:-1]),
        _on_line(times, heights, np.searchsorted(times, t[1:], side="left") - 1, t[1:]),
    )


def _on_line(
    times: NDArray[np.float64], values: NDArray[np.float64], i: NDArray[np.intp], t: NDArray[np.float64]
) -> NDArray[np.float64]:
    """At ``t`` on the line from point i to i + 1; exact at both points and on level lines."""
    left, right = np.maximum(i, 0), np.minimum(i + 1, len(times) - 1)
    inside = left < right  # neither before the first point nor after the last
    width = np.where(inside, times[right] - times[left], 1.0)
    u = np.where(inside, (t - times[left]) / width, 0.0)
    rise = values[right] - values[left]
    line = np.where(u <= 0.5, values[left] + rise * u, values[right] - rise * (1.0 - u))
    return np.where(inside, line, values[left])


def through_values(values: NDArray[np.float64]) -> Sampled:
    """A smooth input from its values at the n + 1 times."""
    return frozen(values[:-1], values[1:])


def frozen(start: NDArray[np.float64], end: NDArray[np.float64]) -> Sampled:
    """``Sampled`` with read-only arrays."""
    start.setflags(write=False)
    end.setflags(write=False)
    return Sampled(start, end)


def check_number(owner: str, name: str, value: object, bound: Bound) -> None:
    """Refuses a value that is not a number within ``bound``.

    Raises:
        InputError: With the owner, the argument, the expected and the actual value.
    """
    try:
        number = float(value) if isinstance(value, Real) and not isinstance(value, bool) else math.nan
    except OverflowError:
        number = math.inf
    good = {"finite number": True, "number above 0": number > 0, "number of 0 or more": number >= 0}
    if not (math.isfinite(number) and good[bound]):
        raise InputError(f"{owner}: expected {name} to be a {bound}, got {show(value)}")


def check_frequencies(owner: str, highest_hz: float, grid: Grid) -> None:
    """Refuses a frequency above half the sampling rate of ``grid``.

    Raises:
        InputError: If ``highest_hz`` is half the sampling rate or more; the remedy is a smaller step.
    """
    half_rate = 0.5 / grid.step_s
    if not highest_hz < half_rate:
        raise InputError(
            f"{owner}: has {highest_hz:.15g} Hz; a step of {grid.step_s:.15g} s shows only what is below "
            f"{half_rate:.15g} Hz; take a smaller step"
        )


def check_lasts(owner: str, duration_s: float, steps: int, grid: Grid) -> None:
    """Refuses an input that is shorter than ``steps`` steps of ``grid``.

    Raises:
        InputError: If ``duration_s`` is less than ``steps`` steps.
    """
    if duration_s < (steps - ROUNDING) * grid.step_s:
        raise InputError(
            f"{owner}: expected duration_s to be {steps} steps of {grid.step_s:.15g} s at least, got {duration_s:.15g} s; "
            "let it last longer or take a smaller step"
        )


@dataclass(frozen=True)
class Schedule:
    """Any other input over time, such as a trim command (rad), a dynamic pressure (Pa) or a shaker on (1) and off (0).

    Straight lines through the points; a jump is two points at one time; before the first and after the last point
    their values hold, so one point is a constant.

    Attributes:
        times_s: Times of the points, finite, non-decreasing, none more than twice.
        values: Values of the points, finite, as many.
        name: Name for messages.

    Raises:
        InputError: When built, if times or values are invalid.

    Example:
        >>> trim = ff.simulation.Schedule((0.0, 0.5), (0.0, 0.05))
        >>> ff.Scenario(trim_rad=trim).trim_rad.values
        (0.0, 0.05)
    """

    times_s: tuple[float, ...]
    values: tuple[float, ...]
    name: str = "Schedule"

    def __post_init__(self) -> None:
        for field in ("times_s", "values"):
            raw = getattr(self, field)
            try:
                object.__setattr__(self, field, tuple(raw))
            except TypeError as error:
                raise InputError(f"{self.name}: expected {field} to be a row of numbers, got {show(raw)}") from error
            row = getattr(self, field)
            if set(map(type, row)) <= {float} and np.isfinite(row).all():
                continue  # all at once: a record has a hundred thousand
            for i, number in enumerate(row):
                check_number(self.name, f"{field}[{i}]", number, "finite number")
        times = self.times_s
        if not times or len(times) != len(self.values):
            came = f"{len(times)} times and {len(self.values)} values"
            raise InputError(f"{self.name}: expected as many values as times, one at least, got {came}")
        wide = np.array(times, dtype=np.float64)
        back, thrice = np.diff(wide) < 0, wide[2:] == wide[:-2]
        for i in sorted({*(np.flatnonzero(back) + 1).tolist(), *(np.flatnonzero(thrice) + 2).tolist()}):
            if times[i] < times[i - 1]:
                raise InputError(
                    f"{self.name}: time goes back from {times[i - 1]:.15g} s to {times[i]:.15g} s; sort it"
                )
            if times[i] == times[i - 2]:
                raise InputError(f"{self.name}: {times[i]:.15g} s stands three times; a jump is two points at one time")

    def sample(self, time_s: float, step_s: float) -> Sampled:
        """The values over a run; a corner within a step is cut off straight.

        Args:
            time_s: Length of the run.
            step_s: Step h.

        Raises:
            InputError: If the run is not a whole number of steps, or a jump within it is not between two steps.
        """
        return through_points(self.name, Grid.of(time_s, step_s), self.times_s, self.values)
