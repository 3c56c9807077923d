"""A plot in a page, with what is said of it."""

from dataclasses import dataclass

import plotly.graph_objects as go
from markupsafe import Markup

from forcefeel.page.render import drawing


@dataclass(frozen=True)
class Picture:
    """A plot in the page.

    Attributes:
        key: Its anchor.
        title: What it shows; may be empty, as may be the other texts.
        meaning: How to read it.
        drawing: The plot as HTML.
        remark: What the reader should know of these very curves.
    """

    key: str
    title: str
    meaning: str | Markup
    drawing: Markup
    remark: str = ""

    @classmethod
    def of(cls, key: str, title: str, meaning: str | Markup, drawn: go.Figure, remark: str = "") -> "Picture":
        """The picture of a plot."""
        return cls(key, title, meaning, drawing(drawn, key), remark)
