"""Options for files, for one by its stem or for all: ``--column``, ``--unit`` and similar."""

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
    """Column names and units by ``--column`` and ``--unit`` for each file, by its stem.

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
            InputError: If one is invalid, or there is no file.
        """
        for option, texts in (("--column", columns), ("--unit", units)):
            if texts and not stems:
                raise InputError(f"{option}: requires a data file; add one or remove this option")
        return cls(names_by_stem("--column", columns, stems), names_by_stem("--unit", units, stems))

    def arguments(self, stem: str) -> Arguments:
        """Arguments of the reader for the file of that stem."""
        return {"columns": self.columns.get(stem, {}), "units": self.units.get(stem, {})}


def by_stem(option: str, texts: Sequence[str] | None, stems: Sequence[str]) -> dict[str, str]:
    """The text of ``[STEM=]TEXT`` for each file; a text for one file precedes one for all.

    Raises:
        InputError: If a stem matches no file, the text is empty, or a file has two.
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
    """The values of ``[STEM:]name=value`` for each file, by name; a value for one file precedes one for all.

    Raises:
        InputError: If one is not of this form, a stem matches no file, or a name stands twice.
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
    """Stem and text; the stem is empty if not given."""
    for stem in sorted(stems, key=len, reverse=True):
        if text.startswith(stem + mark):
            return stem, text.removeprefix(stem + mark).strip()
    before, separator, _ = text.partition(mark)
    if separator and "=" not in before:
        raise InputError(
            f"{option}: {show(before)} matches no file; expected one of {', '.join(stems)} before '{mark}', or nothing for all"
        )
    return "", text.strip()
