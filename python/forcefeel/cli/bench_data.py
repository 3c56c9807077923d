"""Files of bench data and what the options say of each: for one file by its stem, or for all."""

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from forcefeel.errors import InputError
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
"""Which option gives which argument of ``read_bench_data``."""
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
        column, unit = names_by_stem("--column", self.column, stems), names_by_stem("--unit", self.unit, stems)
        with _options_named():
            return [
                read_bench_data(
                    path,
                    experiment=experiment.get(path.stem),
                    input=source.get(path.stem),
                    output=target.get(path.stem),
                    columns=column.get(path.stem),
                    units=unit.get(path.stem),
                    hold=hold.get(path.stem),
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
def _options_named() -> Iterator[None]:
    """Names the option where a message names the argument."""
    try:
        yield
    except InputError as error:
        raise InputError(_ARGUMENT.sub(lambda found: _OPTIONS[found[1]], str(error))) from error


def by_stem(option: str, given: Sequence[str] | None, stems: Sequence[str]) -> dict[str, str]:
    """What ``[STEM=]TEXT`` says of each file; what names a file goes before what holds for all.

    Raises:
        InputError: If a stem is none of the files', nothing is said, or one file is spoken of twice.
    """
    named: dict[str, str] = {}
    for text in given or ():
        stem, said = _split(option, text, "=", stems)
        if not said:
            raise InputError(f"{option}: expected words after {show(text)}, got none")
        if stem in named:
            raise InputError(f"{option}: is given twice{f' for {stem}' if stem else ''}; give it once for each file")
        named[stem] = said
    general = {} if "" not in named else dict.fromkeys(stems, named.pop(""))
    return general | named


def names_by_stem(option: str, given: Sequence[str] | None, stems: Sequence[str]) -> dict[str, dict[str, str]]:
    """What ``[STEM:]name=value`` says of each file, by name; what names a file goes before what holds for all.

    Raises:
        InputError: If one is not of this form, a stem is none of the files', or a name stands twice.
    """
    named: dict[str, dict[str, str]] = {}
    for text in given or ():
        stem, rest = _split(option, text, ":", stems)
        name, equals, value = (part.strip() for part in rest.partition("="))
        if not (name and equals and value):
            raise InputError(
                f"{option}: expected a name and what it stands for such as 'column_angle=theta', got {show(text)}"
            )
        of_file = named.setdefault(stem, {})
        if name in of_file:
            raise InputError(f"{option}: {name} is given twice; give it once for each file")
        of_file[name] = value
    general = named.pop("", {})
    return {stem: {**general, **named.get(stem, {})} for stem in stems if general or stem in named}


def _split(option: str, text: str, mark: str, stems: Sequence[str]) -> tuple[str, str]:
    """Stem and what is said; the stem is empty where none is given."""
    for stem in sorted(stems, key=len, reverse=True):
        if text.startswith(stem + mark):
            return stem, text.removeprefix(stem + mark).strip()
    before, found, _ = text.partition(mark)
    if found and "=" not in before:
        raise InputError(
            f"{option}: {show(before)} is none of the files; expected one of {', '.join(stems)} before '{mark}', or nothing for all"
        )
    return "", text.strip()


def _hold(text: str) -> "Hold":
    from forcefeel.bench.records import HOLDS  # noqa: PLC0415  NumPy

    if text not in HOLDS:
        raise InputError(f"--hold: expected {' or '.join(HOLDS)}, got {show(text)}")
    return HOLDS[text]
