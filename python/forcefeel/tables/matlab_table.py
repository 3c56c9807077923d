"""Tables from MATLAB files: variables of one length are the columns, lines of text the notes."""

import hashlib
from pathlib import Path

from forcefeel.errors import InputError
from forcefeel.tables.matlab_file import DamagedError, NewerFormatError, read_variables
from forcefeel.tables.table import NOTES, Columns, LocatedColumns, Table, columns_of
from forcefeel.units import show


def read_matlab(path: Path, data: bytes, example: str) -> Table:
    """The table in a MATLAB file up to version 7.

    Raises:
        InputError: If it is damaged, of version 7.3, or has no rows of numbers.
    """
    try:
        variables = read_variables(data)
    except NewerFormatError as error:
        remedy = f"save it with -v7, as in save('{path.name}', '-v7')"
        raise InputError(f"{path}: is a MATLAB file of version 7.3; {remedy}") from error
    except DamagedError as error:
        raise InputError(f"{path}: cannot be read as a MATLAB file ({error}); save it again with -v7") from error
    notes: dict[str, str] = {}
    for name, value in variables:
        if name in NOTES and isinstance(value, str) and notes.setdefault(name, value) != value:
            raise InputError(f"{path}: {name} is stated twice, {show(notes[name])} and {show(value)}; leave one")
    columns = [(name, value) for name, value in variables if not isinstance(value, str) and value.size > 1]
    if not columns:
        raise InputError(f"{path}: holds no rows of numbers; expected variables as in {example!r}, such as time_s")

    def take(located: LocatedColumns) -> Columns:
        return columns_of(path, {name: columns[i][1] for name, (i, *_) in located.items()}, located, "sample")

    return Table(
        path, [name for name, _ in columns], f"{path}: variables", notes, hashlib.sha256(data).hexdigest(), take
    )
