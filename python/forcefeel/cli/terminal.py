"""The terminal: names and texts of others are printed as they are, neither as mark-up nor as control sequences."""

import json
from collections.abc import Callable, Collection, Iterable, Mapping
from pathlib import Path
from typing import Any, NoReturn

from rich.cells import cell_len
from rich.console import Console, RenderableType
from rich.table import Column, Table
from rich.text import Text

from forcefeel.conclusions import Conclusions
from forcefeel.printable import visible

_FRAME = 3
"""Characters of a column's border and blanks."""


class Output(Console):
    """A console that ends a command as ``print`` does if the reader of the output has ended; ``main`` sets the status."""

    def on_broken_pipe(self) -> NoReturn:
        """Raises the ``BrokenPipeError`` that is being handled."""
        raise  # noqa: PLE0704  it is, by the caller


class Terminal(Output):
    """A console on which text is text; what is to be red says so by its style."""

    def __init__(self) -> None:
        super().__init__(markup=False, emoji=False)

    def render_str(self, text: str, **options: Any) -> Text:
        """Text as it is to be printed."""
        return super().render_str(visible(text), **options)

    def show(self, table: Table, on_the_page: Collection[str] = ()) -> None:
        """Prints a table. Words and numbers with their units stay whole.

        Args:
            table: The table.
            on_the_page: Columns that a page has too. On too narrow a terminal they are left out; if that does not do, each row
                becomes a list. Either is told.
        """
        if self._spare(table) < 0 and on_the_page:
            table.columns = [column for column in table.columns if column.header not in on_the_page]
            self._print(table)
            left_out = ", ".join(on_the_page)
            self.print(f"The terminal is too narrow for {left_out}; the page has them.", style="dim", highlight=False)
        else:
            self._print(table)

    def conclude(self, concluded: Conclusions, *, alarming: bool = True) -> None:
        """Prints the verdict and the findings below it.

        Args:
            concluded: Verdict and findings.
            alarming: Whether a bad verdict is red: where it ends the command with status 1. A map has no bad verdict.
        """
        red = alarming and not concluded.ok
        self.print(concluded.verdict, style="bold red" if red else "bold", highlight=False)
        for finding in concluded.findings:
            self.print(f"- {finding}", highlight=False)

    def _spare(self, table: Table) -> int:
        return self.width - 1 - sum(_least(column) + _FRAME for column in table.columns)

    def _print(self, table: Table) -> None:
        least, most = [*map(_least, table.columns)], [*map(_most, table.columns)]
        spare = self._spare(table)
        if spare >= 0:
            for _ in range(min(spare, sum(most) - sum(least))):  # to the column that wants most
                widest = max(range(len(least)), key=lambda k: most[k] - least[k])
                least[widest] += 1
            for column, width in zip(table.columns, least, strict=True):
                column.width = width
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


def _most(column: Column) -> int:
    """The width that breaks no line."""
    return max(
        (cell_len(line) for cell in (column.header, *column.cells) for line in _text(cell).splitlines()), default=1
    )


def _text(cell: RenderableType) -> str:
    return visible(cell.plain if isinstance(cell, Text) else str(cell))


def titled(title: str, *columns: str, numbers: Iterable[str] = ()) -> Table:
    """An empty table under a title; the columns ``numbers`` come last and are set to the right."""
    table = Table(*columns, title=title, title_justify="left", title_style="bold")
    for column in numbers:
        table.add_column(column, justify="right")
    return table


def answer(
    files: Mapping[str, Path | None],
    document: Callable[[], Mapping[str, Any]],
    show: Callable[[Terminal], None],
    *,
    as_json: bool,
) -> None:
    """Prints what came of a command: as JSON, or for people; and where its files are.

    Args:
        files: What was written where; ``None`` of what was not.
        document: The result for machines.
        show: Prints it for people.
        as_json: Whether as JSON.
    """
    if as_json:
        print_json({**{what: path and str(path) for what, path in files.items()}, **document()})
        return
    show(Terminal())
    for what, path in files.items():
        if path:
            print(f"{what.replace('_', ' ')}: {path}")


def print_json(document: object) -> None:
    """What ``--json`` prints."""
    print(json.dumps(document, indent=2, allow_nan=False))
