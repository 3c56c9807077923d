"""Tables of recorded signals: columns with their units in a CSV or a Parquet file."""

import csv
import io
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from forcefeel.errors import InputError
from forcefeel.inputs.sampled import ROUNDING
from forcefeel.units import factor, show

GAP = 5.0
"""A step of more than so many times the median step is a gap in a recording."""

_HEADER = re.compile(r"(?P<name>.*?)\s*(?:\((?P<round>[^;]*)\)|\[(?P<square>[^;]*)\]|_(?P<suffix>[^_\s]+))?", re.DOTALL)
_SUFFIXES = {"n": "N", "kn": "kN"}  # names are in small letters, where these units are not
# What a column can be in; longer powers only keep the units' parser busy.
_UNIT = re.compile(r"[A-Za-zµμ°%][A-Za-zµμ°% */()]{0,39}(?:\^[0-9])?")
_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
_NOT_FINITE = re.compile(r"[+-]?(?:nan|inf|infinity)", re.IGNORECASE)


@dataclass(frozen=True)
class Column:
    """A column that is looked for.

    Attributes:
        name: Its name in the header, without the unit.
        units: SI units it may be in, the first as an example.
        optional: It may be missing.
    """

    name: str
    units: tuple[str, ...]
    optional: bool = False

    @property
    def example(self) -> str:
        """Its name with its unit."""
        return f"{self.name} ({self.units[0]})"


@dataclass(frozen=True, eq=False)
class Columns:
    """What was read: values in SI units by name, each one's SI unit, and where each row stands."""

    values: dict[str, NDArray[np.float64]]
    units: dict[str, str]
    places: Sequence[str]


def read_csv(path: Path, wanted: Sequence[Column], example: str) -> Columns:
    """The wanted columns of a CSV file in UTF-8; others may stand beside them and are not read.

    Args:
        path: The file.
        wanted: Which columns.
        example: A good header, for the message.

    Raises:
        InputError: With the file, the line, what is wrong, what was expected and the remedy.
    """
    rows = csv_rows(path, decode(path, read_bytes(path, example)), example)
    header, line = csv_header(path, rows, example)
    return csv_columns(path, rows, header, line, find_columns(header, wanted, f"{path}: line {line}", example))


def csv_header(path: Path, rows: Iterator[tuple[int, list[str]]], example: str) -> tuple[list[str], int]:
    """The cells of the first of the rows, and its line.

    Raises:
        InputError: If there is none.
    """
    line, header = next(rows, (1, []))
    if not header:
        raise InputError(f"{path}: line 1: is empty; expected a header such as {example!r} and rows of numbers")
    return [" ".join(cell.split()) for cell in header], line


def csv_columns(
    path: Path,
    rows: Iterator[tuple[int, list[str]]],
    header: Sequence[str],
    line: int,
    found: Mapping[str, tuple[int, str, float]],
) -> Columns:
    """The numbers of the columns that were found, from the rows below the header on ``line``.

    Raises:
        InputError: If a row has another length than the header or something that is no finite number.
    """
    lines, numbers = [line], []
    for at, row in rows:
        if len(row) != len(header):
            raise InputError(
                f"{path}: line {at}: expected {len(header)} values as in the header, got {len(row)}; "
                "write numbers with a decimal point and part them with one comma"
            )
        where = f"{path}: line {at}"
        numbers.append([_number(row[i], f"{where}: {name}") * scale for name, (i, _, scale) in found.items()])
        lines.append(at)
    table = np.array(numbers, dtype=np.float64).reshape(-1, len(found)).T
    places = [f"{path}: line {at}" for at in lines]
    return Columns(dict(zip(found, table, strict=True)), {name: unit for name, (_, unit, _) in found.items()}, places)


