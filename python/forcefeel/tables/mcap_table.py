"""Tables from records of live runs, MCAP files."""

import hashlib
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel.errors import InputError
from forcefeel.tables.table import Columns, LocatedColumns, Table, check_size, columns_of

RECORD = ".mcap"
"""Ending of a record."""

SIMULATED = "simulated"
"""Name of a simulated machine in a record."""

_ACTIVE = _core.live_states().index("active")
_PISTON = {"drive_position_m": "piston_position_m"}
"""Bench name of the end of a valve's drive."""


def record_of_axis(path: Path) -> tuple[Path, str | None]:
    """File and axis of ``run.mcap/pitch``; no axis of any other path."""
    return (path.parent, path.name) if path.parent.suffix.lower() == RECORD else (path, None)


def read_mcap(path: Path, data: bytes, example: str) -> Table:
    """The table in a live record: rows while the law drives, on the time of its machine.

    A simulated machine advances by a period per cycle, so missed periods do not count; for a real machine they do. Of a record with
    a rate the rows of that rate are read, not those around a trip. Columns without numbers, such as an unmeasured pilot's force,
    and those of an absent force sensor are omitted.

    Raises:
        InputError: If it is no such record, or the law drove in none of it.
    """
    try:
        about, columns, rows, _, broken, _ = _core.live_record(data, record_of_axis(path)[1])
    except _core.ArgumentError as error:
        raise InputError(
            f"{path}: {error}; expected a record of forcefeel run; export what else is in MCAP files as a table with columns "
            f"such as {example!r}"
        ) from error
    check_size(str(path), len(columns), len(rows))
    whole = dict(zip(columns, rows.T, strict=True))
    drives = _driven(path, whole, _stated(path, {"record_every": "1", **about}, "record_every"))
    filled = {name: values for name, values in whole.items() if not np.isnan(values).all()}
    if not filled["grip_force_n"].any():
        del filled["grip_force_n"]
    if about.get("machine") == SIMULATED:
        filled["time_s"] = whole["cycle"] * _stated(path, about, "period_s")
    renamed = _PISTON if about.get("drive") == "hydraulic" else {}
    header = [renamed.get(name, name) for name in filled]
    taken = list(filled.values())

    def take(located: LocatedColumns) -> Columns:
        return columns_of(
            path, {name: taken[column.position][drives] for name, column in located.items()}, located, "driven row"
        )

    where, data_hash = f"{path}: topic /cycle", hashlib.sha256(data).hexdigest()
    return Table(path, header, where, {}, data_hash, take, about, broken or "")


def _stated(path: Path, about: Mapping[str, str], name: str) -> float:
    """A number that the record states of its run.

    Raises:
        InputError: If it does not.
    """
    try:
        return float(about[name])
    except (KeyError, ValueError) as error:
        raise InputError(f"{path}: breaks off: what it states of its run is damaged, {name}; record it anew") from error


def _driven(path: Path, columns: dict[str, NDArray[np.float64]], every: float) -> NDArray[np.bool_]:
    """The rows at the record's rate in which the law drives.

    Raises:
        InputError: If the law drives in no row.
    """
    state = columns.get("state")
    if state is None or "grip_force_n" not in columns:
        raise InputError(f"{path}: was made by another version of forcefeel: its columns are others")
    drives: NDArray[np.bool_] = (state == _ACTIVE) & (columns["cycle"] % every == 0)
    if not drives.any():
        raise InputError(
            f"{path}: has {len(state):,} rows, and the law drives in none of them; expected a run that was switched on; record "
            "one that becomes active"
        )
    return drives
