"""Tables from CSV files in UTF-8, read row by row; only requested columns are kept. The text of those that are written."""

import csv
import hashlib
import io
import re
from array import array
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from forcefeel.errors import InputError
from forcefeel.tables.table import MOST_ROWS, NOTES, Columns, LocatedColumns, Places, Table, check_size
from forcefeel.units import show

_NUMBER = re.compile(r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
_NOT_FINITE = re.compile(r"[+-]?(?:nan|inf|infinity)", re.IGNORECASE)


def read_csv(path: Path, data: bytes, example: str) -> Table:
    """The table in a CSV file; lines that begin with ``#`` above the header are its notes.

    Raises:
        InputError: If it is no text, is empty, or is not separated by commas.
    """
    notes: dict[str, str] = {}
    header, line = next(_rows(path, data, example, notes), ([], 1))
    if not header:
        raise InputError(f"{path}: line 1: is empty; expected a header such as {example!r} and rows of numbers")
    check_size(f"{path}: line {line}", len(header))

    def take(located: LocatedColumns) -> Columns:
        return _columns(path, _rows(path, data, example, {}), located)

    cells = [" ".join(cell.split()) for cell in header]
    return Table(path, cells, f"{path}: line {line}", notes, hashlib.sha256(data).hexdigest(), take)


def csv_text(heads: Iterable[str], rows: Iterable[Iterable[object]], digits: str = "") -> str:
    """Rows below their heads as CSV; floats in the format ``digits``, without one exactly."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(heads)
    writer.writerows([format(cell, digits) if isinstance(cell, float) else cell for cell in row] for row in rows)
    return text.getvalue()


def csv_rows(path: Path, lines: Iterable[str], example: str) -> Iterator[tuple[list[str], int]]:
    """The rows that are not empty, each with its last line.

    Raises:
        InputError: If the text is no CSV.
    """
    reader = csv.reader(lines, strict=True)
    try:
        yield from ((row, reader.line_num) for row in reader if row)
    except csv.Error as error:
        line = max(reader.line_num, 1)
        raise InputError(f"{path}: line {line}: is not CSV ({error}); expected rows as under {example!r}") from error


def text_lines(path: Path, data: bytes) -> Iterator[str]:
    """The lines of a text, without a byte order mark.

    Raises:
        InputError: If it is not UTF-8.
    """
    try:
        yield from io.TextIOWrapper(io.BytesIO(data), encoding="utf-8-sig")
    except UnicodeDecodeError:  # whose place is that in a part of the text
        try:
            data.decode("utf-8-sig")
        except UnicodeDecodeError as error:
            line = data.count(b"\n", 0, error.start) + 1
            raise InputError(
                f"{path}: line {line}: is not UTF-8 text (byte {error.start}); save the file as UTF-8"
            ) from error


def _rows(path: Path, data: bytes, example: str, notes: dict[str, str]) -> Iterator[tuple[list[str], int]]:
    return csv_rows(path, _without_notes(path, text_lines(path, data), notes), example)


def _without_notes(path: Path, lines: Iterator[str], notes: dict[str, str]) -> Iterator[str]:
    """The lines, with notes above the header emptied, so that line numbers stay."""
    for number, line in enumerate(lines, start=1):
        bare = line.strip()
        if bare and not bare.startswith("#"):
            _check_commas(f"{path}: line {number}", bare)
            yield line
            break
        key, colon, value = (part.strip() for part in bare.removeprefix("#").partition(":"))
        if colon and key.lower() in NOTES and notes.setdefault(key.lower(), value) != value:
            both = f"{show(notes[key.lower()])} and {show(value)}"
            raise InputError(f"{path}: line {number}: {key.lower()} is stated twice, {both}; leave one of them")
        yield "\n"
    yield from lines


def _check_commas(where: str, header: str) -> None:
    """Refuse a header with another separator, as written where the comma is the decimal point."""
    for mark, words in ((";", "semicolons"), ("\t", "tabs")):
        if mark in header and "," not in header:
            raise InputError(f"{where}: is parted by {words}; use commas, and points in numbers")


def _columns(path: Path, rows: Iterator[tuple[list[str], int]], located: LocatedColumns) -> Columns:
    """The numbers of the located columns, from the rows below the header."""
    header, line = next(rows)
    numbers, lines = {name: array("d") for name in located}, array("q", [line])
    targets = [(name, i, scale, numbers[name].append) for name, (i, _, scale, _) in located.items()]
    is_number = _NUMBER.fullmatch
    for row, at in rows:
        if len(row) != len(header):
            raise InputError(
                f"{path}: line {at}: expected {len(header)} values as in the header, got {len(row)}; "
                "write numbers with a decimal point and part them with one comma"
            )
        for name, i, scale, append in targets:
            cell = row[i].strip()
            if not is_number(cell):
                raise _no_number(cell, f"{path}: line {at}: {name}")
            append(float(cell) * scale)
        lines.append(at)
        if len(lines) > MOST_ROWS:  # the header's place is one of them
            check_size(str(path), len(header), len(lines) - 1)
    values = {name: np.frombuffer(column) for name, column in numbers.items()}
    return Columns.read(values, located, Places(f"{path}: line", lines))


def _no_number(cell: str, where: str) -> InputError:
    if _NOT_FINITE.fullmatch(cell):
        return InputError(
            f"{where}: expected a finite number, got {show(cell)}; leave the row out if the sample was lost"
        )
    return InputError(f"{where}: expected a number such as '0.25', got {show(cell)}; correct it or leave the row out")
