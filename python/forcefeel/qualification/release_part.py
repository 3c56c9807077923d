"""The part of a record with its release: a session has the way to the held position before it, and may have more than one."""

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d, minimum_filter1d

from forcefeel.errors import InputError
from forcefeel.qualification.records import Record

_TAIL = 0.1
"""Share of a record at its end over which its steady state is the mean."""
_BEYOND = 1.25
"""A control that is let go never goes farther from its steady state than it was held, by the wander of a hand."""
_STILL_S = 0.3
"""For so long a control is still that is held or rests; what swings is so near to its turn for less, from 0.5 Hz on."""
_BAND = 0.05
"""Share of the farthest position within which a control is still."""
_NOISE = 12.0
"""Standard deviations of noise from its lowest to its highest value."""
_AWAY = 0.25
"""Share of the farthest position beyond which a control that is still is held off its steady state."""
_PASSED = 0.1
"""Of the held position: there the way back is over."""
_HELD_S = 0.5
"""Of the time that it is held so much is kept: its level there is the held position, without the last of the way to it."""


def release_part(record: Record) -> Record:
    """The record from the end of its hold on; one that begins in the hold, or says when it was let go, as it is.

    Raises:
        InputError: If the control is held and let go more than once, with the times.
    """
    x, t = record.position, record.time_s
    away = np.abs(x - float(np.mean(x[-max(int(_TAIL * len(x)), 1) :])))
    farthest = float(away.max())
    if record.release_s is not None or farthest <= _BEYOND * away[0]:
        return record
    samples = max(round(_STILL_S / record.step_s), 2)
    band = max(_BAND * farthest, _NOISE * record.position_noise, 2 * record.position_resolution)
    still = maximum_filter1d(x, samples) - minimum_filter1d(x, samples) <= band
    held = still & (away > _AWAY * farthest)
    holds = [hold for hold in _holds(held, still & ~held) if _is_hold(away, *hold)]
    if len(holds) > 1:
        at = ", ".join(f"{t[last]:.4g} s" for _, last in holds)
        raise InputError(
            f"{record.name}: is let go {len(holds)} times, about {at}; expected one release; take one by the argument between_s"
        )
    if not holds:
        return record
    begin, last = holds[0]
    # The filters look half of their time to either side.
    return record.between(max(float(t[begin]), float(t[min(last + samples // 2, len(t) - 1)]) - _HELD_S), float(t[-1]))


def _holds(held: NDArray[np.bool_], rests: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """First and last sample of each stretch that is held and after which the control rests next."""
    still = np.flatnonzero(held | rests)
    lasts = still[:-1][held[still[:-1]] & rests[still[1:]]]
    moving = np.flatnonzero(~held)
    begins = [int(moving[moving < last][-1:].sum()) + 1 for last in lasts]
    return list(zip(begins, lasts.tolist(), strict=True))


def _is_hold(away: NDArray[np.float64], begin: int, last: int) -> bool:
    """Whether a control is still for as long as its way takes then, which one that turns round slowly is not."""
    samples = int(np.argmax(away[last:] < _PASSED * away[last]))
    return last - begin >= samples
