"""A table from a file, by the ending of its name."""

from pathlib import Path

from forcefeel.errors import InputError
from forcefeel.files import read_input
from forcefeel.tables.csv_table import read_csv
from forcefeel.tables.matlab_table import read_matlab
from forcefeel.tables.mcap_table import RECORD, read_mcap, record_of_axis
from forcefeel.tables.parquet_table import read_parquet
from forcefeel.tables.table import MOST_BYTES, Table
from forcefeel.units import show

_READERS = {".csv": read_csv, ".parquet": read_parquet, ".mat": read_matlab, RECORD: read_mcap}
"""Reader by ending, of the path and the contents of a file, and of a good CSV header; path and header are for messages."""

ENDINGS = tuple(_READERS)
"""Endings of readable files."""


def open_table(path: str | Path, example: str) -> Table:
    """The header and the notes of a ``.csv``, ``.parquet`` or ``.mat`` file, or of a live run's record, ``.mcap``.

    Args:
        path: The file; of a cockpit's record with an axis behind it, ``run.mcap/pitch``.
        example: A good CSV header, for messages.

    Raises:
        InputError: If the file cannot be read, is too large, or is no table.
    """
    path = Path(path)
    file = record_of_axis(path)[0]
    if (read := _READERS.get(file.suffix.lower())) is None:
        *others, last = ENDINGS
        raise InputError(f"{path}: expected a file that ends in {', '.join(others)} or {last}, got {show(path.name)}")
    return read(path, read_input(file, MOST_BYTES, f"a table with columns such as {example!r}"), example)
