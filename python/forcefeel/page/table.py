"""A table of the page as data: cells of text that are ready to be set."""

from dataclasses import dataclass

from markupsafe import Markup

Text = str | Markup


@dataclass(frozen=True)
class Cell:
    """One cell.

    Attributes:
        text: What it says.
        kind: ``number`` stands to the right, ``bad`` stands out, ``words`` may break into lines.
        background: A color behind it, such as ``#FDE0C5``; empty for none.
    """

    text: Text
    kind: str = ""
    background: str = ""


@dataclass(frozen=True)
class Table:
    """A table.

    Attributes:
        head: The first row.
        rows: The others; the first cell of each names it.
        kind: An extra class for the table, such as ``heat``.
    """

    head: tuple[Cell, ...]
    rows: tuple[tuple[Cell, ...], ...]
    kind: str = ""


def number(text: Text, *, bad: bool = False) -> Cell:
    """A cell with a number."""
    return Cell(text, "number bad" if bad else "number")


def words(text: Text, *, bad: bool = False) -> Cell:
    """A cell with words, which may break into lines."""
    return Cell(text, "words bad" if bad else "words")


def heads(*texts: Text) -> tuple[Cell, ...]:
    """A head whose first column holds names and whose others hold numbers."""
    return (Cell(texts[0]), *(Cell(text, "number") for text in texts[1:]))


def configuration(name: str) -> Markup:
    """A configuration's name with a mark in the color of its curves."""
    return Markup('<span class="key {}">{}</span>').format(name.partition(" ")[0], name)
