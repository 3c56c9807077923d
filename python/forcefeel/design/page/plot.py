"""A plot in the page of a design."""

from dataclasses import dataclass

from markupsafe import Markup


@dataclass(frozen=True)
class Plot:
    """A plot in the page.

    Attributes:
        key: Its anchor.
        label: ``Figure 8``.
        title: What it shows.
        meaning: How to read it.
        remarks: What the reader should know of these very curves.
        drawing: The plot as HTML.
    """

    key: str
    label: str
    title: str
    meaning: str
    remarks: tuple[str, ...]
    drawing: Markup
