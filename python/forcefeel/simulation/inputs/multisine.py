"""A periodic force with chosen spectral lines and a low crest factor, for identification."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from forcefeel.errors import InputError
from forcefeel.simulation.inputs.sampled import ROUNDING, Grid, Sampled, check_frequencies, check_number, through_values
from forcefeel.units import show

_MOST_CYCLES = 100_000  # of the highest line in a period: a grid of 64 points a cycle then takes 50 MB
_FINE, _COARSE = 64, 8  # points per cycle of the highest line
_CLIPPINGS = 300  # four times as many lower the crest factor by 2 % more for even lines, 10 % for spread ones
_CLIP_AT = (0.75, 0.95)  # of the peak, first and last: deep cuts to leave a poor start, shallow ones to settle


@dataclass(frozen=True)
class Multisine:
    """A sum of cosines on chosen lines: ``F(t) = A sum_i w_i cos(2 pi f_i t + phi_i)``, periodic from the start.

    The weights w_i are all 1 if not given. Without a seed the phases are Schroeder's, ``phi_i = -2 pi sum_{j<i} (i - j) p_j`` with
    the shares ``p_j = w_j^2 / sum w^2`` of the power, ``-pi i (i - 1) / N`` for N equal lines: low peaks where the lines are
    evenly spaced. With a seed, random phases are improved iteratively by clipping the signal and keeping the phases of
    the clipped one: lower peaks, also for unevenly spaced lines. A is such that the greatest ``|F|`` over the period,
    not only at the steps, is ``force_n``.

    Attributes:
        force_n: Peak, N.
        lines_hz: Frequencies f_i, Hz, above 0, rising, each a whole multiple of ``1 / duration_s``.
        duration_s: Period, s, above 0.
        seed: Seed of the random phases, 0 or more; ``None`` for Schroeder's phases.
        weights: Relative amplitude w_i of each line, above 0; ``None`` for equal lines.

    Raises:
        InputError: When built, if a number is out of range, or the highest line has more than 100000 cycles in a period.

    Source: M. R. Schroeder, Synthesis of Low-Peak-Factor Signals and Binary Sequences with Low Autocorrelation, IEEE
    Trans. Information Theory 16 (1970); E. Van der Ouderaa, J. Schoukens and J. Renneboog, Peak Factor Minimization
    Using a Time-Frequency Domain Swapping Algorithm, IEEE Trans. Instrumentation and Measurement 37 (1988).

    Example:
        >>> ff.simulation.Multisine(20.0, (1.0, 2.0, 4.0), 2.0, seed=1).lines_hz
        (1.0, 2.0, 4.0)
    """

    force_n: float
    lines_hz: tuple[float, ...]
    duration_s: float
    seed: int | None = None
    weights: tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        check_number("Multisine", "force_n", self.force_n, "finite number")
        check_number("Multisine", "duration_s", self.duration_s, "number above 0")
        if self.seed is not None and (not isinstance(self.seed, int) or isinstance(self.seed, bool) or self.seed < 0):
            raise InputError(
                f"Multisine: expected seed to be a whole number of 0 or more, or None, got {show(self.seed)}"
            )
        self._freeze("lines_hz")
        if not self.lines_hz:
            raise InputError("Multisine: expected one line at least in lines_hz, got none")
        for i, line in enumerate(self.lines_hz):
            self._check_line(i, line)
        if self.weights is not None:
            self._freeze("weights")
            self._check_weights(self.weights)

    def _freeze(self, name: str) -> None:
        try:
            object.__setattr__(self, name, tuple(getattr(self, name)))
        except TypeError as error:
            came = show(getattr(self, name))
            raise InputError(f"Multisine: expected {name} to be a row of numbers, got {came}") from error

    def _check_weights(self, weights: tuple[float, ...]) -> None:
        if len(weights) != len(self.lines_hz):
            came = f"{len(weights)} weights for {len(self.lines_hz)} lines"
            raise InputError(f"Multisine: expected as many weights as lines, got {came}")
        for i, weight in enumerate(weights):
            check_number("Multisine", f"weights[{i}]", weight, "number above 0")

    def _check_line(self, i: int, line: float) -> None:
        name = f"lines_hz[{i}]"
        check_number("Multisine", name, line, "number above 0")
        if i and not line > self.lines_hz[i - 1]:
            raise InputError(
                f"Multisine: expected rising lines_hz, got {self.lines_hz[i - 1]:.15g}, then {line:.15g} Hz"
            )
        cycles = line * self.duration_s
        if cycles > _MOST_CYCLES:
            raise InputError(
                f"Multisine: expected at most {_MOST_CYCLES} cycles of {name} in a period, got {cycles:.15g}"
            )
        if abs(cycles - round(cycles)) > ROUNDING or round(cycles) == 0:
            nearest = " and ".join(f"{n / self.duration_s:.15g} Hz" for n in (int(cycles), int(cycles) + 1) if n)
            raise InputError(
                f"Multisine: expected {name} to be a multiple of 1 / duration_s, so that the force is periodic, got "
                f"{line:.15g} Hz; near are {nearest}"
            )

    @cached_property
    def phases_rad(self) -> NDArray[np.float64]:
        """The phases phi_i, rad."""
        count = len(self.lines_hz)
        if self.seed is None:
            i, weights = np.arange(1, count + 1), self._weights
            if self.weights is None:
                return -np.pi * i * (i - 1) / count
            below = np.cumsum(weights**2) / np.sum(weights**2)
            return -2 * np.pi * (np.cumsum(below) - below)
        return self._clipped(np.random.default_rng(self.seed).uniform(-np.pi, np.pi, count))

    @cached_property
    def amplitude_n(self) -> float:
        """The amplitude A of a line of weight 1, N."""
        return float(self.force_n / self._peak())

    def sample(self, time_s: float, step_s: float) -> Sampled:
        """The force over a run, N, periodic: exact at the times of the steps, linear between them.

        Raises:
            InputError: If the run is not a whole number of steps, or a line is at half the sampling rate or above.
        """
        grid = Grid.of(time_s, step_s)
        check_frequencies("Multisine", self.lines_hz[-1], grid)
        return through_values(self.amplitude_n * self._sum(grid.times_s / self.duration_s))

    @property
    def _harmonics(self) -> NDArray[np.int64]:
        """Cycles of each line in a period."""
        return np.rint(np.array(self.lines_hz) * self.duration_s).astype(np.int64)

    @property
    def _weights(self) -> NDArray[np.float64]:
        """The weight of each line."""
        return np.ones(len(self.lines_hz)) if self.weights is None else np.array(self.weights, dtype=np.float64)

    def _sum(self, periods: NDArray[np.float64]) -> NDArray[np.float64]:
        """The sum of the cosines, line by line to limit memory."""
        total = np.zeros_like(periods)
        for harmonic, phase, weight in zip(self._harmonics, self.phases_rad, self._weights, strict=True):
            total += weight * np.cos(2 * np.pi * harmonic * periods + phase)
        return total

    def _wave(self, phases: NDArray[np.float64], points: int) -> NDArray[np.float64]:
        """One period of the sum of the cosines at evenly spaced points."""
        spectrum = np.zeros(points // 2 + 1, dtype=np.complex128)
        spectrum[self._harmonics] = points / 2 * self._weights * np.exp(1j * phases)
        return np.fft.irfft(spectrum, points)

    def _clipped(self, phases: NDArray[np.float64]) -> NDArray[np.float64]:
        """``phases`` after the clippings, which lower the peak."""
        from scipy.fft import next_fast_len  # noqa: PLC0415  an extra, and only here and below

        harmonics = self._harmonics
        points = next_fast_len(_COARSE * int(harmonics[-1]), real=True)
        for level in np.linspace(*_CLIP_AT, _CLIPPINGS):
            wave = self._wave(phases, points)
            limit = level * np.abs(wave).max()
            phases = np.angle(np.fft.rfft(np.clip(wave, -limit, limit))[harmonics])
        return phases

    def _peak(self) -> float:
        """The greatest ``|sum of the cosines|`` over the period.

        Near its greatest peak P a sum of cycles up to N stays above ``P cos(2 pi N t)`` (M. Riesz), so with M points the one
        next to the peak has ``P cos(pi N / M)`` at least: only such points are followed up.
        """
        from scipy.fft import next_fast_len  # noqa: PLC0415

        highest = int(self._harmonics[-1])
        points = next_fast_len(_FINE * highest, real=True)
        height = np.abs(self._wave(self.phases_rad, points))
        candidates = np.flatnonzero(height >= height.max() * np.cos(np.pi * highest / points))
        return max(float(height.max()), *(self._top(int(i), points) for i in candidates))

    def _top(self, i: int, points: int) -> float:
        """The greatest height within half a point of point ``i``."""
        from scipy.optimize import minimize_scalar  # noqa: PLC0415  slow to import, and only here

        turn, phases, weights = 2 * np.pi * self._harmonics, self.phases_rad, self._weights
        minimum = minimize_scalar(
            lambda t: -abs(float(weights @ np.cos(turn * t + phases))),
            bounds=((i - 0.5) / points, (i + 0.5) / points),
            method="bounded",
            options={"xatol": 1e-4 / points},  # the height is then right to (1e-4 pi / 64)^2 / 2, 1e-11
        )
        return float(-minimum.fun)