def fault(columns: dict[str, NDArray[np.float64]], units: dict[str, str]) -> tuple[int, str] | None:
    """The first row at fault, counted from 1, and what is wrong with it; ``time`` is one of the columns."""
    time = columns["time"]
    if len(time) < 2:
        return len(time), f"expected two rows of numbers at least, got {len(time)}; record for longer"
    finite = np.logical_and.reduce([np.isfinite(values) for values in columns.values()])
    if not finite.all():
        i = int(np.argmin(finite))
        came = " and ".join(f"{values[i]:.15g} {units[name]}" for name, values in columns.items())
        return i + 1, f"expected finite numbers, got {came}; leave the row out if the sample was lost"
    with np.errstate(over="ignore"):  # times from end to end of what a number can hold
        steps = np.diff(time)
    if not (steps > 0).all():
        i = int(np.argmin(steps > 0))
        what = f"time runs backwards from {time[i]:.15g} s to" if steps[i] < 0 else "time stands still at"
        return i + 2, f"{what} {time[i + 1]:.15g} s; expected rising times; sort the rows and leave one of each time"
    median = float(np.median(steps))
    gaps = steps > GAP * median * (1 + ROUNDING)
    if gaps.any():
        i = int(np.argmax(gaps))
        what = f"a gap of {steps[i]:.6g} s after {time[i]:.15g} s"
        return (
            i + 2,
            f"{what}; expected at most {GAP:g} times the median step of {median:.6g} s; cut the recording there",
        )
    return None


def find_columns(
    header: Sequence[str], wanted: Sequence[Column], where: str, example: str
) -> dict[str, tuple[int, str, float]]:
    """Which column of the header each is, its SI unit and the SI value of one of its units.

    Raises:
        InputError: If one is missing, stands twice, has no unit or one that does not measure it.
    """
    found = {column.name: _find(header, column, where, example) for column in wanted}
    return {name: place for name, place in found.items() if place}


def read_bytes(path: Path, example: str) -> bytes:
    """What is in the file.

    Raises:
        InputError: If it cannot be read; ``example`` is a good header, for the message.
    """
    try:
        return path.read_bytes()
    except (OSError, ValueError) as error:  # a name with a zero byte is a ValueError
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(f"{path}: cannot be read ({reason}); expected a CSV file such as {example!r}") from error


def decode(path: Path, data: bytes) -> str:
    """The text of a file; a byte order mark, which some editors write, is no part of it.

    Raises:
        InputError: If it is not UTF-8.
    """
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        raise InputError(
            f"{path}: line {line}: is not UTF-8 text (byte {error.start}); save the file as UTF-8"
        ) from error


def csv_rows(path: Path, text: str, example: str) -> Iterator[tuple[int, list[str]]]:
    """The rows that are not empty, each with the line it ends on.

    Raises:
        InputError: If the text is no CSV.
    """
    reader = csv.reader(io.StringIO(text, newline=None), strict=True)
    try:
        yield from ((reader.line_num, row) for row in reader if row)
    except csv.Error as error:
        line = max(reader.line_num, 1)
        raise InputError(f"{path}: line {line}: is not CSV ({error}); expected rows as under {example!r}") from error


def _find(header: Sequence[str], column: Column, where: str, example: str) -> tuple[int, str, float] | None:
    name = column.name
    cells = [_HEADER.fullmatch(cell) for cell in header]
    found = [i for i, cell in enumerate(cells) if cell and cell["name"].lower() == name]
    if not found and column.optional:
        return None
    came = show(",".join(header))
    if len(found) != 1:
        what = f"has no column {name!r}" if not found else f"has {len(found)} columns {name!r}"
        raise InputError(
            f"{where}: {what}; expected a header such as {example!r}, got {came}; "
            f"name one column {column.example!r}, parted by a comma"
        )
    cell = cells[found[0]]
    unit = (cell["round"] or cell["square"] or (cell["suffix"] or "").lower()).strip() if cell else ""
    if not unit:
        raise InputError(
            f"{where}: the column {name!r} has no unit; expected one such as {column.example!r}, got {came}; add it"
        )
    if not _UNIT.fullmatch(unit):
        raise InputError(f"{where}: {name}: unknown unit {show(unit)}; expected a column such as {column.example!r}")
    given = _SUFFIXES.get(unit, unit) if cell and cell["suffix"] else unit
    errors = []
    for si in column.units:
        try:
            return found[0], si, factor(given, si)
        except InputError as error:
            errors.append(error)
    raise InputError(f"{where}: {name}: {errors[0]}; expected a column such as {column.example!r}") from errors[0]


def _number(text: str, where: str) -> float:
    text = text.strip()
    if _NUMBER.fullmatch(text):
        return float(text)
    if _NOT_FINITE.fullmatch(text):
        raise InputError(
            f"{where}: expected a finite number, got {show(text)}; leave the row out if the sample was lost"
        )
    raise InputError(f"{where}: expected a number such as '0.25', got {show(text)}; correct it or leave the row out")
