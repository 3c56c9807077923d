"""Where in a record the control is let go, and whether the record can be measured at all."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from forcefeel.errors import InputError
from forcefeel.qualification.records import Record
from forcefeel.qualification.rules import ReleaseRules

SLOWEST_HZ = 50.0
"""Fewest samples a second of a record of a release."""

_SAME_RATE = 0.98
"""A record of just under so many samples a second is still one of them."""
_SEEN = 4.0
"""Standard deviations of the noise by which a control that has left its place is off it."""
_LEAST = 20.0
"""A release goes this many times farther than noise and resolution at least."""
_EXACT = 1e-9
"""Share of the range within which values of a record without noise are the same."""
_QUIET = 1e-5
"""Noise, as a share of Ad, below which the first two samples that move say when the way began."""
_ON_SAMPLE = 0.02
"""Share of a step within which the release is at a sample."""
_START = 0.2
"""Share of Ad that the way's start is read from."""
_BENT = 0.1
"""Share of the start's duration to which its beginning is known, with noise and with a way that is no parabola."""
_CLIPPED = 3
"""Samples at one extreme value, reached at speed, that are a clipped record."""
_AT_SPEED = 0.002
"""Share of the range that a control at speed covers in a step; more than six times noise and resolution too."""


@dataclass(frozen=True)
class LetGo:
    """A release in a record.

    Attributes:
        held: Samples before it; the control is free after the last of them.
        free: First sample of the free response.
        tail: Samples at the end over which the steady state is the mean.
        time_s: When it was let go, s.
        time_uncertainty_s: How well that is known, s.
        displacement: Held position less steady state, roughly.
    """

    held: int
    free: int
    tail: int
    time_s: float
    time_uncertainty_s: float
    displacement: float


def check_rate(record: Record) -> None:
    """Refuses a record of too few samples.

    Raises:
        InputError: If there are fewer than ``SLOWEST_HZ`` samples a second.
    """
    rate = 1 / record.step_s
    if rate < _SAME_RATE * SLOWEST_HZ:
        raise InputError(
            f"{record.name}: has {rate:.4g} samples a second; expected {SLOWEST_HZ:g} at least for a release; "
            "record at a higher rate"
        )


def find_release(record: Record, tail: float, rules: ReleaseRules) -> LetGo:
    """Where the control is let go.

    Raises:
        InputError: If it ends where it began, or there are too few samples after it.
    """
    x, t = record.position, record.time_s
    if not 0 < tail <= 0.5:
        raise InputError(f"tail: expected a share of the record above 0, at most 0.5, got {tail}")
    off = max(_SEEN * record.position_noise, 1.5 * record.position_resolution, _EXACT * float(np.ptp(x)))
    steady = float(np.mean(x[-max(int(tail * len(x)), 1) :]))
    least = max(_LEAST / _SEEN * off, _EXACT * float(np.max(np.abs(x))))
    level, moved = float(x[0]), 1
    if abs(level - steady) > least:
        level, moved = _departure(x, steady, off, rules.high)
    displacement = level - steady
    if abs(displacement) <= least:
        raise InputError(
            f"{record.name}: has no release: the position is {level:.6g} {record.position_unit} at {t[0]:.6g} s and "
            f"{steady:.6g} {record.position_unit} at its end, {t[-1]:.6g} s; expected a control that is held off its "
            "steady state and let go"
        )
    samples = len(x) - moved
    if samples < 20:
        raise InputError(
            f"{record.name}: ends at {t[-1]:.6g} s, {samples} samples after the release; expected 20 at least; record "
            "for longer"
        )
    when, known = _when(record, level, displacement, moved)
    on_sample = 0 <= when - t[moved - 1] < _ON_SAMPLE * record.step_s
    free = moved - 1 if on_sample or moved == 1 else moved
    return LetGo(moved, free, max(int(tail * samples), 1), when, known, displacement)


def _departure(x: NDArray[np.float64], steady: float, off: float, high: float) -> tuple[float, int]:
    """The held position, and the first sample that is off it for good."""
    level, moved = float(x[0]), 1
    for _ in range(3):
        away = np.abs(x - steady) < high * abs(level - steady)
        passed = int(np.argmax(away)) if away.any() else len(x) - 1
        still = np.flatnonzero(np.abs(x[: passed + 1] - level) <= off)
        moved = int(still[-1]) + 1 if len(still) else 1
        level = float(np.mean(x[:moved]))
    return level, max(min(moved, len(x) - 1), 1)


def _when(record: Record, level: float, displacement: float, moved: int) -> tuple[float, float]:
    """When it was let go: the way starts as ``(t - t_0)^2``, so that its root is a straight line from ``t_0`` on."""
    t, way = record.time_s[moved:], np.abs(record.position[moved:] - level)
    step = record.step_s / math.sqrt(12)
    if moved == 1:
        return float(record.time_s[0]), step
    if record.position_noise <= _QUIET * abs(displacement) and way[0] > 0:
        root = math.sqrt(way[1] / way[0])
        when = (t[0] * root - t[1]) / (root - 1) if root > 1 else t[0]
        return float(np.clip(when, record.time_s[moved - 1], t[0])), step
    until = int(np.argmax(way > _START * abs(displacement))) + 1
    if until < 3:
        return float(t[0]), record.step_s
    slope, at_zero = np.polyfit(t[:until] - t[0], np.sqrt(way[:until]), 1)
    early = float(np.clip(at_zero / slope, 0.0, t[until - 1] - t[0])) if slope > 0 else 0.0
    return float(t[0]) - early, math.hypot(step, _BENT * (float(t[until - 1] - t[0]) + early))


def check_clipping(record: Record, let_go: LetGo) -> None:
    """Refuses a record of which a swing is cut off: it runs into a value at speed and stands there.

    Raises:
        InputError: With the value and the time.
    """
    x, t = record.position[let_go.held :], record.time_s[let_go.held :]
    small = max(6 * record.position_noise, 6 * record.position_resolution, _AT_SPEED * float(np.ptp(record.position)))
    for extreme in (float(x.min()), float(x.max())):
        at = x == extreme
        edges = np.flatnonzero(np.diff(np.concatenate(([0], at.astype(np.int8), [0]))))
        for begin, end in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
            # The last step before it is cut off too.
            fast = begin > 1 and bool(np.max(np.abs(np.diff(x[begin - 2 : begin + 1]))) > small)
            if end - begin >= _CLIPPED and fast and end < len(x):
                raise InputError(
                    f"{record.name}: is clipped at {extreme:.6g} {record.position_unit} from {t[begin]:.6g} s to "
                    f"{t[end - 1]:.6g} s; expected the whole swing; record with a larger range"
                )
