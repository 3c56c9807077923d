"""Text of others on a terminal: what does not print is seen, not obeyed."""

import unicodedata
from collections.abc import Iterable, Sequence
from html import escape

_CONTROL = frozenset({"Cc", "Cs", "Zl", "Zp"})
"""Unicode's control characters, halves of pairs, separators of lines and paragraphs."""

_TURNS = frozenset({"LRE", "RLE", "LRO", "RLO", "PDF", "LRI", "RLI", "FSI", "PDI"})
"""Characters after which a text runs the other way, whatever it says."""


def unprintable(text: str, allowed: str = "") -> str | None:
    """The first character that would steer a terminal instead of printing, but for those allowed; ``None`` if all print."""
    if text.isprintable():
        return None
    steers = (c for c in text if unicodedata.category(c) in _CONTROL or unicodedata.bidirectional(c) in _TURNS)
    return next((c for c in steers if c not in allowed), None)


def visible(text: str) -> str:
    """The text with an escape for each such character, as Python has it; lines and tabs stay."""
    if unprintable(text, "\n\t") is None:
        return text
    return "".join(repr(c)[1:-1] if unprintable(c, "\n\t") else c for c in text)


def table_html(title: str, heads: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """A table for a notebook; the first cell of each row names it."""
    head = "".join(f'<th scope="col">{escape(name)}</th>' for name in heads)
    body = "".join(
        f'<tr><th scope="row">{escape(str(name))}</th>{"".join(f"<td>{escape(str(cell))}</td>" for cell in cells)}</tr>'
        for name, *cells in rows
    )
    return f"<table><caption><b>{escape(title)}</b></caption><tr>{head}</tr>{body}</table>"
