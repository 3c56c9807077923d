"""The part of a record between two of its times."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import inf, isfinite

import numpy as np

from forcefeel.errors import InputError
from forcefeel.tables.column_names import by_stem
from forcefeel.tables.table import Columns, LocatedColumns, Places, Table
from forcefeel.units import parse, show

Times = tuple[float, float]
"""First and last time of a part of a record, s, by the record's own time; infinite without a cut."""

ALL: Times = (-inf, inf)


def take_between(table: Table, located: LocatedColumns, between_s: Times) -> Columns:
    """The numbers of the located columns, between two times; ``time`` is one of them.

    Raises:
        InputError: If there is nothing between them, or the file breaks off before the second.
    """
    start, end = between_s
    if not start < end:
        raise InputError(
            f"{table.path}: the argument between_s: expected a time and a later one, got {start:g} s and {end:g} s"
        )
    read = table.take(located)
    time = read.values["time"]
    if table.broken and not (len(time) and end <= time[-1]):
        until = (
            f"it is whole up to {time[-1]:.10g} s; take that part by the argument between_s"
            if len(time)
            else "record anew"
        )
        raise InputError(f"{table.path}: breaks off: {table.broken}; {until}, or give the whole file")
    if between_s == ALL:
        return read
    inside = np.flatnonzero((time >= start) & (time <= end))
    if not len(inside):
        raise InputError(
            f"{table.path}: the argument between_s: has no sample from {start:g} s to {end:g} s; its times are "
            f"{time[0]:.6g} s to {time[-1]:.6g} s"
        )
    numbers = read.places.numbers if isinstance(read.places, Places) else range(len(time) + 1)
    places = Places(getattr(read.places, "before", ""), [numbers[0], *(numbers[i + 1] for i in inside.tolist())])
    return replace(read, values={name: values[inside] for name, values in read.values.items()}, places=places)


def times_by_stem(
    starts: Sequence[str] | None, ends: Sequence[str] | None, stems: Sequence[str]
) -> Mapping[str, Times]:
    """Times of ``--from`` and ``--until``, each ``[STEM=]TIME``, for each file, by its stem.

    Raises:
        InputError: If one is no time, or there is no file.
    """
    for option, texts in (("--from", starts), ("--until", ends)):
        if texts and not stems:
            raise InputError(f"{option}: requires a data file; add one or remove this option")
    first, last = (
        {stem: _seconds(option, text) for stem, text in by_stem(option, texts, stems).items()}
        for option, texts in (("--from", starts), ("--until", ends))
    )
    return {stem: (first.get(stem, -inf), last.get(stem, inf)) for stem in first.keys() | last.keys()}


def _seconds(option: str, text: str) -> float:
    """A time; a number without a unit is in seconds."""
    try:
        number = float(text)
    except ValueError:
        try:
            return parse(text, "s", "6 s")
        except InputError as error:
            raise InputError(f"{option}: {error}") from error
    if not isfinite(number):
        raise InputError(f"{option}: expected a time such as '6 s', got {show(text)}")
    return number
