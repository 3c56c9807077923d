"""Tables from Parquet files; their notes stand in the metadata of the schema."""

import hashlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from forcefeel.errors import InputError, named_extra
from forcefeel.tables.table import NOTES, Columns, LocatedColumns, Table, check_size, columns_of


def read_parquet(path: Path, data: bytes, example: str) -> Table:
    """The table in a Parquet file.

    Raises:
        InputError: If it is damaged.
        MissingExtraError: If pyarrow is not installed.
    """
    with named_extra():
        import pyarrow as pa  # noqa: PLC0415  large, and only here
        from pyarrow import parquet  # noqa: PLC0415

    @contextmanager
    def refused() -> Iterator[None]:
        try:
            yield
        except InputError:
            raise
        # A damaged name is a UnicodeDecodeError, which is a ValueError, and a damaged schema lacks the columns that it names.
        except (OSError, ValueError, KeyError, pa.ArrowException) as error:
            reason = str(error).splitlines()[0] if str(error) else type(error).__name__
            expected = f"expected columns as in {example!r}"
            raise InputError(
                f"{path}: cannot be read as Parquet ({reason}); {expected}; write the file again"
            ) from error

    with refused():
        file = parquet.ParquetFile(pa.BufferReader(data))
        check_size(str(path), file.metadata.num_columns, file.metadata.num_rows)
        header = [str(name) for name in file.schema_arrow.names]
        metadata = {
            key.decode(errors="replace").lower(): text for key, text in (file.schema_arrow.metadata or {}).items()
        }
    notes = {key: metadata[key].decode(errors="replace") for key in NOTES if key in metadata}

    def take(located: LocatedColumns) -> Columns:
        with refused():
            table = file.read(columns=[header[i] for i, *_ in located.values()])
            arrays = {name: table[header[i]] for name, (i, *_) in located.items()}
        return columns_of(path, arrays, located, "row")

    return Table(path, header, f"{path}: schema", notes, hashlib.sha256(data).hexdigest(), take)
