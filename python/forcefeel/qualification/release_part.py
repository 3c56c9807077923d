"""The part of a record with its release; motion to the held position may precede it."""

import numpy as np
from numpy.typing import NDArray

from forcefeel.errors import InputError
from forcefeel.qualification.records import Record

_TAIL = 0.1
"""Share of a record at its end whose mean is the steady state."""
_BEYOND = 1.25
"""Largest excursion of a released control, in held displacements, with the wander of a hand."""
_STILL_S = 0.3
"""Least time at rest of a held or settled control; a swing above 0.5 Hz stays near its turning point for less."""
_BAND = 0.05
"""Band within which a control is at rest, as a share of the farthest position."""
_NOISE = 12.0
"""Peak-to-peak noise in standard deviations."""
_AWAY = 0.25
"""Share of the farthest position beyond which a control at rest is held."""
_PASSED = 0.1
"""Share of the held displacement at which the fall ends."""
_HELD_S = 0.5
"""Held time that is kept before the release; its mean is the held position."""


def release_part(record: Record) -> Record:
    """The record from the end of its hold on; unchanged if it begins held or its release time is known.

    Raises:
        InputError: If there is more than one release, with the times.
    """
    x, t = record.position, record.time_s
    away = np.abs(x - float(np.mean(x[-max(int(_TAIL * len(x)), 1) :])))
    farthest = float(away.max())
    if record.release_s is not None or farthest <= _BEYOND * away[0]:
        return record
    from scipy.ndimage import maximum_filter1d, minimum_filter1d  # noqa: PLC0415  slow to import, and only here

    samples = max(round(_STILL_S / record.step_s), 2)
    band = max(_BAND * farthest, _NOISE * record.position_noise, 2 * record.position_resolution)
    still = maximum_filter1d(x, samples) - minimum_filter1d(x, samples) <= band
    held = still & (away > _AWAY * farthest)
    holds = [hold for hold in _holds(held, still & ~held) if _is_hold(away, *hold)]
    if len(holds) > 1:
        at = ", ".join(f"{t[last]:.4g} s" for _, last in holds)
        raise InputError(
            f"{record.name}: has {len(holds)} releases, about {at}; expected one; select it with the argument between_s"
        )
    if not holds:
        return record
    begin, last = holds[0]
    # The filters are centered.
    return record.between(max(float(t[begin]), float(t[min(last + samples // 2, len(t) - 1)]) - _HELD_S), float(t[-1]))


def _holds(held: NDArray[np.bool_], rests: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """First and last sample of each hold that is followed by rest."""
    still = np.flatnonzero(held | rests)
    lasts = still[:-1][held[still[:-1]] & rests[still[1:]]]
    moving = np.flatnonzero(~held)
    begins = [int(moving[moving < last][-1:].sum()) + 1 for last in lasts]
    return list(zip(begins, lasts.tolist(), strict=True))


def _is_hold(away: NDArray[np.float64], begin: int, last: int) -> bool:
    """Whether a control is at rest for at least its fall time; a slow turning point is not a hold."""
    samples = int(np.argmax(away[last:] < _PASSED * away[last]))
    return last - begin >= samples
