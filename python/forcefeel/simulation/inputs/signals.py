"""Forces at the grip by formula, one frozen class for each.

Forces are in N at the grip, positive as the column's angle; times in s from the start of the run. The force is zero outside the
stated time. Each field also accepts text with a unit: ``Step("100 lb")``. ``sample(time_s, step_s)`` takes the length of the run
and the step.
"""

import math
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from forcefeel.errors import InputError
from forcefeel.simulation.inputs.quantity import Quantity
from forcefeel.simulation.inputs.sampled import (
    Bound,
    Grid,
    Sampled,
    check_frequencies,
    check_lasts,
    check_number,
    frozen,
    through_points,
    through_values,
)
from forcefeel.units import show

Spacing = Literal["linear", "logarithmic"]

Points = tuple[list[float], list[float]]
"""Times in s and forces in N."""


class _Straight:
    """A force that is straight between points; two at one time are a jump."""

    def _points(self) -> Points:
        raise NotImplementedError

    def sample(self, time_s: float, step_s: float) -> Sampled:
        """The force over a run, N.

        Raises:
            InputError: If the run is not a whole number of steps, or a jump is within it and not between two steps.
        """
        return through_points(type(self).__name__, Grid.of(time_s, step_s), *self._points())


@dataclass(frozen=True)
class HandsOff(_Straight):
    """No force at the grip: ``F(t) = 0``.

    Example:
        >>> ff.Scenario().force
        HandsOff()
    """

    def _points(self) -> Points:
        return [0.0], [0.0]


@dataclass(frozen=True)
class Step(_Straight):
    """A step of force: ``F(t) = force_n`` for ``t > start_s``.

    Attributes:
        force_n: The force, N.
        start_s: Start time, s, 0 or later.

    Raises:
        InputError: When built, if a number is not finite or ``start_s`` is below 0.

    Example:
        >>> ff.Scenario(ff.Step(force_n=100.0, start_s=0.1)).force
        Step(force_n=100.0, start_s=0.1)
    """

    force_n: Quantity = Quantity()
    start_s: Quantity = Quantity(0.0, "number of 0 or more")

    def _points(self) -> Points:
        return [self.start_s] * 2, [0.0, self.force_n]


@dataclass(frozen=True)
class Pulse(_Straight):
    """A pulse of force: ``F(t) = force_n`` for ``start_s < t < start_s + width_s``.

    Attributes:
        force_n: The force, N.
        start_s: Start time, s, 0 or later.
        width_s: Duration, s, above 0.

    Raises:
        InputError: When built, if a number is not finite or below its bound.

    Example:
        >>> ff.simulation.Pulse(force_n=50.0, start_s=0.1, width_s=0.2).force_n
        50.0
    """

    force_n: Quantity = Quantity()
    start_s: Quantity = Quantity(bound="number of 0 or more")
    width_s: Quantity = Quantity(bound="number above 0")

    def _points(self) -> Points:
        first, last = self.start_s, self.start_s + self.width_s
        return [first, first, last, last], [0.0, self.force_n, self.force_n, 0.0]


@dataclass(frozen=True)
class Doublet(_Straight):
    """A pulse and its opposite: ``force_n`` for ``width_s`` from ``start_s``, then ``-force_n`` for ``width_s``.

    Attributes:
        force_n: The first force, N.
        start_s: Start time, s, 0 or later.
        width_s: Duration of each half, s, above 0.

    Raises:
        InputError: When built, if a number is not finite or below its bound.

    Example:
        >>> ff.simulation.Doublet(force_n=50.0, start_s=0.1, width_s=0.2).width_s
        0.2
    """

    force_n: Quantity = Quantity()
    start_s: Quantity = Quantity(bound="number of 0 or more")
    width_s: Quantity = Quantity(bound="number above 0")

    def _points(self) -> Points:
        times = [self.start_s + widths * self.width_s for widths in (0, 0, 1, 1, 2, 2)]
        return times, [0.0, self.force_n, self.force_n, -self.force_n, -self.force_n, 0.0]


@dataclass(frozen=True)
class StopToStop:
    """From stop to stop by force: at a constant rate from 0 to ``force_n``, to ``-force_n`` and back to 0.

    ``F = 0, force_n, -force_n, 0`` at ``t = 0, 1/4, 3/4, 1`` of ``duration_s``, straight between.

    Attributes:
        force_n: The greatest force, N; enough to reach both stops.
        duration_s: Duration, s, above 0: a minute for a force-displacement loop, a second for a fast one.

    Raises:
        InputError: When built, if a number is not finite or ``duration_s`` is not above 0.

    Example:
        >>> ff.simulation.StopToStop(force_n=400.0, duration_s=60.0).duration_s
        60.0
    """

    force_n: Quantity = Quantity()
    duration_s: Quantity = Quantity(bound="number above 0")

    def sample(self, time_s: float, step_s: float) -> Sampled:
        """The force over a run, N; a corner within a step is cut off, by ``2 force_n step_s / duration_s`` at most.

        Raises:
            InputError: If the run is not a whole number of steps, or ``duration_s`` less than four.
        """
        grid = Grid.of(time_s, step_s)
        check_lasts("StopToStop", self.duration_s, 4, grid)
        times = [part * self.duration_s for part in (0.0, 0.25, 0.75, 1.0)]
        return through_points("StopToStop", grid, times, [0.0, self.force_n, -self.force_n, 0.0])


