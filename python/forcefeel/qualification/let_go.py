"""Detection of the release in a record, and checks that the record can be measured."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from forcefeel.errors import InputError
from forcefeel.qualification.records import Record
from forcefeel.qualification.rules import ReleaseRules

SLOWEST_HZ = 50.0
"""Least sampling rate of a record of a release."""

_SAME_RATE = 0.98
"""Tolerance of that rate."""
_SEEN = 4.0
"""Standard deviations of noise beyond which a control has left its held position."""
_LEAST = 20.0
"""Least displacement of a release, in multiples of noise and resolution."""
_EXACT = 1e-9
"""Share of the range within which values of a noise-free record are equal."""
_ON_SAMPLE = 0.02
"""Share of a step within which the release coincides with a sample."""
_BEGUN, _UNDER_WAY = 0.02, 0.1
"""Shares of Ad that bound the start of motion: the start precedes the first by at most the time from the first to the second,
because the displacement of a mass grows as the square of time."""
_FEWEST_HELD = 3
"""Least number of held samples from which the wander of the grip is estimated."""
_LEAST_WANDER = 1e-4
"""Least wander as a share of Ad: a 2 Hz column moves this far in a millisecond."""
_CLEAR, _FEWEST = 25.0, 2
"""Displacement, in wanders of the held grip, over which the start of motion is extrapolated, and its least number of samples."""
_CLIPPED = 3
"""Samples at one extreme value, reached at speed, that indicate clipping."""
_AT_SPEED = 0.002
"""Least step at speed as a share of the range; also more than six times noise and resolution."""


@dataclass(frozen=True)
class LetGo:
    """A release in a record.

    Attributes:
        held: Number of samples before the release; the control is free after the last of them.
        free: First sample of the free response.
        tail: Number of samples at the end whose mean is the steady state.
        time_s: Time of the release, s.
        time_uncertainty_s: Standard uncertainty of that time, s.
        displacement: Approximate held position minus steady state.
        wander: Standard deviation of the held position: sensor noise and real motion of the held control.
    """

    held: int
    free: int
    tail: int
    time_s: float
    time_uncertainty_s: float
    displacement: float
    wander: float


def check_rate(record: Record) -> None:
    """Refuses a record with too low a sampling rate.

    Raises:
        InputError: If it has fewer than ``SLOWEST_HZ`` samples a second.
    """
    rate = 1 / record.step_s
    if rate < _SAME_RATE * SLOWEST_HZ:
        raise InputError(
            f"{record.name}: has {rate:.4g} samples a second; expected {SLOWEST_HZ:g} at least for a release; "
            "record at a higher rate"
        )


def find_release(record: Record, tail: float, rules: ReleaseRules) -> LetGo:
    """The release in a record.

    Raises:
        InputError: If the record ends where it began, or too few samples follow the release.
    """
    x, t = record.position, record.time_s
    if not 0 < tail <= 0.5:
        raise InputError(f"tail: expected a share of the record above 0, at most 0.5, got {tail}")
    floor = max(_SEEN * record.position_noise, 1.5 * record.position_resolution, _EXACT * float(np.ptp(x)))
    steady = float(np.mean(x[-max(int(tail * len(x)), 1) :]))
    least = max(_LEAST / _SEEN * floor, _EXACT * float(np.max(np.abs(x))))
    level, moved, known = float(x[0]), 1, record.release_s
    if known is not None:
        moved = int(np.searchsorted(t, known + _ON_SAMPLE * record.step_s, side="right"))
        level = float(np.mean(x[:moved]))
    elif abs(level - steady) > least:
        level, moved, floor = _departure(x, steady, floor, rules.high)
    displacement = level - steady
    if abs(displacement) <= least:
        raise InputError(
            f"{record.name}: has no release: the position is {record.shown(float(level))} at {t[0]:.6g} s and "
            f"{record.shown(float(steady))} at its end, {t[-1]:.6g} s; expected a control that is held off its "
            "steady state and let go"
        )
    samples = len(x) - moved
    if samples < 20:
        raise InputError(
            f"{record.name}: ends at {t[-1]:.6g} s, {samples} samples after the release; expected 20 at least; record "
            "for longer"
        )
    when, uncertainty = _when(record, level, moved, floor) if known is None else (known, 0.0)
    on_sample = abs(when - t[moved - 1]) < _ON_SAMPLE * record.step_s
    free = moved - 1 if on_sample or moved == 1 else moved
    return LetGo(moved, free, max(int(tail * samples), 1), when, uncertainty, displacement, float(np.std(x[:moved])))


def _departure(x: NDArray[np.float64], steady: float, floor: float, high: float) -> tuple[float, int, float]:
    """Held position, first sample after the last one near it, and wander of the held grip."""
    level, moved = float(x[0]), 1
    wander = floor = max(floor, _LEAST_WANDER * abs(level - steady))
    for _ in range(3):
        gone = np.abs(x - steady) < high * abs(level - steady)
        passed = int(np.argmax(gone)) if gone.any() else len(x) - 1
        away = np.abs(x[: passed + 1] - level)
        # A grip held by a hand, or by a loader with noisy sensors, wanders by more than its sensor's noise.
        begun, under_way = (
            int(np.flatnonzero(away <= share * abs(level - steady))[-1:].sum()) for share in (_BEGUN, _UNDER_WAY)
        )
        held = begun - (under_way - begun)
        if held >= _FEWEST_HELD:
            wander = max(floor, _SEEN * float(np.std(x[:held])), float(np.max(away[:held])))
        still = np.flatnonzero(away <= wander)
        moved = int(still[-1]) + 1 if len(still) else 1
        level = float(np.mean(x[:moved]))
    return level, max(min(moved, len(x) - 1), 1), wander


def _when(record: Record, level: float, moved: int, floor: float) -> tuple[float, float]:
    """Time of the release and its uncertainty: the displacement starts as ``(t - t_0)^2``, so its root is linear in time."""
    t, distance = record.time_s[moved:], np.abs(record.position[moved:] - level)
    step = record.step_s / math.sqrt(12)
    if moved == 1:
        return float(record.time_s[0]), step
    until = max(int(np.argmax(distance > _CLEAR * floor)), _FEWEST)
    when, longer = (_laid_back(t[:count], distance[:count], record.step_s) for count in (until, until + until // 2))
    return max(when, float(record.time_s[0])), math.hypot(step, longer - when)


def _laid_back(t: NDArray[np.float64], distance: NDArray[np.float64], step_s: float) -> float:
    """Time at which the root of a displacement, extrapolated linearly, is zero."""
    slope, at_zero = np.polyfit(t - t[0], np.sqrt(distance), 1)
    early = float(np.clip(at_zero / slope, 0.0, t[-1] - t[0] + step_s)) if slope > 0 else 0.0
    return float(t[0]) - early


def check_clipping(record: Record, let_go: LetGo) -> None:
    """Refuses a clipped record: it reaches an extreme value at speed and stays there.

    Raises:
        InputError: With the value and the time.
    """
    x, t = record.position[let_go.held :], record.time_s[let_go.held :]
    small = max(6 * record.position_noise, 6 * record.position_resolution, _AT_SPEED * float(np.ptp(record.position)))
    for extreme in (float(x.min()), float(x.max())):
        at = x == extreme
        edges = np.flatnonzero(np.diff(np.concatenate(([0], at.astype(np.int8), [0]))))
        for begin, end in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
            # The last step before the extreme is shortened too.
            fast = begin > 1 and bool(np.max(np.abs(np.diff(x[begin - 2 : begin + 1]))) > small)
            if end - begin >= _CLIPPED and fast and end < len(x):
                raise InputError(
                    f"{record.name}: is clipped at {record.shown(float(extreme))} from {t[begin]:.6g} s to "
                    f"{t[end - 1]:.6g} s; expected the whole swing; record with a larger range"
                )
