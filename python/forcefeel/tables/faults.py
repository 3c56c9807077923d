"""Faults of the numbers of signals over time."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from forcefeel.errors import InputError

GAP = 5.0
"""Ratio of a step to the median step above which it is a gap."""

LARGEST = 1e15
"""Largest value in any SI unit, above that of sensors, so that powers of sums over a record do not overflow."""

_ROUNDING = 1e-6
"""Tolerance as a share of a step; decimal times have an error of 3e-16, which allows a billion steps."""
_SHORTEST_STEP_S = 10e-6
"""Shortest median step of a record: a hundredth of a usual controller's period."""


_CUT = "cut the recording there"


def in_file(sentence: str) -> str:
    """A fault of a row, with the argument that reads only a part of the file."""
    return f"{sentence}, by the argument between_s" if sentence.endswith(_CUT) else sentence


def fault(columns: Mapping[str, NDArray[np.float64]], units: Mapping[str, str]) -> tuple[int, str] | None:
    """The first faulty row, counted from 1, and its fault; ``time`` is one of the columns."""
    time = columns["time"]
    if len(time) < 2:
        return len(time), f"expected two rows of numbers at least, got {len(time)}; record for longer"
    finite = np.logical_and.reduce([np.isfinite(values) for values in columns.values()])
    if not finite.all():
        i = int(np.argmin(finite))
        value_text = " and ".join(f"{values[i]:.15g} {units[name]}" for name, values in columns.items())
        return i + 1, f"expected finite numbers, got {value_text}; leave the row out if the sample was lost"
    for name, values in columns.items():
        i = int(np.argmax(np.abs(values)))
        if name != "time" and abs(values[i]) > LARGEST:
            value_text = f"{name} is {values[i]:.6g} {units[name]}"
            return i + 1, f"{value_text}; expected at most {LARGEST:g}; leave the row out if the sample was lost"
    with np.errstate(over="ignore"):  # times from end to end of what a number can hold
        steps = np.diff(time)
    if not (steps > 0).all():
        i = int(np.argmin(steps > 0))
        what = f"time runs backwards from {time[i]:.15g} s to" if steps[i] < 0 else "time stands still at"
        return i + 2, f"{what} {time[i + 1]:.15g} s; expected rising times; sort the rows and leave one of each time"
    median = float(np.median(steps))
    gaps = steps > GAP * median * (1 + _ROUNDING)
    if gaps.any():
        i = int(np.argmax(gaps))
        what = f"a gap of {steps[i]:.6g} s after {time[i]:.15g} s"
        return i + 2, f"{what}; expected at most {GAP:g} times the median step of {median:.6g} s; {_CUT}"
    return None


def check_step(time_s: NDArray[np.float64], where: str, longest_s: float) -> None:
    """Refuse a time that is most likely in another unit than stated.

    Args:
        time_s: Rising times, s.
        where: The record, for the message.
        longest_s: Longest median step of such a record, s.

    Raises:
        InputError: With the median step and the remedy.
    """
    step = float(np.median(np.diff(time_s)))
    if _SHORTEST_STEP_S * (1 - _ROUNDING) <= step <= longest_s * (1 + _ROUNDING):
        return
    unit, expected = ("ms", "ms") if step > longest_s else ("s", "s, not in ms")
    raise InputError(
        f"{where}: time: has a median step of {step:.6g} s; expected {_SHORTEST_STEP_S * 1e6:.0f} microseconds to "
        f"{longest_s:g} s; is the time in {expected}? Say so in the header, 'time ({unit})', or where it has no unit by the "
        f"argument units (time={unit})"
    )