@dataclass(frozen=True)
class Chirp:
    """A sine whose frequency runs from one value to another: ``F(t) = force_n sin(2 pi c(t))``.

    The cycles ``c`` are the exact integral of the frequency ``f``, with ``a = from_hz``, ``b = to_hz``, ``D = duration_s``:

    * linear: ``f = a + (b - a) t / D``, ``c = a t + (b - a) t^2 / (2 D)``;
    * logarithmic: ``f = a (b / a)^(t / D)``, ``c = a D ((b / a)^(t / D) - 1) / ln(b / a)``.

    Attributes:
        force_n: Amplitude, N.
        from_hz: First frequency, Hz; above 0 if logarithmic, 0 or more if linear.
        to_hz: Last frequency, Hz, as ``from_hz``; may be the lower one.
        duration_s: Duration, s, above 0; then the force is zero.
        spacing: ``"linear"`` or ``"logarithmic"``, which gives each octave the same time.

    Raises:
        InputError: When built, if a number is not finite or below its bound, or ``spacing`` is another word.

    Example:
        >>> ff.Scenario(ff.simulation.Chirp(50.0, 0.5, 5.0, 2.0, "logarithmic")).force.to_hz
        5.0
    """

    force_n: Quantity = Quantity()
    from_hz: Quantity = Quantity(bound=None)
    to_hz: Quantity = Quantity(bound=None)
    duration_s: Quantity = Quantity(bound="number above 0")
    spacing: Spacing = "linear"

    def __post_init__(self) -> None:
        if self.spacing not in get_args(Spacing):
            raise InputError(f"Chirp: expected spacing to be 'linear' or 'logarithmic', got {show(self.spacing)}")
        bound: Bound = "number of 0 or more" if self.spacing == "linear" else "number above 0"
        for name in ("from_hz", "to_hz"):
            check_number("Chirp", name, getattr(self, name), bound)

    def sample(self, time_s: float, step_s: float) -> Sampled:
        """The force over a run, N: exact at the times of the steps, straight between.

        Raises:
            InputError: If the run is not a whole number of steps; if the chirp ends within a step or is shorter than a
                step; if a frequency is half the sampling rate or more.
        """
        grid = Grid.of(time_s, step_s)
        check_lasts("Chirp", self.duration_s, 1, grid)
        check_frequencies("Chirp", max(self.from_hz, self.to_hz), grid)
        force = self.force_n * np.sin(2 * np.pi * self._cycles(np.minimum(grid.times_s, self.duration_s)))
        if self.duration_s >= grid.end_s:
            return through_values(force)
        k, (start, end) = grid.index("Chirp", self.duration_s), (force[:-1].copy(), force[1:].copy())
        start[k:] = end[k:] = 0.0
        return frozen(start, end)

    def _cycles(self, t: NDArray[np.float64]) -> NDArray[np.float64]:
        if self.spacing == "linear":
            return self.from_hz * t + (self.to_hz - self.from_hz) * t**2 / (2 * self.duration_s)
        x = math.log(self.to_hz / self.from_hz) * t / self.duration_s
        # (e^x - 1) / x, right also where b = a.
        return np.asarray(self.from_hz * t * np.where(x == 0, 1.0, np.expm1(x) / np.where(x == 0, 1.0, x)))


@dataclass(frozen=True)
class Release(_Straight):
    """A release: the grip is held at an angle until ``start_s``; the free response begins there, at rest.

    The sampled force is zero; the caller must hold the grip until ``start_s`` by a constraint.

    Attributes:
        angle_rad: The column's angle until ``start_s``, rad.
        start_s: Time of the release, s, 0 or later.

    Raises:
        InputError: When built, if a number is not finite or ``start_s`` is below 0.

    Example:
        >>> run = ff.simulate(ff.elevator(), ff.Scenario(ff.Release(0.1), duration_s=1.0))
        >>> float(run.history.column_angle_rad[0])
        0.1
    """

    angle_rad: Quantity = Quantity()
    start_s: Quantity = Quantity(0.0, "number of 0 or more")

    def _points(self) -> Points:
        return [self.start_s] * 2, [0.0, 0.0]
