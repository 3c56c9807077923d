"""The terminal: names and texts of others are printed as they are, neither as mark-up nor as control sequences."""

import json
from typing import Any

from rich.cells import cell_len
from rich.console import Console, RenderableType
from rich.table import Column, Table
from rich.text import Text

from forcefeel.printable import visible

_FRAME = 3
"""Characters of a column's border and blanks."""


class Terminal(Console):
    """A console on which text is text; what is to be red says so by its style."""

    def __init__(self) -> None:
        super().__init__(markup=False, emoji=False)

    def render_str(self, text: str, **options: Any) -> Text:
        """Text as it is to be printed."""
        return super().render_str(visible(text), **options)

    def show(self, table: Table) -> None:
        """Prints a table. Words and numbers with their units stay whole: on too narrow a terminal each row becomes a list."""
        for column in table.columns:
            column.min_width = _least(column)
        if sum((column.min_width or 0) + _FRAME for column in table.columns) + 1 <= self.width:
            self.print(table)
            return
        if table.title:
            self.print(table.title, style="bold", highlight=False)
        heads = [_text(column.header) for column in table.columns]
        for row in zip(*(column.cells for column in table.columns), strict=True):
            self.print(row[0], style="bold", highlight=False)
            entries = Table.grid(padding=(0, 2, 0, 0))
            entries.add_column(width=2 + max(map(cell_len, heads[1:]), default=0))
            entries.add_column()
            for head, cell in zip(heads[1:], row[1:], strict=True):
                entries.add_row(f"  {head}", cell)
            self.print(entries)
        self.print("Row by row, since the terminal is too narrow for the table.", style="dim", highlight=False)


def _least(column: Column) -> int:
    """The width that breaks no word; in a column of numbers, set to the right, no number from its unit."""
    words = _text(column.header).split()
    for cell in map(_text, column.cells):
        words += [cell] if column.justify == "right" or column.no_wrap else cell.split()
    return max(map(cell_len, words), default=1)


def _text(cell: RenderableType) -> str:
    return visible(cell.plain if isinstance(cell, Text) else str(cell))


def print_json(document: object) -> None:
    """What ``--json`` prints."""
    print(json.dumps(document, indent=2, allow_nan=False))
