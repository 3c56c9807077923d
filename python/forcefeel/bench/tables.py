"""Tables of bench data: CSV, Parquet and MATLAB files, read the same way."""

import hashlib
import io
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from forcefeel.errors import InputError
from forcefeel.inputs.columns import Columns, csv_columns, csv_header, csv_rows, decode, read_bytes
from forcefeel.units import show

Found = Mapping[str, tuple[int, str, float]]
"""Which column of a header each is, its SI unit and the SI value of one of its units."""

NOTES = ("experiment", "from", "to", "hold")
"""What a file can say of itself."""

_TIMES = {"M": "dates", "m": "durations"}
"""Kinds of NumPy's types that are no numbers, and turn into some all the same."""
_NOTE = re.compile(r"#\s*(?P<key>[A-Za-z]+)\s*:\s*(?P<said>.*?)\s*")


@dataclass(frozen=True, eq=False)
class Table:
    """A file of columns whose header has been read, and not yet its numbers.

    Attributes:
        path: The file.
        header: The columns as the file names them.
        where: Where the header stands, for messages.
        notes: What the file says of itself, by one of ``NOTES``.
        data_hash: SHA-256 of the file, in hexadecimal.
        take: Reads the numbers of columns that were found, in SI units.
    """

    path: Path
    header: list[str]
    where: str
    notes: Mapping[str, str]
    data_hash: str
    take: Callable[[Found], Columns]


def open_table(path: str | Path, example: str) -> Table:
    """The header and the notes of a ``.csv``, ``.parquet`` or ``.mat`` file, by the ending of its name.

    Args:
        path: The file.
        example: A good CSV header, for messages.

    Raises:
        InputError: If the file cannot be read or is no table.
    """
    path = Path(path)
    readers = {".csv": _csv, ".parquet": _parquet, ".mat": _mat}
    if path.suffix.lower() not in readers:
        raise InputError(f"{path}: expected a file that ends in .csv, .parquet or .mat, got {show(path.name)}")
    return readers[path.suffix.lower()](path, read_bytes(path, example), example)


def _csv(path: Path, data: bytes, example: str) -> Table:
    lines = decode(path, data).splitlines(keepends=True)
    notes: dict[str, str] = {}
    for i, line in enumerate(lines):
        if line.strip() and not line.lstrip().startswith("#"):
            _check_commas(f"{path}: line {i + 1}", line.strip())
            break
        if (said := _NOTE.fullmatch(line.strip())) and said["key"].lower() in NOTES:
            key = said["key"].lower()
            if notes.setdefault(key, said["said"]) != said["said"]:
                came = f"{show(notes[key])} and {show(said['said'])}"
                raise InputError(f"{path}: line {i + 1}: {key} is stated twice, {came}; leave one of them")
        lines[i] = "\n"  # an empty line is skipped, and the others keep their numbers
    rows = csv_rows(path, "".join(lines), example)
    header, line_number = csv_header(path, rows, example)

    def take(found: Found) -> Columns:
        return csv_columns(path, rows, header, line_number, found)

    return Table(path, header, f"{path}: line {line_number}", notes, _hash(data), take)


def _check_commas(where: str, header: str) -> None:
    """Refuses a header that is parted by something else, as some programs write it where the comma is the decimal point."""
    for mark, words in ((";", "semicolons"), ("\t", "tabs")):
        if mark in header and "," not in header:
            raise InputError(f"{where}: is parted by {words}; use commas, and points in numbers")


