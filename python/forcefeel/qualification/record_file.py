"""Records of a control from files."""

from collections.abc import Mapping
from pathlib import Path

from forcefeel.qualification.records import Record
from forcefeel.tables.between import ALL, Times
from forcefeel.tables.faults import check_step
from forcefeel.tables.signals import Signals
from forcefeel.tables.table_file import open_table

_SIGNALS = Signals(
    {"time": ("s",), "position": ("rad", "m"), "force": ("N",), "surface": ("rad",), "body_rate": ("rad/s",)},
    needed=("time", "position"),
    example="time (s),position (deg),force (lb)",
    also={"column_angle": "position", "pilot_force": "force"},  # as a bench calls them
    cuts=True,
)
_LONGEST_STEP_S = 1.0
"""Median step of a sweep of 100 s of which a curve can be laid through 401 positions."""


def read_record(
    path: str | Path,
    *,
    name: str | None = None,
    columns: Mapping[str, str] | None = None,
    units: Mapping[str, str] | None = None,
    between_s: Times = ALL,
) -> Record:
    r"""Reads a record from a ``.csv``, ``.parquet`` or ``.mat`` file, or of a live run, ``.mcap``, by the ending of its name.

    The columns are ``time`` and ``position`` or ``column angle``, and where they were recorded ``force`` or ``pilot force``,
    ``surface`` and ``body rate``, each with its unit: ``time (s)``, ``position [deg]``, ``force_n``. Others may stand beside them
    and are not read.

    Args:
        path: The file.
        name: What messages name; the file's name without its ending if left out.
        columns: The file's own names of these: ``{"position": "theta"}``.
        units: Units where the header has none, by these names or the file's own: ``{"theta": "deg"}``.
        between_s: First and last time that is read, s; all if left out.

    Raises:
        InputError: With the file, the line or row and the time, what is wrong, what was expected and the remedy.

    Example:
        >>> import forcefeel as ff
        >>> from pathlib import Path
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
