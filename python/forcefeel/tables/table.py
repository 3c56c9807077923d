"""A table in a file: header, notes, and the numbers of requested columns."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple, overload

import numpy as np
from numpy.typing import NDArray

from forcefeel.errors import InputError


class Located(NamedTuple):
    """A located column: position, SI unit, SI value of one unit of the file, and that unit."""

    position: int
    si: str
    scale: float
    unit: str


LocatedColumns = Mapping[str, Located]
"""Located columns by standard name."""

NOTES = ("experiment", "from", "to", "hold", "law")
"""Keys of the notes of a file."""

MOST_BYTES = 2**30
"""Largest file of data, and record of a live run."""
MOST_COLUMNS = 10_000
MOST_ROWS = 10_000_000
"""Rows of a table: 2.7 hours at 1 kHz."""

_TIMES = {"M": "dates", "m": "durations"}
"""NumPy kinds that convert to numbers but are not numbers."""


@dataclass(frozen=True)
class Places(Sequence[str]):
    """Location of each row of a table, for messages; the header's is the first.

    Attributes:
        before: Text before the number of a row.
        numbers: Line or row of each.
    """

    before: str
    numbers: Sequence[int]

    def __len__(self) -> int:
        return len(self.numbers)

    @overload
    def __getitem__(self, at: int) -> str: ...
    @overload
    def __getitem__(self, at: slice) -> "Places": ...
    def __getitem__(self, at: int | slice) -> "str | Places":
        if isinstance(at, slice):
            return Places(self.before, self.numbers[at])
        return f"{self.before} {self.numbers[at]}"


@dataclass(frozen=True, eq=False)
class Columns:
    """Columns read: values in SI units by name, their SI units, location of the rows, and their units in the file."""

    values: dict[str, NDArray[np.float64]]
    units: dict[str, str]
    places: Sequence[str]
    own_units: dict[str, str]

    @classmethod
    def read(cls, values: dict[str, NDArray[np.float64]], located: LocatedColumns, places: Sequence[str]) -> "Columns":
        """Columns with the units of their location."""
        return cls(
            values,
            {name: column.si for name, column in located.items()},
            places,
            {name: column.unit for name, column in located.items()},
        )


@dataclass(frozen=True, eq=False)
class Table:
    """A file of columns after reading its header only.

    Attributes:
        path: The file.
        header: Column names of the file.
        where: Location of the header, for messages.
        notes: Notes of the file, by one of ``NOTES``.
        data_hash: SHA-256 of the file, in hexadecimal.
        take: Reads the numbers of located columns, in SI units.
        run: Properties of a live record, such as its law; empty for other files.
        broken: Reason of a truncated file; empty if complete.
    """

    path: Path
    header: list[str]
    where: str
    notes: Mapping[str, str]
    data_hash: str
    take: Callable[[LocatedColumns], Columns]
    run: Mapping[str, str] = field(default_factory=dict)
    broken: str = ""


def check_size(where: str, columns: int, rows: int = 0) -> None:
    """Refuse a table of too many columns or rows.

    Raises:
        InputError: With the limit.
    """
    for count, limit, noun in ((columns, MOST_COLUMNS, "columns"), (rows, MOST_ROWS, "rows")):
        if count > limit:
            raise InputError(f"{where}: has more than {limit:,} {noun}; leave out what is not needed")


def columns_of(path: Path, arrays: Mapping[str, Any], located: LocatedColumns, row: str) -> Columns:
    """Columns of one length in SI units; rows are counted from 1.

    Raises:
        InputError: If one is not of numbers, has more dimensions than one, another length, or too many rows.
    """
    with np.errstate(all="ignore"):  # numbers that are not finite are reported with their row
        values = {name: _numbers(path, name, arrays[name]) * scale for name, (_, _, scale, _) in located.items()}
    lengths = {name: len(column) for name, column in values.items()}
    if len(set(lengths.values())) > 1:
        lengths_text = ", ".join(f"{length} of {name}" for name, length in lengths.items())
        raise InputError(f"{path}: expected as many values of each column, got {lengths_text}; record them together")
    rows = max(lengths.values(), default=0)
    check_size(str(path), len(located), rows)
    places = Places(f"{path}: {row}", range(rows + 1))
    return Columns.read(values, located, places)


def _numbers(path: Path, name: str, raw: Any) -> NDArray[np.float64]:
    """A column as numbers, not-a-number for missing samples."""
    try:
        column = np.asarray(raw)
        if np.iscomplexobj(column):
            raise InputError(f"{path}: {name}: expected real numbers, got complex ones; give gain and phase")
        if column.dtype.kind in _TIMES:  # they would be taken as counts of their unit
            raise InputError(
                f"{path}: {name}: expected a column of numbers, got {_TIMES[column.dtype.kind]} ({column.dtype}); write numbers, "
                "and as time the seconds since the first sample"
            )
        values = np.atleast_1d(np.squeeze(np.asarray(column, dtype=np.float64)))
    except InputError:
        raise
    except (TypeError, ValueError, OverflowError, NotImplementedError) as error:
        raise InputError(f"{path}: {name}: expected a column of numbers ({error})") from error
    if values.ndim != 1:
        raise InputError(f"{path}: {name}: expected one row or column of numbers, got shape {values.shape}")
    return values
