"""Records of a control from files."""

from collections.abc import Mapping
from pathlib import Path

from forcefeel.qualification.force_points import ForcePoints, read_force_points
from forcefeel.qualification.records import Record
from forcefeel.tables.between import ALL, Times
from forcefeel.tables.faults import check_step
from forcefeel.tables.header import heading
from forcefeel.tables.signals import Signals
from forcefeel.tables.table_file import open_table

_SIGNALS = Signals(
    {"time": ("s",), "position": ("rad", "m"), "force": ("N",), "surface": ("rad",), "body_rate": ("rad/s",)},
    needed=("time", "position"),
    example="time (s),position (deg),force (lb)",
    also={"column_angle": "position", "pilot_force": "force"},  # names in bench records
    cuts=True,
)
_LONGEST_STEP_S = 1.0
"""Longest median step: a sweep of 100 s still covers a curve of 401 positions."""


def read_record(
    path: str | Path,
    *,
    name: str | None = None,
    columns: Mapping[str, str] | None = None,
    units: Mapping[str, str] | None = None,
    between_s: Times = ALL,
) -> Record:
    r"""Reads a record from a ``.csv``, ``.parquet`` or ``.mat`` file, or from the ``.mcap`` file of a live run.

    Required columns are ``time`` and ``position`` or ``column angle``; optional ones are ``force`` or ``pilot force``,
    ``surface`` and ``body rate``. Each has its unit: ``time (s)``, ``position [deg]``, ``force_n``. Other columns are ignored.

    Args:
        path: The file.
        name: Name for messages. Default: the file's name without suffix.
        columns: The file's own column names: ``{"position": "theta"}``.
        units: Units of columns without a unit in the header, by either name: ``{"theta": "deg"}``.
        between_s: First and last time to read, s. Default: all.

    Raises:
        InputError: With the file, the line or row, the time, the fault, the expected value and the remedy.

    Example:
        >>> rows = "".join(f"{k / 100},{0.2 if k < 50 else 0.0}\n" for k in range(100))
        >>> size = Path("record.csv").write_text("time (s),position (rad)\n" + rows)
        >>> len(ff.qualification.read_record("record.csv").time_s)
        100
    """
    table = open_table(path, _SIGNALS.example)
    read = _SIGNALS.read(table, columns, units, between_s)
    check_step(read.values["time"], str(table.path), _LONGEST_STEP_S)
    return Record(
        read.values["time"],
        read.values["position"],
        read.values.get("force"),
        read.values.get("surface"),
        read.values.get("body_rate"),
        position_unit="m" if read.units["position"] == "m" else "rad",
        shown_unit=read.own_units["position"],
        name=name or table.path.stem,
        data_hash=table.data_hash,
    )


def read_reference(
    path: str | Path,
    *,
    columns: Mapping[str, str] | None = None,
    units: Mapping[str, str] | None = None,
    between_s: Times = ALL,
    conditions: tuple[str, ...] = (),
) -> Record | ForcePoints:
    """A record as of ``read_record``; points of force over position from a file without a time.

    Raises:
        InputError: As ``read_record`` and ``read_force_points``, and if there are several flight conditions.
    """
    cells = {heading(cell, _SIGNALS.accepted).name for cell in open_table(path, _SIGNALS.example).header}
    if "time" in cells or "time" in (columns or {}) or not cells & {"force", "pilot_force", *_own_force(columns)}:
        return read_record(path, columns=columns, units=units, between_s=between_s)
    return read_force_points(path, columns=columns, units=units).of_condition(conditions)


def _own_force(columns: Mapping[str, str] | None) -> set[str]:
    """The file's own names of the force."""
    return {"_".join(name.lower().split()) for key, name in (columns or {}).items() if key in {"force", "pilot_force"}}
