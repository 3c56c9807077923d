"""Maps of a frontier: a panel for each damping ratio and a cell for each setting, colored by its limit.

Stiffness runs to the right, natural frequency up; all cells have the same size, whatever the spacing of the grid.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray

from forcefeel.conclusions import share_text
from forcefeel.frontier.result import Frontier, Limit
from forcefeel.page.marks import marks
from forcefeel.page.typography import number_text
from forcefeel.units import HERTZ, UnitSystem

CELL = 24, 16
"""Width and height of a cell, in units of the drawing."""

COLORS = {
    Limit.NONE: "#009E73",
    Limit.DRIVE: "#D55E00",
    Limit.INERTIA: "#0072B2",
    Limit.NOMINAL: "#2B2B2B",
    Limit.LAW: "#E6B800",
}
"""Okabe and Ito's hues for color blindness; lightness differs too."""

_MOST_PANELS = 8


@dataclass(frozen=True)
class Panel:
    """Map of one damping ratio.

    Attributes:
        title: The damping ratio.
        drawing: The SVG.
        stiffness: Numbers below it.
        frequency: Numbers beside it.
    """

    title: str
    drawing: Markup
    stiffness: Markup
    frequency: Markup


def panels(frontier: Frontier, units: UnitSystem) -> tuple[Panel, ...]:
    """Maps by damping ratio; at most eight, evenly spread."""
    settings = frontier.plan.settings
    damping = settings.damping
    percent = [number_text(100 * value, 3) for value in settings.stiffness]
    hertz = [number_text(HERTZ.from_si(value, units), 3) for value in settings.frequency]
    numbers = (marks("x", _middles(percent), percent, "%"), marks("y", _middles(hertz), hertz, "Hz"))
    rows = np.unique(np.linspace(0, len(damping) - 1, min(_MOST_PANELS, len(damping))).round().astype(int))
    return tuple(Panel(f"ζ = {number_text(damping[k], 3)}", _drawing(frontier, k), *numbers) for k in map(int, rows))


def _middles(values: Sequence[str]) -> list[float]:
    """Relative positions of the centers of equal cells."""
    return [(k + 0.5) / len(values) for k in range(len(values))]


def legend(frontier: Frontier) -> tuple[tuple[str, str, str], ...]:
    """Name, color and share of each limit in the maps."""
    return tuple(
        (frontier.text(limit), COLORS[limit], share_text(share))
        for limit, share in frontier.limit_shares.items()
        if share > 0
    )


def spans(frontier: Frontier, units: UnitSystem) -> dict[str, str]:
    """Ranges of the axes."""
    settings = frontier.plan.settings
    share = [number_text(100 * value, 3) for value in (settings.stiffness[0], settings.stiffness[-1])]
    hertz = [number_text(HERTZ.from_si(value, units), 3) for value in (settings.frequency[0], settings.frequency[-1])]
    return {"stiffness": f"{share[0]} to {share[1]} %", "frequency": f"{hertz[0]} to {hertz[1]} Hz"}


def _drawing(frontier: Frontier, damping: int) -> Markup:
    """One map from the limits of its settings (frequency, stiffness)."""
    limits: NDArray[np.int8] = frontier.limits[damping]
    order, (wide, high) = list(Limit), CELL
    rows, columns = limits.shape
    boxes = [
        f'<rect x="{wide * column}" y="{high * (rows - 1 - row)}" width="{wide}" height="{high}" '
        f'fill="{COLORS[order[limits[row, column]]]}"/>'
        for row in range(rows)
        for column in range(columns)
    ]
    counts = np.bincount(limits.ravel(), minlength=len(order))
    says = ", ".join(
        f"{frontier.text(limit)} {100 * count / limits.size:.0f} %"
        for limit, count in zip(order, counts, strict=True)
        if count
    )
    return Markup(
        '<svg viewBox="0 0 {} {}" preserveAspectRatio="none" role="img" aria-label="{}"><title>{}</title>{}</svg>'
    ).format(wide * columns, high * rows, says, says, Markup("".join(boxes)))
