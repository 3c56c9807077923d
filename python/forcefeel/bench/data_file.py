"""Bench data of either kind from a file."""

from collections.abc import Mapping
from pathlib import Path

from forcefeel.bench import record_file, response_file
from forcefeel.bench.experiments import Experiment
from forcefeel.bench.records import BenchRecord, Hold
from forcefeel.bench.responses import Response
from forcefeel.errors import InputError, expect
from forcefeel.tables.between import ALL, Times
from forcefeel.tables.header import columns_called
from forcefeel.tables.table_file import open_table
from forcefeel.units import show


def read_bench_data(  # noqa: PLR0913  what options say of a file
    path: str | Path,
    *,
    experiment: Experiment | str | None = None,
    input: str | None = None,  # noqa: A002  the word for it
    output: str | None = None,
    columns: Mapping[str, str] | None = None,
    units: Mapping[str, str] | None = None,
    hold: Hold | None = None,
    between_s: Times = ALL,
) -> Response | BenchRecord:
    """Read a frequency response or a record: a response has a column ``frequency``, a record a column ``time``.

    Arguments are those of ``read_response`` and ``read_bench_record``. With a response ``hold`` and ``between_s`` are
    refused, with a record ``input`` and ``output``.

    Raises:
        InputError: As these two, and if the file has neither column or both.

    Example:
        >>> data = ff.read_bench_data("examples/bench/servo-closed.csv")
        >>> data.input, data.output
        ('test_signal', 'column_angle')
    """
    expect("path", path, (str, Path), "the path of a file with a frequency response or a record")
    for argument, texts in (("columns", columns), ("units", units)):
        expect(argument, texts or {}, Mapping, "texts by channel")
    table = open_table(path, response_file.EXAMPLE)
    own = columns or {}
    is_response, is_record = (bool(columns_called(table, own.get(name, name))) for name in ("frequency", "time"))
    if is_response == is_record:
        has = "both a column 'frequency' and one 'time'" if is_record else "neither a column 'frequency' nor 'time'"
        raise InputError(
            f"{table.where}: has {has}; expected "
            f"{response_file.EXAMPLE!r} or {record_file.EXAMPLE!r}, got {show(','.join(table.header))}"
        )
    cut = between_s if between_s != ALL else None
    strangers = {"hold": hold, "between_s": cut} if is_response else {"input": input, "output": output}
    if stray := [name for name, value in strangers.items() if value]:
        kind = "frequency response" if is_response else "record in time"
        raise InputError(f"{table.path}: is a {kind}, to which the argument {stray[0]} does not apply; leave it out")
    if is_response:
        return response_file.response_of(table, experiment, (input, output), own, units or {})
    return record_file.record_of(table, experiment, own, units or {}, hold, between_s)
