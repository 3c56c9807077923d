"""Features of many releases at once, by the kernel that measures single releases."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from forcefeel import _core
from forcefeel.errors import InputError
from forcefeel.qualification.release import COLUMNS, REST
from forcefeel.qualification.rules import ReleaseRules, load_rules
from forcefeel.threads import threads_or_cores

_Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ReleaseBatch:
    """Features of releases, a row for each; NaN where a feature does not exist.

    Attributes:
        values: Features from the kernel, (runs, features).
        release_s: Time of all releases, s.
        end_s: End of the records, s.
        band: Residual band, as a share of the displacement.
    """

    values: _Array
    release_s: float
    end_s: float
    band: float

    def __len__(self) -> int:
        return len(self.values)

    def __getitem__(self, rows: slice) -> "ReleaseBatch":
        return ReleaseBatch(self.values[rows], self.release_s, self.end_s, self.band)

    def _column(self, name: str) -> _Array:
        return self.values[:, COLUMNS[name].start]

    @property
    def steady(self) -> _Array:
        """Steady states (runs,), unit of the position."""
        return self._column("steady")

    @property
    def displacement(self) -> _Array:
        """Ad with its sign (runs,), unit of the position."""
        return self._column("displacement")

    @property
    def fall_time_s(self) -> _Array:
        """Times from 0.9 Ad to 0.1 Ad (runs,), s."""
        return self._column("low") - self._column("high")

    @property
    def rise_time_s(self) -> _Array:
        """Times from the release to 90 % of the steady value (runs,), s."""
        return self._column("low") - self.release_s

    @cached_property
    def cycles_s(self) -> _Array:
        """P0, P1, ..., P8 (runs, 9), s."""
        crossings = self.values[:, COLUMNS["crossings"]][:, ::2]
        return np.diff(crossings, axis=1, prepend=self._column("high")[:, None])

    @property
    def overshoots(self) -> _Array:
        """A1, A2, ..., A16 as sizes (runs, 16), unit of the position."""
        return self.values[:, COLUMNS["overshoots"]]

    @property
    def count(self) -> _Array:
        """Overshoots above the residual band (runs,)."""
        return self._column("count")

    @property
    def settled_s(self) -> _Array:
        """Times from which the runs stay in the residual band (runs,), s."""
        return self._column("settled")

    @property
    def measured(self) -> NDArray[np.bool_]:
        """Whether each run is finite and moves (runs,)."""
        moves: NDArray[np.bool_] = np.logical_and(np.isfinite(self.displacement), self.displacement != 0)
        return moves

    @property
    def settled(self) -> NDArray[np.bool_]:
        """Whether each run came to rest: in the residual band for three fall times at its end (runs,)."""
        with np.errstate(invalid="ignore"):
            rested = self.end_s - self.settled_s >= REST * self.fall_time_s
        rests: NDArray[np.bool_] = np.logical_and(self.measured, rested)
        return rests


def measure_releases(
    time_s: ArrayLike,
    position: ArrayLike,
    *,
    held: int = 1,
    tail: float = 0.1,
    rules: ReleaseRules | None = None,
    threads: int | None = None,
) -> ReleaseBatch:
    """The features of many releases without noise, such as simulated ones.

    Args:
        time_s: Times of the samples (samples,), s, increasing; the same for all.
        position: Positions (runs, samples); an array in C order is not copied.
        held: Number of held samples at the start; the control is free from the last of them on.
        tail: Share of the free samples, at the end, whose mean is the steady state.
        rules: Residual band and shares of Ad. Default: those of the default edition.
        threads: Number of threads. Default: all cores.

    Returns:
        The features. A run that is not finite or does not move has none; see ``measured``.

    Raises:
        InputError: If the shapes do not match, the times do not increase, or there are too few samples.

    Example:
        >>> after = np.arange(0, 6, 1 / 500)
        >>> runs = np.stack([0.2 * np.exp(-z * 12 * after) * np.cos(12 * after) for z in (0.2, 0.3)])
        >>> type(ff.qualification.measure_releases(after, runs)).__name__
        'ReleaseBatch'
    """
    rules = rules or load_rules().release
    time, runs = np.asarray(time_s, dtype=np.float64), np.ascontiguousarray(position, dtype=np.float64)
    if time.ndim != 1 or runs.ndim != 2 or runs.shape[1] != len(time):
        came = f"{time.shape} and {runs.shape}"
        raise InputError(f"expected times (samples,) and positions (runs, samples), got shapes {came}")
    if not 1 <= held <= len(time) - 20:
        raise InputError(f"held: expected 1 to {len(time) - 20} of {len(time)} samples, 20 being free, got {held}")
    if not 0 < tail <= 0.5:
        raise InputError(f"tail: expected a share above 0, at most 0.5, got {tail}")
    if not np.all(np.diff(time) > 0):
        raise InputError("time_s: expected rising numbers")
    measuring = _core.ReleaseMeasuring(
        time,
        (rules.residual_band, rules.high, rules.low),
        tail=max(int(tail * (len(time) - held)), 1),
        held=held,
        free=held - 1,
    )
    values = measuring.features(runs, threads_or_cores(threads))
    return ReleaseBatch(values, float(time[held - 1]), float(time[-1]), rules.residual_band)
