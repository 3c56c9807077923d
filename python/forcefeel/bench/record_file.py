"""Records in time from a bench, from files."""

from collections.abc import Mapping
from pathlib import Path

from forcefeel.bench.channels import OUTPUTS, RECORDED
from forcefeel.bench.experiments import Experiment
from forcefeel.bench.live_record import check_live_columns
from forcefeel.bench.record_checks import check_record
from forcefeel.bench.records import HOLDS, BenchRecord, Hold
from forcefeel.bench.stated import drive_channel, stated, stated_experiment
from forcefeel.errors import InputError
from forcefeel.tables.between import ALL, Times, take_between
from forcefeel.tables.header import by_standard_name, locate, need
from forcefeel.tables.table import Table
from forcefeel.tables.table_file import open_table
from forcefeel.units import show

EXAMPLE = "time (s),test_signal (V),column_angle (deg)"
"""A good header."""


def read_bench_record(
    path: str | Path,
    *,
    experiment: Experiment | str | None = None,
    columns: Mapping[str, str] | None = None,
    units: Mapping[str, str] | None = None,
    hold: Hold | None = None,
    between_s: Times = ALL,
) -> BenchRecord:
    """Reads a record from a ``.csv``, ``.parquet`` or ``.mat`` file, or of a live run, ``.mcap``, by the ending of its name.

    The columns are ``time`` and channels with their units: ``column angle (deg)``, ``load_cell_force [lb]``, ``test_signal_v``; in
    a MATLAB file the variables, or the fields of a structure. Others may stand beside them and are not read. Lines that begin with
    ``#`` at the top of a CSV file, metadata of a Parquet file or text variables of a MATLAB file say what it is:
    ``experiment: servo-closed``, ``hold: staircase``. The record of a live run is of the whole loader under its law, while that
    drove, and of the pilot's force, unless it is said to be a release.

    Args:
        path: The file.
        experiment: Under which it was recorded, for a file that does not say so.
        columns: The file's own name of a channel or of ``time``: ``{"column_angle": "theta"}``.
        units: Units where the header has none, by channel or by the file's own name: ``{"theta": "deg"}``.
        hold: How the drive runs between samples, for a file that does not say so; straight if neither does.
        between_s: First and last time that is read, s; all if left out.

    Raises:
        InputError: With the file, the line or row, what is wrong, what was expected and the remedy.

    Example:
        >>> import forcefeel as ff
        >>> record = ff.bench.read_bench_record("examples/bench/sweep.csv")
        >>> sorted(record.channels)
        ['column_angle', 'pilot_force']
    """
    return record_of(open_table(path, EXAMPLE), experiment, columns or {}, units or {}, hold, between_s)


def record_of(
    table: Table,
    experiment: Experiment | str | None,
    columns: Mapping[str, str],
    units: Mapping[str, str],
    hold: str | None,
    between_s: Times = ALL,
) -> BenchRecord:
    """The record in a table that was opened; arguments as of ``read_bench_record``.

    Raises:
        InputError: As ``read_bench_record``.
    """
    accepted = {"time": ("s",), **{name: (unit,) for name, unit in RECORDED.items()}}
    columns = by_standard_name(str(table.path), "columns", columns, accepted)
    units = by_standard_name(str(table.path), "units", units, (*accepted, *columns.values()))
    under = stated_experiment(table, experiment)
    runs = stated(table, "hold", hold, "hold") or "straight"
    if runs not in HOLDS:
        raise InputError(f"{table.path}: hold: expected straight or staircase, got {show(runs)}")
    located = locate(table, accepted, units, columns)
    if table.run:
        check_live_columns(table, located, under)
    need(table, located, ("time", drive_channel(under) or "column_angle"), EXAMPLE)
    if not any(name in OUTPUTS for name in located):
        raise InputError(
            f"{table.where}: has nothing that was measured; expected one at least of {', '.join(OUTPUTS)}; the file's own name of "
            f"one is given by the argument columns; got {show(','.join(table.header))}"
        )
    read = take_between(table, located, between_s)
    channels = {name: values for name, values in read.values.items() if name != "time"}
    for values in read.values.values():
        values.setflags(write=False)
    record = BenchRecord(table.path.stem, under, read.values["time"], channels, HOLDS[runs], table.data_hash, table.run)
    check_record(record, read.places, read.own_units)
    return record
