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
_ON_SAMPLE = 0.02
"""Share of a step within which the release is at a sample."""
_BEGUN, _UNDER_WAY = 0.02, 0.1
"""Shares of Ad that a control has left behind on its way: it began to move before the first at the latest by as much time again as
it took from there to the second, since a mass goes as the square of the time."""
_FEWEST_HELD = 3
"""Samples of a held grip from which it is read how far it wanders."""
_LEAST_WANDER = 1e-4
"""As a share of Ad: a grip that is held stiller than that shows the instant no better, since a 2 Hz column has gone as far in a
millisecond."""
_CLEAR, _FEWEST = 25.0, 2
"""How many times as far as a held grip wanders the way's beginning reaches that is laid back to its start, and its fewest
samples."""
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
        wander: Standard deviation of the held position: noise of the sensor and what the held control really moves.
    """

    held: int
    free: int
    tail: int
    time_s: float
    time_uncertainty_s: float
    displacement: float
    wander: float


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
    """The held position, the first sample that is off it for good, and how far off it the held grip wanders."""
    level, moved = float(x[0]), 1
    wander = floor = max(floor, _LEAST_WANDER * abs(level - steady))
    for _ in range(3):
        gone = np.abs(x - steady) < high * abs(level - steady)
        passed = int(np.argmax(gone)) if gone.any() else len(x) - 1
        away = np.abs(x[: passed + 1] - level)
        # A grip that is held by a hand, or by a loader whose sensors are noisy, wanders more than its sensor's noise.
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
    """When it was let go: the way starts as ``(t - t_0)^2``, so that its root is a straight line from ``t_0`` on."""
    t, distance = record.time_s[moved:], np.abs(record.position[moved:] - level)
    step = record.step_s / math.sqrt(12)
    if moved == 1:
        return float(record.time_s[0]), step
    until = max(int(np.argmax(distance > _CLEAR * floor)), _FEWEST)
    when, longer = (_laid_back(t[:count], distance[:count], record.step_s) for count in (until, until + until // 2))
    return max(when, float(record.time_s[0])), math.hypot(step, longer - when)


def _laid_back(t: NDArray[np.float64], distance: NDArray[np.float64], step_s: float) -> float:
    """Where the root of a way, as a straight line, begins."""
    slope, at_zero = np.polyfit(t - t[0], np.sqrt(distance), 1)
    early = float(np.clip(at_zero / slope, 0.0, t[-1] - t[0] + step_s)) if slope > 0 else 0.0
    return float(t[0]) - early


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
                    f"{record.name}: is clipped at {record.shown(float(extreme))} from {t[begin]:.6g} s to "
                    f"{t[end - 1]:.6g} s; expected the whole swing; record with a larger range"
                )
