"""Faults of a measured frequency response that show without a model."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from forcefeel.bench.responses import Response
from forcefeel.errors import InputError
from forcefeel.tables.header import DECIBEL

FEWEST_LINES = 3
"""Least number of lines of a response."""
LEAST_COHERENCE = 0.3
"""Least coherence of the best line: below it more than two thirds of the output do not come from the input."""

_MOST_DECIBELS = 400.0
"""Largest gain in dB, a ratio of 10^20."""


def fault_of_values(
    columns: Mapping[str, NDArray[np.float64]], units: Mapping[str, str], most_phase_rad: float
) -> tuple[int, str] | None:
    """The first faulty row, counted from 1, and its fault, for faults that complex numbers would hide.

    Args:
        columns: Columns of a response by name.
        units: Their SI units or ``DECIBEL``.
        most_phase_rad: Largest credible phase.
    """
    for i in range(len(columns["frequency"])):
        row = {name: float(values[i]) for name, values in columns.items()}
        if wrong := next((f"{name} is {value}" for name, value in row.items() if not np.isfinite(value)), None):
            return i + 1, f"{wrong}; expected finite numbers; leave the row out"
        gain, decibels = row["gain"], units["gain"] == DECIBEL
        if not decibels and gain <= 0:
            return (
                i + 1,
                f"the gain is {gain:.6g} as a ratio; expected one above 0; is it in dB, or its sign in the phase?",
            )
        if decibels and abs(gain) > _MOST_DECIBELS:
            return i + 1, f"the gain is {gain:.6g} dB; expected {_MOST_DECIBELS:g} dB at most; is it a ratio?"
        if abs(row["phase"]) > most_phase_rad:
            return i + 1, (
                f"the phase is {row['phase']:.6g} rad; expected {most_phase_rad:g} rad at most; is it in degrees? Say so, as in "
                "'phase (deg)'"
            )
    return None


def check_response(response: Response, places: Sequence[str] | None = None) -> None:
    """Refuse a response that cannot be compared with a model.

    Args:
        response: The response.
        places: Where each line stands, after the header's place, for messages; its name and line numbers from 1 if not given.

    Raises:
        InputError: With the first faulty line: fewer than three lines, rows of other lengths, numbers that are not finite,
            frequencies not above zero or not rising. Also: no gain, a coherence outside 0 to 1 or low at all lines, a deviation not
            above zero.
    """
    name, f = response.name, np.asarray(response.frequency_hz)
    rows = {"value": response.value, "coherence": response.coherence, "deviation": response.deviation}
    for what, values in rows.items():
        if values is not None and np.shape(values) != f.shape:
            raise InputError(f"{name}: expected {what} at each of {f.shape} frequencies, got shape {np.shape(values)}")
    if f.ndim != 1 or len(f) < FEWEST_LINES:
        raise InputError(f"{_place(response, places, len(f) if f.ndim else 0)}: has {f.size} lines; expected "
                         f"{FEWEST_LINES} at least; measure at more frequencies")  # fmt: skip
    for i in range(len(f)):
        if sentence := _wrong(response, i):
            raise InputError(f"{_place(response, places, i + 1)}: {sentence}")
    if response.coherence is not None and (best := float(np.max(response.coherence))) < LEAST_COHERENCE:
        raise InputError(
            f"{_place(response, places, None)}: the coherence is {best:.2g} at best; expected {LEAST_COHERENCE:g} at some line; "
            "the output does not come from this input: drive harder, average longer, or check the cables"
        )


def _wrong(response: Response, i: int) -> str | None:
    """The fault of line ``i``."""
    f, before = float(response.frequency_hz[i]), float(response.frequency_hz[i - 1]) if i else 0.0
    if not np.isfinite(f) or not np.isfinite(response.value[i]):
        return f"expected finite numbers, got {response.value[i]} at {f} Hz; leave the line out"
    if f <= before:
        return _wrong_order(f, before, first=i == 0)
    if response.value[i] == 0:
        return f"the gain is zero at {f:.6g} Hz; expected one above 0; leave the line out"
    if response.coherence is not None and not 0 <= response.coherence[i] <= 1:
        fault = f"the coherence is {response.coherence[i]:.6g}"
        return f"{fault}; expected 0 to 1; is it in percent? Say so, as in 'coherence (%)'"
    if response.deviation is not None and not 0 < response.deviation[i] < np.inf:
        fault = f"the deviation is {response.deviation[i]:.6g}"
        return f"{fault}; expected a share above 0 of the gain; leave the column out"
    return None


def _wrong_order(f: float, before: float, *, first: bool) -> str:
    """The fault of a frequency that does not rise from the previous one, or from zero."""
    if f <= 0 or first:
        return f"the frequency is {f:.6g} Hz; expected one above 0; leave the line out"
    if f == before:
        return f"the frequency of {f:.6g} Hz is there twice; leave one of the lines out"
    return f"the frequency falls from {before:.6g} Hz to {f:.6g} Hz; expected rising ones; sort the lines"


def _place(response: Response, places: Sequence[str] | None, line: int | None) -> str:
    if places is None:
        return response.name if line is None else f"{response.name}: line {line}"
    return places[0].rsplit(": ", 1)[0] if line is None else places[line]
