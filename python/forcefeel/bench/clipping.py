"""Detection of clipping: a signal reaches its extreme value at speed and stays there."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from forcefeel.qualification.records import found_resolution

_CLIPPED = 3
"""Least number of samples at an extreme value, reached at speed, in a clipped signal."""
_AT_SPEED = 0.002
"""Least share of the range that a signal at speed covers in a step."""
_SLOW = 2e-4
"""The same for a slow signal that does not brake: ten steps earlier it is at most twice as fast. A signal stopped by friction
brakes evenly, and ten steps earlier it is seven times as fast."""
_EARLIER = 10
"""Those steps."""
_DELAY = 5
"""Largest delay of a signal after its drive, in samples: the delay of a digital controller."""
_SMOOTH = 6.0
"""Above the steps of resolution that a smooth signal takes per sample before it stays at its top for three: at most 5 on a
parabola, on which three neighbors lie within one. Standard deviations of its noise too."""
_THIRD = 20.0
"""Variance of the third difference of white noise of variance one: 1 + 9 + 9 + 1."""
_NORMAL = 1.4826
"""Standard deviation of a normal variable over the median of its magnitude."""


@dataclass(frozen=True)
class Clipped:
    """Clipped samples, from ``begin`` to before ``end``."""

    begin: int
    end: int


def clipped(values: NDArray[np.float64], drive: NDArray[np.float64] | None = None) -> Clipped | None:
    """The first clipped stretch of a measured signal, or ``None``.

    Three samples or more at the largest or the smallest value, reached at speed. A signal at rest, one that was recorded in
    steps, and one that jumps with a drive that then keeps its value are not clipped.

    Args:
        values: The signal, (samples,).
        drive: Its drive, (samples,), if recorded.
    """
    noise = (
        _NORMAL * float(np.median(np.abs(np.diff(values, 3)))) / np.sqrt(_THIRD)
    )  # the median passes over the corners
    threshold = max(_SMOOTH * noise, _SMOOTH * found_resolution(values))
    clippings = []
    for extreme in (values.min(), values.max()):
        edges = np.flatnonzero(np.diff(np.concatenate(([0], (values == extreme).astype(np.int8), [0]))))
        for begin, end in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
            if end - begin >= _CLIPPED and _at_speed(values, begin, threshold) and not _follows(drive, begin, end):
                clippings.append(Clipped(begin, end))
    return min(clippings, key=lambda clipping: clipping.begin, default=None)


def _at_speed(values: NDArray[np.float64], begin: int, threshold: float) -> bool:
    """Whether a signal reaches sample ``begin`` by more than the threshold per step."""
    if begin < 2:
        return False
    steps = np.abs(np.diff(values[max(begin - 2 - _EARLIER, 0) : begin + 1]))
    span = float(np.ptp(values))
    last_step = float(np.max(steps[-2:]))  # the last step before clipping too
    brakes = len(steps) < _EARLIER + 2 or last_step < 0.5 * steps[0]
    return last_step > max(threshold, (_AT_SPEED if brakes else _SLOW) * span)


def _follows(drive: NDArray[np.float64] | None, begin: int, end: int) -> bool:
    """Whether the drive jumps where the signal does, or just before, and keeps its value for as long."""
    if drive is None:
        return False
    jumps = bool(np.any(np.diff(drive[max(begin - _DELAY, 0) : begin + 1])))
    return jumps and bool(np.all(drive[begin:end] == drive[begin]))
