"""Detection of the periods of a periodic drive."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, next_fast_len, rfft

_ROUNDING = 1e-9
"""Largest motion of a resting drive, as a share of its range."""
_ALIKE = 0.9
"""Least correlation of one period with the next, ramps at both ends of the record included."""
_SAME = 0.03
"""Share of its r.m.s. by which a period may differ from the next: by noise of 2 %, or by half a sample in a period of
1000 at its 10th harmonic."""
_MOST = 0.5
"""Least periodic share of the moving part; a slow chirp resembles itself for a while too."""
_SHORTEST = 16
"""Least number of samples of a period."""
_SETTLED = 2.0
"""Ratio of the difference of the first two periods to that of the last two, above which the first is transient."""


@dataclass(frozen=True)
class Periods:
    """Whole periods, one after the other.

    Attributes:
        begin: First sample of the first.
        samples: Samples of each.
        count: How many.
    """

    begin: int
    samples: int
    count: int

    @property
    def end(self) -> int:
        """The sample after the last."""
        return self.begin + self.samples * self.count


def find_periods(drive: NDArray[np.float64], samples: int | None = None) -> Periods | None:
    """The periods of a drive; ``None`` if it does not repeat for two periods and half of the time that it moves.

    Args:
        drive: The drive at even steps of time, (samples,).
        samples: Samples of a period, if that is known.
    """
    moves = np.abs(drive - drive[0]) > _ROUNDING * np.ptp(drive)
    rests = np.abs(drive - drive[-1]) <= _ROUNDING * np.ptp(drive)
    begin = max(int(np.argmax(moves)) - 1, 0)
    end = len(drive) - max(int(np.argmin(rests[::-1])) - 1, 0)
    moving = drive[begin:end] - np.mean(drive[begin:end])
    for candidate in [samples] if samples is not None else _candidates(moving):
        start, length = _stretch(moving, candidate)
        if length >= max(2 * candidate, _MOST * len(moving)):
            count = length // candidate
            return Periods(
                begin + start + length - count * candidate, candidate, count
            )  # transients are at the beginning
    return None


def settled(periods: Periods, output: NDArray[np.float64]) -> Periods:
    """The periods without those at the beginning in which the output still settles; two are left at least."""
    y = output[periods.begin : periods.end].reshape(periods.count, periods.samples)
    steps = np.sqrt(np.mean(np.diff(y, axis=0) ** 2, axis=1))
    dropped = 0
    while periods.count - dropped > 2 and steps[dropped] > _SETTLED * steps[-1]:
        dropped += 1
    return Periods(periods.begin + dropped * periods.samples, periods.samples, periods.count - dropped)


def _candidates(x: NDArray[np.float64]) -> list[int]:
    """Candidate periods in samples, shortest first."""
    longest = len(x) // 2
    if longest <= _SHORTEST:
        return []
    size = next_fast_len(2 * len(x), real=True)
    lagged = irfft(np.abs(rfft(x, size)) ** 2, size)[: longest + 1]
    energy = np.concatenate(([0.0], np.cumsum(x**2)))
    lags = np.arange(longest + 1)
    overlaps = np.sqrt(energy[len(x) - lags] * (energy[-1] - energy[lags]))
    alike = lagged / np.where(overlaps > 0, overlaps, np.inf)
    inner = alike[1:-1]
    peaks = 1 + np.flatnonzero((inner >= alike[:-2]) & (inner > alike[2:]) & (inner > _ALIKE))
    if alike[-1] > max(_ALIKE, alike[-2]):
        peaks = np.append(peaks, longest)  # exactly two periods
    return [int(peak) for peak in peaks if peak >= _SHORTEST]


def _stretch(x: NDArray[np.float64], samples: int) -> tuple[int, int]:
    """Start and length of the longest periodic stretch."""
    differences = np.concatenate(([0.0], np.cumsum((x[samples:] - x[:-samples]) ** 2)))
    windows = len(differences) - samples
    if windows < 1:
        return 0, 0
    same = differences[samples:] - differences[:windows] <= samples * (_SAME**2) * np.mean(x**2)
    edges = np.flatnonzero(np.diff(np.concatenate(([0], same.astype(np.int8), [0]))))
    if not len(edges):
        return 0, 0
    lengths = edges[1::2] - edges[::2]
    longest = int(np.argmax(lengths))
    return int(edges[2 * longest]), int(lengths[longest]) - 1 + 2 * samples
