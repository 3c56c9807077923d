"""Checked signals over time from a table, in SI units."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from forcefeel.errors import InputError
from forcefeel.tables.between import ALL, Times, take_between
from forcefeel.tables.faults import fault, in_file
from forcefeel.tables.header import by_standard_name, locate, need
from forcefeel.tables.table import Columns, Table


@dataclass(frozen=True)
class Signals:
    """Columns that a reader accepts.

    Attributes:
        accepted: Accepted SI units of each column, by name; ``time`` is one of them.
        needed: Required names.
        also: Standard name by second name.
        example: A good CSV header, for messages.
        cuts: Whether the reader's argument ``between_s`` reads a part of a record.
    """

    accepted: Mapping[str, tuple[str, ...]]
    needed: tuple[str, ...]
    example: str
    also: Mapping[str, str] = field(default_factory=dict)
    cuts: bool = False

    def read(
        self, table: Table, columns: Mapping[str, str] | None, units: Mapping[str, str] | None, between_s: Times = ALL
    ) -> Columns:
        """The columns that the table has.

        Args:
            table: The table.
            columns: The file's own names of them.
            units: Units where the header has none, by these names or the file's own.
            between_s: First and last time to read.

        Raises:
            InputError: If a required column is missing, a column is invalid, or a row is faulty.
        """
        where = str(table.path)
        columns = by_standard_name(where, "columns", columns or {}, self.accepted, self.also)
        units = by_standard_name(where, "units", units or {}, (*self.accepted, *columns.values()), self.also)
        located = locate(table, self.accepted, units, columns, self.also)
        need(table, located, self.needed, self.example)
        read = take_between(table, located, between_s)
        if wrong := fault(read.values, read.units):
            row, sentence = wrong
            raise InputError(f"{read.places[row]}: {in_file(sentence) if self.cuts else sentence}")
        return read
