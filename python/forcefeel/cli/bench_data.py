"""Files of bench data and what the options say of each: for one file by its stem, or for all."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Group

from forcefeel.cli.options import option
from forcefeel.errors import InputError
from forcefeel.tables.column_names import ColumnNames, by_stem
from forcefeel.units import show

if TYPE_CHECKING:
    from forcefeel.bench.records import BenchRecord, Hold
    from forcefeel.bench.responses import Response

DATA = Group("Bench data", sort_key=10)

_OPTIONS = {
    "experiment": "--experiment",
    "input": "--input-channel",
    "output": "--output-channel",
    "between_s": "--from and --until",
    "columns": "--column",
    "units": "--unit",
    "hold": "--hold",
}
"""Which option gives which argument of a reader of files."""
_ARGUMENT = re.compile(rf"\bthe argument ({'|'.join(_OPTIONS)})\b")


@dataclass(frozen=True, kw_only=True)
class BenchOptions:
    """What the options tell of files of bench data: for one file by its stem, or for all."""

    experiment: Annotated[
        tuple[str, ...],
        option(
            "Experiment of a file that does not name its own: servo-open, servo-closed or loader with its drive "
            "(test_signal, command_signal, pilot_force, release), or release, or sweep. Motors: motor-open, or loader "
            "with test_current, command_current or pilot_force. STEM= limits this to one file, named without its ending. "
            "Repeatable.",
            DATA,
            metavar="[STEM=]EXPERIMENT",
        ),
    ] = ()
    input_channel: Annotated[
        tuple[str, ...],
        option("Input channel of a response, such as 'test_signal (V)'.", DATA, metavar="[STEM=]CHANNEL"),
    ] = ()
    output_channel: Annotated[
        tuple[str, ...],
        option("Output channel of a response, such as 'column_angle (deg)'.", DATA, metavar="[STEM=]CHANNEL"),
    ] = ()
    times_from: Annotated[
        tuple[str, ...],
        option(
            "Start of the part of a record to read, in its own time, such as '6 s'. Repeatable.",
            DATA,
            "--from",
            default="start of the record",
            metavar="[STEM=]TIME",
        ),
    ] = ()
    times_until: Annotated[
        tuple[str, ...],
        option(
            "End of the part of a record to read.", DATA, "--until", default="end of the record", metavar="[STEM=]TIME"
        ),
    ] = ()
    column: Annotated[
        tuple[str, ...],
        option(
            "Column of a file for a channel, such as 'column_angle=theta'. Repeatable.",
            DATA,
            metavar="[STEM:]CHANNEL=NAME",
        ),
    ] = ()
    unit: Annotated[
        tuple[str, ...],
        option(
            "Unit of a column without one in its header, such as 'theta=deg'. Repeatable.",
            DATA,
            metavar="[STEM:]NAME=UNIT",
        ),
    ] = ()
    hold: Annotated[
        tuple[str, ...],
        option(
            "Drive of a record between two samples: straight lines or a staircase.",
            DATA,
            metavar="[STEM=]straight|staircase",
        ),
    ] = ()

    def read(self, files: tuple[Path, ...]) -> list["Response | BenchRecord"]:
        """Reads all files, in the order given.

        Raises:
            InputError: If an option is bad or a file is.
        """
        from forcefeel.bench.data_file import read_bench_data
        from forcefeel.tables.between import ALL, times_by_stem

        stems = _stems(files)
        experiment, source, target = (
            by_stem(option, given, stems)
            for option, given in (
                ("--experiment", self.experiment),
                ("--input-channel", self.input_channel),
                ("--output-channel", self.output_channel),
            )
        )
        hold = {stem: _hold(text) for stem, text in by_stem("--hold", self.hold, stems).items()}
        names, times = (
            ColumnNames.of(self.column, self.unit, stems),
            times_by_stem(self.times_from, self.times_until, stems),
        )
        with options_named():
            return [
                read_bench_data(
                    path,
                    experiment=experiment.get(path.stem),
                    input=source.get(path.stem),
                    output=target.get(path.stem),
                    hold=hold.get(path.stem),
                    between_s=times.get(path.stem, ALL),
                    **names.arguments(path.stem),
                )
                for path in files
            ]


def _stems(files: tuple[Path, ...]) -> list[str]:
    stems: dict[str, Path] = {}
    for path in files:
        if path.stem in stems:
            raise InputError(
                f"--data: {path} and {stems[path.stem]} are both called {show(path.stem)}; give each file once, rename one"
            )
        stems[path.stem] = path
    return list(stems)


@contextmanager
def options_named() -> Iterator[None]:
    """Names the option where a message names the argument."""
    try:
        yield
    except InputError as error:
        raise InputError(_ARGUMENT.sub(lambda match: _OPTIONS[match[1]], str(error))) from error


def _hold(text: str) -> "Hold":
    from forcefeel.bench.records import HOLDS

    if text not in HOLDS:
        raise InputError(f"--hold: expected {' or '.join(HOLDS)}, got {show(text)}")
    return HOLDS[text]
