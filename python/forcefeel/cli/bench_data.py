"""Files of bench data and what the options say of each: for one file by its stem, or for all."""

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from forcefeel.errors import InputError
from forcefeel.tables.column_names import ColumnNames, by_stem
from forcefeel.units import show

if TYPE_CHECKING:
    from forcefeel.bench.records import BenchRecord, Hold
    from forcefeel.bench.responses import Response

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


@dataclass(frozen=True)
class BenchData:
    """The options as given; ``None`` is not given.

    Attributes:
        files: Files of bench data.
        experiment, source, target, hold: ``[STEM=]TEXT``.
        column, unit: ``[STEM:]name=value``.
    """

    files: Sequence[Path]
    experiment: Sequence[str] | None
    source: Sequence[str] | None
    target: Sequence[str] | None
    column: Sequence[str] | None
    unit: Sequence[str] | None
    hold: Sequence[str] | None

    def read(self) -> list["Response | BenchRecord"]:
        """Reads all files, in the order given.

        Raises:
            InputError: If an option is bad or a file is.
        """
        from forcefeel.bench.data_file import read_bench_data  # noqa: PLC0415  SciPy

        stems = self._stems()
        experiment, source, target = (
            by_stem(option, given, stems)
            for option, given in (("--experiment", self.experiment), ("--from", self.source), ("--to", self.target))
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
                for path in self.files
            ]

    def _stems(self) -> list[str]:
        stems: dict[str, Path] = {}
        for path in self.files:
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
    from forcefeel.bench.records import HOLDS  # noqa: PLC0415  NumPy

    if text not in HOLDS:
        raise InputError(f"--hold: expected {' or '.join(HOLDS)}, got {show(text)}")
    return HOLDS[text]
