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
    "input": "--from",
    "output": "--to",
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
            "Under which experiment a file was measured, if it does not tell itself: servo-open, servo-closed or loader, and what "
            "drives it (test_signal, command_signal, pilot_force, release), or release or sweep; of a motor motor-open or loader, "
            "driven by test_current, command_current or pilot_force. With STEM=, the file's name "
            "without its ending, for that file alone, as in the options below. May be given again.",
            DATA,
            metavar="[STEM=]EXPERIMENT",
        ),
    ] = ()
    from_: Annotated[
        tuple[str, ...],
        option(
            "Channel that a response leads from, such as 'test_signal (V)'.", DATA, "--from", metavar="[STEM=]CHANNEL"
        ),
    ] = ()
    to: Annotated[
        tuple[str, ...],
        option("Channel that a response leads to, such as 'column_angle (deg)'.", DATA, metavar="[STEM=]CHANNEL"),
    ] = ()
    column: Annotated[
        tuple[str, ...],
        option(
            "What a file calls a channel or another column, such as 'column_angle=theta'. May be given again.",
            DATA,
            metavar="[STEM:]CHANNEL=NAME",
        ),
    ] = ()
    unit: Annotated[
        tuple[str, ...],
        option(
            "Unit of a column whose header has none, such as 'theta=deg'. May be given again.",
            DATA,
            metavar="[STEM:]NAME=UNIT",
        ),
    ] = ()
    hold: Annotated[
        tuple[str, ...],
        option(
            "How the drive of a record runs between two samples: straight, or as a staircase.",
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

        stems = _stems(files)
        experiment, source, target = (
            by_stem(option, given, stems)
            for option, given in (("--experiment", self.experiment), ("--from", self.from_), ("--to", self.to))
        )
        hold = {stem: _hold(text) for stem, text in by_stem("--hold", self.hold, stems).items()}
        names = ColumnNames.of(self.column, self.unit, stems)
        with options_named():
            return [
                read_bench_data(
                    path,
                    experiment=experiment.get(path.stem),
                    input=source.get(path.stem),
                    output=target.get(path.stem),
                    hold=hold.get(path.stem),
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
        raise InputError(_ARGUMENT.sub(lambda found: _OPTIONS[found[1]], str(error))) from error


def _hold(text: str) -> "Hold":
    from forcefeel.bench.records import HOLDS

    if text not in HOLDS:
        raise InputError(f"--hold: expected {' or '.join(HOLDS)}, got {show(text)}")
    return HOLDS[text]
