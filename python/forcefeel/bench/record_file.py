"""Records in time from a bench, from files."""

from collections.abc import Mapping
from pathlib import Path

from forcefeel.bench.channels import OUTPUTS, RECORDED
from forcefeel.bench.experiments import Experiment, Loop
from forcefeel.bench.record_checks import check_record
from forcefeel.bench.records import HOLDS, BenchRecord, Hold
from forcefeel.bench.stated import drive_channel, stated, stated_experiment
from forcefeel.errors import InputError
from forcefeel.tables.between import ALL, Times, take_between
from forcefeel.tables.header import by_standard_name, locate, need
from forcefeel.tables.table import LocatedColumns, Table
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
    """Read a record from a ``.csv``, ``.parquet`` or ``.mat`` file, or the ``.mcap`` record of a live run.

    The columns are ``time`` and channels with their units: ``column angle (deg)``, ``load_cell_force [lb]``, ``test_signal_v``; in
    a MATLAB file the variables, or the fields of a structure. Other columns are not read. Lines that begin with ``#`` at the top
    of a CSV file, metadata of a Parquet file or text variables of a MATLAB file describe the record: ``experiment: servo-closed``,
    ``hold: staircase``, ``law: torque-mode``, under which the whole loader ran. The record of a live run is of the whole loader
    while its law drove it, under the pilot's force unless stated to be a release.

    Args:
        path: The file.
        experiment: The experiment, for a file that does not state it.
        columns: The file's own name of a channel or of ``time``: ``{"column_angle": "theta"}``.
        units: Units where the header has none, by channel or by the file's own name: ``{"theta": "deg"}``.
        hold: Course of the drive between samples, for a file that does not state it; default straight.
        between_s: First and last time to read, s; default all.

    Raises:
        InputError: With the file, the line or row, the fault, the expected value and the remedy.

    Example:
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
    """The record in an open table; arguments as of ``read_bench_record``.

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
            f"{table.where}: has no measured channel; expected at least one of {', '.join(OUTPUTS)}, got "
            f"{show(','.join(table.header))}; name the file's own columns by the argument columns"
        )
    read = take_between(table, located, between_s)
    channels = {name: values for name, values in read.values.items() if name != "time"}
    for values in read.values.values():
        values.setflags(write=False)
    law = table.notes.get("law")
    run = table.run or ({} if law is None else {"law": law})
    record = BenchRecord(table.path.stem, under, read.values["time"], channels, HOLDS[runs], table.data_hash, run)
    check_record(record, read.places, read.own_units)
    return record


def check_live_columns(table: Table, located: LocatedColumns, experiment: Experiment) -> None:
    """Refuse an experiment that a live record cannot be of.

    Raises:
        InputError: If the experiment moves the servo alone, or the drive was not recorded, with the remedy.
    """
    if experiment.loop is not Loop.LOADER:
        raise InputError(
            f"{table.path}: is the record of a live run, of the whole loader under its law, and the argument experiment is "
            f"{experiment}; expected 'loader pilot_force' or 'release'; leave it out"
        )
    drive = drive_channel(experiment)
    if drive is not None and drive not in located:
        raise InputError(
            f"{table.path}: has no {drive}: nothing measured it in this run, whose machine is {table.run.get('machine', 'real')}; "
            "hold the grip, let it go, and give that part as a release, by the argument experiment; or record the force at "
            "the grip on a bench"
        )