def _parquet(path: Path, data: bytes, example: str) -> Table:
    try:
        import pyarrow as pa  # noqa: PLC0415  large, and only here
        from pyarrow import parquet  # noqa: PLC0415
    except ImportError as error:
        remedy = "install forcefeel[parquet], or give a CSV file"
        raise InputError(f"{path}: Parquet files need pyarrow, which is not installed; {remedy}") from error
    try:
        file = parquet.ParquetFile(io.BytesIO(data))
    except (OSError, pa.ArrowException) as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise InputError(f"{path}: cannot be read as Parquet ({reason}); expected columns as in {example!r}") from error
    header = [str(name) for name in file.schema_arrow.names]
    said = {key.decode(errors="replace").lower(): text for key, text in (file.schema_arrow.metadata or {}).items()}
    notes = {key: said[key].decode(errors="replace") for key in NOTES if key in said}

    def take(found: Found) -> Columns:
        try:
            table = file.read(columns=[header[i] for i, _, _ in found.values()])
        except (OSError, pa.ArrowException) as error:
            raise InputError(f"{path}: cannot be read as Parquet ({error})") from error
        return _columns(path, {name: table[header[i]] for name, (i, _, _) in found.items()}, found, "row")

    return Table(path, header, f"{path}: schema", notes, _hash(data), take)


def _mat(path: Path, data: bytes, example: str) -> Table:
    from scipy.io import loadmat  # noqa: PLC0415  half a second, and only here

    try:
        held = loadmat(io.BytesIO(data), simplify_cells=True)
    except NotImplementedError as error:
        raise InputError(
            f"{path}: is a MATLAB file of version 7.3; save it with -v7, as in save('{path.name}', '-v7')"
        ) from error
    except Exception as error:  # a damaged file makes the reader raise a dozen kinds
        raise InputError(f"{path}: cannot be read as a MATLAB file ({error}); save it again with -v7") from error
    named = [(name, value) for name, value in held.items() if not name.startswith("__")]
    # A structure's fields stand for themselves.
    flat = [it for name, value in named for it in (value.items() if isinstance(value, dict) else [(name, value)])]
    notes: dict[str, str] = {}
    for name, value in flat:
        if name in NOTES and isinstance(value, str) and notes.setdefault(name, value) != value:
            raise InputError(f"{path}: {name} is stated twice, {show(notes[name])} and {show(value)}; leave one")
    columns = [(name, value) for name, value in flat if isinstance(value, np.ndarray) and value.size > 1]
    if not columns:
        raise InputError(f"{path}: holds no rows of numbers; expected variables such as time_s and column_angle_deg")

    def take(found: Found) -> Columns:
        return _columns(path, {name: columns[i][1] for name, (i, _, _) in found.items()}, found, "sample")

    return Table(path, [name for name, _ in columns], f"{path}: variables", notes, _hash(data), take)


def _columns(path: Path, given: Mapping[str, Any], found: Found, row: str) -> Columns:
    """Columns of one length in SI units; rows are counted from 1."""
    values = {name: _numbers(path, name, given[name]) * scale for name, (_, _, scale) in found.items()}
    lengths = {name: len(column) for name, column in values.items()}
    if len(set(lengths.values())) > 1:
        came = ", ".join(f"{length} of {name}" for name, length in lengths.items())
        raise InputError(f"{path}: expected as many values of each column, got {came}; record them together")
    places = [f"{path}: {row} {i}" for i in range(max(lengths.values(), default=0) + 1)]
    return Columns(values, {name: unit for name, (_, unit, _) in found.items()}, places)


def _numbers(path: Path, name: str, given: Any) -> NDArray[np.float64]:
    """A column as numbers; a sample that is missing is not a number."""
    if np.iscomplexobj(given):
        raise InputError(f"{path}: {name}: expected real numbers, got complex ones; give gain and phase")
    if (dtype := np.asarray(given).dtype).kind in _TIMES:  # they would be taken as counts of their unit
        raise InputError(
            f"{path}: {name}: expected a column of numbers, got {_TIMES[dtype.kind]} ({dtype}); write numbers, and as time the "
            "seconds since the first sample"
        )
    try:
        values = np.squeeze(np.asarray(given, dtype=np.float64))
    except (TypeError, ValueError) as error:
        raise InputError(f"{path}: {name}: expected a column of numbers ({error})") from error
    if values.ndim != 1:
        raise InputError(f"{path}: {name}: expected one row or column of numbers, got shape {values.shape}")
    return values


def _hash(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()
