"""The maps of an envelope: a panel for each law and damping ratio, drawn as SVG, a colour for each way to fail.

Stiffness runs to the right, natural frequency up; even steps in proportion stay even. Neighbours of one colour are one rectangle.
"""

from dataclasses import dataclass
from math import log

import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray

from forcefeel.envelope.result import COLORS, Envelope
from forcefeel.loader.loader import FEEL_SETTING
from forcefeel.page.marks import marks
from forcefeel.page.typography import number_text
from forcefeel.units import HERTZ, UnitSystem

WIDTH, HEIGHT = 300, 150
"""A panel's room for cells, in the drawing's own units."""

_MOST_ROWS = 8


@dataclass(frozen=True)
class Panel:
    """One map.

    Attributes:
        drawing: The SVG.
        says: What it shows, for those who cannot see it.
    """

    drawing: Markup
    says: str


@dataclass(frozen=True)
class Row:
    """The maps of one damping ratio, a panel for each law.

    Attributes:
        title: The damping ratio.
        panels: In the order of the laws.
    """

    title: str
    panels: tuple[Panel, ...]


def rows(found: Envelope, *, worst: bool) -> tuple[Row, ...]:
    """The maps by damping ratio; of more than eight damping ratios, eight evenly spread.

    Args:
        found: The envelope.
        worst: By what fails in the first case that fails, in place of what fails nominally.
    """
    damping = found.plan.settings.damping
    shown = np.unique(np.linspace(0, len(damping) - 1, min(_MOST_ROWS, len(damping))).round().astype(int))
    maps = {name: found.kinds(name, worst=worst) for name in found.laws}
    own = _own(found)
    return tuple(
        Row(
            f"ζ = {number_text(damping[place], 3)}",
            tuple(
                _panel(found, cells[place], own[1:] if own[0] == place else None, name) for name, cells in maps.items()
            ),
        )
        for place in map(int, shown)
    )


def legend(found: Envelope) -> tuple[tuple[str, str], ...]:
    """Name and colour of what is in the maps."""
    order = list(COLORS)
    seen = {
        int(kind)
        for name in found.laws
        for worst in (False, True)
        for kind in np.unique(found.kinds(name, worst=worst))
    }
    return tuple((str(name), COLORS[name]) for place, name in enumerate(order) if place in seen)


def _panel(found: Envelope, cells: NDArray[np.int8], own: tuple[float, float] | None, law: str) -> Panel:
    """One map from its cells (frequency, stiffness)."""
    x = _edges(np.array(found.plan.settings.stiffness), WIDTH)
    y = HEIGHT - _edges(np.array(found.plan.settings.frequency), HEIGHT)
    colors = list(COLORS.values())
    parts = []
    for low, high, line in zip(y[:-1], y[1:], cells, strict=True):
        starts = np.flatnonzero(np.diff(line, prepend=-1))
        for start, end in zip(starts, [*starts[1:], len(line)], strict=True):
            box = (x[start], high, x[end] - x[start], low - high)
            parts.append(
                '<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}" fill="{}"/>'.format(
                    *box, colors[line[start]]
                )
            )
    names, counts = list(COLORS), np.bincount(cells.ravel(), minlength=len(COLORS))
    says = ", ".join(
        f"{name} {100 * count / cells.size:.0f} %" for name, count in zip(names, counts, strict=True) if count
    )
    drawing = Markup(
        '<svg viewBox="0 0 {} {}" preserveAspectRatio="none" role="img" aria-label="{}"><title>{}</title>{}</svg>'
    ).format(WIDTH, HEIGHT, f"{law}: {says}", says, Markup("".join(parts)))
    if own is not None:
        x_share, y_share = 100 * own[0] / WIDTH, 100 * own[1] / HEIGHT
        drawing += Markup('<i class="own" style="left: {:.1f}%; top: {:.1f}%"></i>').format(x_share, y_share)
    return Panel(drawing, says)


def _edges(points: NDArray[np.float64], room: float) -> NDArray[np.float64]:
    """The edges of the cells about the points, from 0 to ``room``; even steps in proportion stay even."""
    along = np.log(points) if _in_proportion(points) else points
    middle = (along[1:] + along[:-1]) / 2
    edges = np.concatenate([[2 * along[0] - middle[0]], middle, [2 * along[-1] - middle[-1]]])
    return np.asarray(room * (edges - edges[0]) / (edges[-1] - edges[0]))


def _in_proportion(points: NDArray[np.float64]) -> bool:
    """Whether an axis is drawn so that equal steps are equal in proportion: where its points are, or span a decade unevenly."""
    differ = [np.ptp(np.diff(values)) / np.ptp(values) for values in (np.log(points), points)]
    return bool(differ[0] < min(differ[1], _EVEN) or (points[-1] > 10 * points[0] and differ[1] > _EVEN))


_EVEN = 1e-6
"""Relative; steps that are the same but for rounding."""


def _place(points: NDArray[np.float64], value: float, room: float) -> float:
    """Where a value lies between the edges."""
    edges = _edges(points, room)
    centres = (edges[1:] + edges[:-1]) / 2
    along = log if _in_proportion(points) else float
    return float(np.interp(along(value), [along(point) for point in points], centres))


def _own(found: Envelope) -> tuple[int, float, float]:
    """The row whose damping ratio is nearest to the loader's own, and where its setting lies in it; row -1 if out of view."""
    loader, settings = found.plan.given, found.plan.settings
    inertia, damping, stiffness = (loader[key] for key in FEEL_SETTING)
    frequency = (stiffness / inertia) ** 0.5
    share, ratio = stiffness / loader["feel.maximum_stiffness"], damping / (2 * inertia * frequency)
    axes = [(settings.damping, ratio), (settings.frequency, frequency), (settings.stiffness, share)]
    if not all(axis[0] <= value <= axis[-1] for axis, value in axes):
        return -1, 0.0, 0.0
    row = int(np.argmin(np.abs(np.array(settings.damping) - ratio)))
    x = _place(np.array(settings.stiffness), share, WIDTH)
    return row, x, HEIGHT - _place(np.array(settings.frequency), frequency, HEIGHT)


def numbers(found: Envelope, units: UnitSystem) -> dict[str, Markup]:
    """The numbers along the edges of each map."""
    settings = found.plan.settings
    along = {
        "x": (np.array(settings.stiffness), [number_text(100 * value, 3) for value in settings.stiffness], "%"),
        "y": (
            np.array(settings.frequency),
            [number_text(HERTZ.from_si(value, units), 3) for value in settings.frequency],
            "Hz",
        ),
    }
    return {
        axis: marks(axis, [_place(points, value, 1.0) for value in points.tolist()], texts, unit)
        for axis, (points, texts, unit) in along.items()
    }


def shows_own(found: Envelope) -> bool:
    """Whether the loader's own setting lies in the maps."""
    return _own(found)[0] >= 0


def spans(found: Envelope, units: UnitSystem) -> dict[str, str]:
    """From where to where the axes run."""
    settings = found.plan.settings
    axes = settings.stiffness, settings.frequency
    share = [number_text(100 * value, 3) for value in (settings.stiffness[0], settings.stiffness[-1])]
    hertz = [number_text(HERTZ.from_si(value, units), 3) for value in (settings.frequency[0], settings.frequency[-1])]
    return {
        "stiffness": f"{share[0]} to {share[1]} %",
        "frequency": f"{hertz[0]} to {hertz[1]} Hz",
        "proportion": ", both in proportion" if all(map(_in_proportion, map(np.array, axes))) else "",
    }
