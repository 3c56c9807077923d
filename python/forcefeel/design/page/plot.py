"""A plot in the page of a design."""

from dataclasses import dataclass

from markupsafe import Markup

from forcefeel.design.figure import Figure
from forcefeel.design.page import splane
from forcefeel.design.page.captions import MEANINGS
from forcefeel.design.page.plots import draw
from forcefeel.design.page.stability import AnyDesign, departures
from forcefeel.page.render import drawing
from forcefeel.units import UnitSystem


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


def plot(figure: Figure, number: str, design: AnyDesign, units: UnitSystem) -> Plot:
    """A figure of the design as a plot with this number."""
    drawn, remarks = drawing(draw(figure, design, units), figure.key), departures(figure, design)
    return Plot(figure.key, f"Figure {number}", figure.title, MEANINGS[figure.key], remarks, drawn)


def planes(design: AnyDesign, on_the_link: str) -> tuple[tuple[str, str, Markup], ...]:
    """The s-planes, title, anchor and drawing of each; ``on_the_link`` is what swings there."""
    drawings = (
        ("The poles of the feel", "poles-feel", splane.feel(design)),
        (f"The poles of {on_the_link}", "poles-link", splane.link(design)),
        (f"All poles up to {splane.OUT_OF_VIEW_HZ:g} Hz", "poles-all", splane.whole(design)),
    )
    return tuple((title, name, drawing(picture, name)) for title, name, picture in drawings)
