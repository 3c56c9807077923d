"""Tables from records of live runs, MCAP files."""

import hashlib
from pathlib import Path

import numpy as np

from forcefeel import _core
from forcefeel.errors import InputError
from forcefeel.tables.table import Columns, Found, Table, check_size, columns_of


def read_mcap(path: Path, data: bytes, example: str) -> Table:
    """The table in a record of a live run; columns without a number, such as a pilot's force that nothing measured, are left out.

    Args:
        path: Where it was, for messages.
        data: What is in it.
        example: A good CSV header, for messages.

    Raises:
        InputError: If it is no such record.
    """
    try:
        _, columns, rows, _, _ = _core.live_record(data)
    except _core.ArgumentError as error:
        raise InputError(
            f"{path}: {error}; expected a record of forcefeel run; export what else is in MCAP files as a table with columns "
            f"such as {example!r}"
        ) from error
    check_size(str(path), len(columns), len(rows))
    given = {name: rows[:, k] for k, name in enumerate(columns) if not np.isnan(rows[:, k]).all()}
    header = list(given)

    def take(found: Found) -> Columns:
        return columns_of(path, {name: given[header[one.place]] for name, one in found.items()}, found, "row")

    return Table(path, header, f"{path}: topic /cycle", {}, hashlib.sha256(data).hexdigest(), take)
