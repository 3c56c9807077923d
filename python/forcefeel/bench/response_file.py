"""Measured frequency responses from files."""

from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from forcefeel.bench.channels import CHANNELS, channel_and_unit
from forcefeel.bench.experiments import Experiment
from forcefeel.bench.response_checks import check_response, fault_of_values
from forcefeel.bench.responses import Response
from forcefeel.bench.stated import drive_channel, stated_experiment
from forcefeel.errors import InputError
from forcefeel.tables.header import DECIBEL, by_standard_name, locate, need, same_unit
from forcefeel.tables.table import Columns, Table
from forcefeel.tables.table_file import open_table
from forcefeel.units import factor, show

EXAMPLE = "frequency (Hz),gain (dB),phase (deg)"
"""A good header."""

_NAMES = ("frequency", "gain", "phase", "coherence", "deviation")
_MOST_LINES = 100_000
"""Largest number of lines; a longer response is an average of one spectrum."""
_MOST_PHASE_RAD = 30.0
"""Largest phase in rad, twice the turn of ten poles; a larger number is in degrees."""


def read_response(
    path: str | Path,
    *,
    experiment: Experiment | str | None = None,
    input: str | None = None,  # noqa: A002  the word for it
    output: str | None = None,
    columns: Mapping[str, str] | None = None,
    units: Mapping[str, str] | None = None,
) -> Response:
    """Read a frequency response from a ``.csv``, ``.parquet`` or ``.mat`` file.

    The columns are ``frequency``, ``gain`` and ``phase`` with their units, and if known ``coherence`` and ``deviation``, the
    standard deviation of a line's relative error. Lines that begin with ``#`` at the top of a CSV file, metadata of a Parquet file
    or text variables of a MATLAB file describe the response: ``experiment: servo-closed``,
    ``from: test_signal (V)``, ``to: potentiometer (V)``.

    A gain in dB is one of the to-unit per from-unit: ``|G| = 10^(g / 20) to/from``. A gain in a unit of its own, such as in/V,
    needs neither unit.

    Args:
        path: The file.
        experiment: The experiment, for a file that does not state it.
        input: Input channel, as ``test_signal (V)``, likewise; default, the drive of the experiment.
        output: Output channel, likewise.
        columns: The file's own names of columns: ``{"frequency": "f"}``.
        units: Units by column or channel, where the file has none.

    Raises:
        InputError: With the file, the line, the fault, the expected value and the remedy.

    Example:
        >>> ff.bench.read_response("examples/bench/servo-closed.csv").output
        'column_angle'
    """
    table = open_table(path, EXAMPLE)
    return response_of(table, experiment, (input, output), columns or {}, units or {})


def response_of(
    table: Table,
    experiment: Experiment | str | None,
    ends: tuple[str | None, str | None],
    own: Mapping[str, str],
    units: Mapping[str, str],
) -> Response:
    """The response in an open table, as ``read_response``; ``ends`` are input and output, ``own`` its ``columns``.

    Raises:
        InputError: As ``read_response``.
    """
    own = by_standard_name(str(table.path), "columns", own, _NAMES)
    units = by_standard_name(str(table.path), "units", units, (*_NAMES, *CHANNELS, *own.values()))
    under = stated_experiment(table, experiment)
    if (drive := drive_channel(under)) is None:
        raise InputError(f"{table.path}: a release has no frequency response; give its record in time")
    start, start_unit = _end(table, "from", ends[0] or (None if "from" in table.notes else drive), "input", units)
    end, end_unit = _end(table, "to", ends[1], "output", units)
    if start == end:
        raise InputError(f"{table.path}: leads from {start} to itself; expected two channels")
    ratio = f"({CHANNELS[end]})/({CHANNELS[start]})"
    accepted = {
        "frequency": ("Hz",),
        "gain": (DECIBEL, ratio),
        "phase": ("rad",),
        "coherence": ("",),
        "deviation": ("",),
    }
    located = locate(table, accepted, units, own)
    need(table, located, _NAMES[:3], EXAMPLE)
    columns = table.take(located)
    if len(columns.values["frequency"]) > _MOST_LINES:
        raise InputError(f"{table.path}: has more than {_MOST_LINES:,} lines; leave out what is not needed")
    if wrong := fault_of_values(columns.values, columns.units, _MOST_PHASE_RAD):
        row, sentence = wrong
        raise InputError(f"{columns.places[row]}: {sentence}")
    gain = _gain(table, columns, (start, start_unit), (end, end_unit))
    response = Response(
        table.path.stem,
        under,
        start,
        end,
        columns.values["frequency"],
        gain * np.exp(1j * columns.values["phase"]),
        columns.values.get("coherence"),
        columns.values.get("deviation"),
        table.data_hash,
    )
    check_response(response, columns.places)
    return response


def _end(table: Table, key: str, argument: str | None, name: str, units: Mapping[str, str]) -> tuple[str, str]:
    """The channel at one end and its unit, empty if unknown."""
    texts = {f"'{key}'": table.notes.get(key), f"the argument {name}": argument}
    ends = {source: _channel(f"{table.path}: {source}", text) for source, text in texts.items() if text is not None}
    if not ends:
        remedy = f"say so at the top of a CSV file, as in '# {key}: potentiometer (V)', or by the argument {name}"
        raise InputError(f"{table.path}: does not say which channel it leads {key}; {remedy}")
    agreed = _agreed(table, {source: end for source, (end, _) in ends.items()}, str.__eq__)
    stated_units = {source: unit for source, (_, unit) in ends.items()} | {"the argument units": units.get(agreed, "")}
    unit = _agreed(table, {source: unit for source, unit in stated_units.items() if unit}, same_unit)
    try:
        return agreed, unit if not unit or factor(unit, CHANNELS[agreed]) else ""
    except InputError as error:
        raise InputError(
            f"{table.path}: {key}: {agreed}: {error}; expected a unit such as {CHANNELS[agreed]}"
        ) from error


def _channel(where: str, text: str) -> tuple[str, str]:
    """Channel and unit of a text at ``where``."""
    try:
        return channel_and_unit(text)
    except InputError as error:
        raise InputError(f"{where}: {error}") from error


def _agreed(table: Table, statements: Mapping[str, str], same: Callable[[str, str], bool]) -> str:
    """The common statement of the sources; empty without one."""
    source, stated = next(iter(statements.items()), ("", ""))
    for other, word in statements.items():
        if not same(stated, word):
            conflict = f"{source} and {other} contradict each other: {show(stated)} and {show(word)}"
            raise InputError(f"{table.path}: {conflict}; leave one of them out")
    return stated


def _gain(table: Table, columns: Columns, start: tuple[str, str], end: tuple[str, str]) -> NDArray[np.float64]:
    """The gain as a ratio in SI units."""
    gain = columns.values["gain"]
    if columns.units["gain"] != DECIBEL:
        return gain
    for key, (name, unit) in (("from", start), ("to", end)):
        if not unit:
            raise InputError(
                f"{table.path}: the gain is in dB of {end[0]} per {start[0]}, and the unit of {name} is not known; say so, as in "
                f"'# {key}: {name} ({CHANNELS[name]})'"
            )
    scale = factor(end[1], CHANNELS[end[0]]) / factor(start[1], CHANNELS[start[0]])
    return np.asarray(10 ** (gain / 20) * scale, dtype=np.float64)
