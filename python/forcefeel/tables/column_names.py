"""What options say of files, for one by its stem or for all: ``--column``, ``--unit`` and their like."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypedDict

from forcefeel.errors import InputError
from forcefeel.units import show


class Arguments(TypedDict):
    """Arguments of a reader of files."""

    columns: Mapping[str, str]
    units: Mapping[str, str]


@dataclass(frozen=True)
class ColumnNames:
    """What ``--column`` and ``--unit`` say of each file, by its stem.

    Attributes:
        columns: The file's own name of each column.
        units: Units of columns whose header has none.
    """

    columns: Mapping[str, Mapping[str, str]]
    units: Mapping[str, Mapping[str, str]]

    @classmethod
    def of(cls, columns: Sequence[str] | None, units: Sequence[str] | None, stems: Sequence[str]) -> "ColumnNames":
        """The options as given, for files of these stems.

        Raises:
            InputError: If one is bad, or there is no file that it could be of.
        """
        for option, texts in (("--column", columns), ("--unit", units)):
            if texts and not stems:
                raise InputError(f"{option}: is about a file's columns, and no file is given; leave it out")
        return cls(names_by_stem("--column", columns, stems), names_by_stem("--unit", units, stems))

    def arguments(self, stem: str) -> Arguments:
        """What is said of the file of that stem."""
        return {"columns": self.columns.get(stem, {}), "units": self.units.get(stem, {})}


def by_stem(option: str, texts: Sequence[str] | None, stems: Sequence[str]) -> dict[str, str]:
    """What ``[STEM=]TEXT`` says of each file; what names a file goes before what holds for all.

    Raises:
        InputError: If a stem is none of the files', nothing is said, or one file is spoken of twice.
    """
    named: dict[str, str] = {}
    for text in texts or ():
        stem, value = _split(option, text, "=", stems)
        if not value:
            raise InputError(f"{option}: expected words after {show(text)}, got none")
        if stem in named:
            raise InputError(f"{option}: is given twice{f' for {stem}' if stem else ''}; give it once for each file")
        named[stem] = value
    general = {} if "" not in named else dict.fromkeys(stems, named.pop(""))
    return general | named


def names_by_stem(option: str, texts: Sequence[str] | None, stems: Sequence[str]) -> dict[str, dict[str, str]]:
    """What ``[STEM:]name=value`` says of each file, by name; what names a file goes before what holds for all.

    Raises:
        InputError: If one is not of this form, a stem is none of the files', or a name stands twice.
    """
    named: dict[str, dict[str, str]] = {}
    for text in texts or ():
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
    before, separator, _ = text.partition(mark)
    if separator and "=" not in before:
        raise InputError(
            f"{option}: {show(before)} is none of the files; expected one of {', '.join(stems)} before '{mark}', or nothing for all"
        )
    return "", text.strip()
