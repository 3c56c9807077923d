"""Records from CSV and Parquet files."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from forcefeel.errors import InputError
from forcefeel.inputs.columns import Column, Columns, fault, find_columns, read_csv
from forcefeel.qualification.records import Record
from forcefeel.units import show

_COLUMNS = (
    Column("time", ("s",)),
    Column("position", ("rad", "m")),
    Column("force", ("N",), optional=True),
    Column("surface", ("rad",), optional=True),
    Column("body rate", ("rad/s",), optional=True),
)
_EXAMPLE = "time (s),position (deg),force (lb)"


def read_record(path: str | Path, *, name: str | None = None) -> Record:
    """Reads a record from a CSV or a Parquet file, by the ending of its name.

    The columns are ``time`` and ``position``, and where they were recorded ``force``, ``surface`` and ``body rate``, each with its
    unit: ``time (s)``, ``position [deg]``, ``force_n``. Others may stand beside them and are not read.

    Args:
        path: A file that ends in ``.csv`` or ``.parquet``.
        name: What messages name; the file's name without its ending if left out.

    Raises:
        InputError: With the file, the line or row and the time, what is wrong, what was expected and the remedy.
    """
    path = Path(path)
    readers = {".csv": _csv, ".parquet": _parquet}
    if path.suffix.lower() not in readers:
        raise InputError(f"{path}: expected a file that ends in .csv or .parquet, got {show(path.name)}")
    read = readers[path.suffix.lower()](path)
    if found := fault(read.values, read.units):
        row_at_fault, sentence = found
        raise InputError(f"{read.places[row_at_fault]}: {sentence}")
    return Record(
        read.values["time"],
        read.values["position"],
        read.values.get("force"),
        read.values.get("surface"),
        read.values.get("body rate"),
        position_unit="m" if read.units["position"] == "m" else "rad",
        name=name or path.stem,
    )


def _csv(path: Path) -> Columns:
    return read_csv(path, _COLUMNS, _EXAMPLE)


def _parquet(path: Path) -> Columns:
    try:
        import pyarrow as pa  # noqa: PLC0415  large, and only here
        from pyarrow import parquet  # noqa: PLC0415
    except ImportError as error:
        remedy = "install forcefeel[parquet], or give a CSV file"
        raise InputError(f"{path}: Parquet files need pyarrow, which is not installed; {remedy}") from error
    try:
        file = parquet.ParquetFile(path)
        header: Sequence[str] = [str(name) for name in file.schema_arrow.names]
        found = find_columns(header, _COLUMNS, f"{path}: schema", _EXAMPLE)
        table = file.read(columns=[header[i] for i, _, _ in found.values()])
    except (OSError, pa.ArrowException) as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise InputError(f"{path}: cannot be read as Parquet ({reason})") from error
    values = {name: _numbers(path, name, table[header[i]]) * scale for name, (i, _, scale) in found.items()}
    places = [f"{path}: row {row}" for row in range(table.num_rows + 1)]
    return Columns(values, {name: unit for name, (_, unit, _) in found.items()}, places)


def _numbers(path: Path, name: str, column: object) -> NDArray[np.float64]:
    """A column as numbers; a sample that is missing is not a number."""
    try:
        return np.asarray(column, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(f"{path}: {name}: expected a column of numbers ({error})") from error
