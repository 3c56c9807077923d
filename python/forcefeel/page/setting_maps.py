"""Maps of feel settings: a panel for each law and damping ratio, drawn as SVG, a color for each outcome.

Stiffness runs to the right, natural frequency up; even steps in proportion stay even. Neighbors of one color are one rectangle.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import log

import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray

from forcefeel.loader.loader import FEEL_SETTING, Loader
from forcefeel.page.marks import marks
from forcefeel.page.typography import number_text
from forcefeel.units import HERTZ, UnitSystem

WIDTH, HEIGHT = 300, 150
"""A panel's room for cells, in the drawing's own units."""

_MOST_ROWS = 8


@dataclass(frozen=True, eq=False)
class SettingMaps:
    """Outcomes over the settings.

    Attributes:
        stiffness: Shares of ``G_max``, rising.
        frequency: Natural frequencies in rad/s, rising.
        damping: Damping ratios, rising.
        colors: The color of each outcome, by its name.
        cells: For each law the outcome of each setting as a position in ``colors``, (damping, frequency, stiffness).
        loader: The loader, whose own setting is marked.
    """

    stiffness: Sequence[float]
    frequency: Sequence[float]
    damping: Sequence[float]
    colors: Mapping[str, str]
    cells: Mapping[str, NDArray[np.int8]]
    loader: Loader


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


@dataclass(frozen=True)
class Picture:
    """Maps as a template takes them.

    Attributes:
        rows: By damping ratio.
        numbers: Along the edges, ``x`` and ``y``.
        legend: Name and color of each outcome.
        shows_own: Whether the loader's own setting is marked.
    """

    rows: tuple[Row, ...]
    numbers: Mapping[str, Markup]
    legend: tuple[tuple[str, str], ...]
    shows_own: bool


def picture(maps: SettingMaps, units: UnitSystem, *beside: SettingMaps) -> Picture:
    """The maps, drawn; ``beside`` are others on the page that share their legend."""
    return Picture(_rows(maps), _numbers(maps, units), _legend(maps, *beside), _loader_position(maps)[0] >= 0)


def _rows(maps: SettingMaps) -> tuple[Row, ...]:
    """The maps by damping ratio; of more than eight damping ratios, eight evenly spread."""
    damping = maps.damping
    displayed = np.unique(np.linspace(0, len(damping) - 1, min(_MOST_ROWS, len(damping))).round().astype(int))
    own = _loader_position(maps)
    return tuple(
        Row(
            f"ζ = {number_text(damping[index], 3)}",
            tuple(
                _panel(maps, cells[index], own[1:] if own[0] == index else None, law)
                for law, cells in maps.cells.items()
            ),
        )
        for index in map(int, displayed)
    )


def _legend(*drawn: SettingMaps) -> tuple[tuple[str, str], ...]:
    """Name and color of each outcome in the maps."""
    present = {int(kind) for maps in drawn for cells in maps.cells.values() for kind in np.unique(cells)}
    colors = drawn[0].colors.items()
    return tuple((str(name), color) for index, (name, color) in enumerate(colors) if index in present)


def _panel(maps: SettingMaps, cells: NDArray[np.int8], own: tuple[float, float] | None, law: str) -> Panel:
    """One map from its cells (frequency, stiffness)."""
    x = _edges(np.array(maps.stiffness), WIDTH)
    y = HEIGHT - _edges(np.array(maps.frequency), HEIGHT)
    colors = list(maps.colors.values())
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
    names, counts = list(maps.colors), np.bincount(cells.ravel(), minlength=len(maps.colors))
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
    centers = (edges[1:] + edges[:-1]) / 2
    along = log if _in_proportion(points) else float
    return float(np.interp(along(value), [along(point) for point in points], centers))


def _loader_position(maps: SettingMaps) -> tuple[int, float, float]:
    """The row whose damping ratio is nearest to the loader's own, and the position of its setting; row -1 if out of view."""
    loader = maps.loader
    inertia, damping, stiffness = (loader[key] for key in FEEL_SETTING)
    frequency = (stiffness / inertia) ** 0.5
    share, ratio = stiffness / loader["feel.maximum_stiffness"], damping / (2 * inertia * frequency)
    axes = [(maps.damping, ratio), (maps.frequency, frequency), (maps.stiffness, share)]
    if not all(axis[0] <= value <= axis[-1] for axis, value in axes):
        return -1, 0.0, 0.0
    row = int(np.argmin(np.abs(np.array(maps.damping) - ratio)))
    x = _place(np.array(maps.stiffness), share, WIDTH)
    return row, x, HEIGHT - _place(np.array(maps.frequency), frequency, HEIGHT)


def _numbers(maps: SettingMaps, units: UnitSystem) -> dict[str, Markup]:
    """The numbers along the edges of each map."""
    along = {
        "x": (np.array(maps.stiffness), [number_text(100 * value, 3) for value in maps.stiffness], "%"),
        "y": (
            np.array(maps.frequency),
            [number_text(HERTZ.from_si(value, units), 3) for value in maps.frequency],
            "Hz",
        ),
    }
    return {
        axis: marks(axis, [_place(points, value, 1.0) for value in points.tolist()], texts, unit)
        for axis, (points, texts, unit) in along.items()
    }


def spans(maps: SettingMaps, units: UnitSystem) -> dict[str, str]:
    """The range of each axis."""
    axes = maps.stiffness, maps.frequency
    share = [number_text(100 * value, 3) for value in (maps.stiffness[0], maps.stiffness[-1])]
    hertz = [number_text(HERTZ.from_si(value, units), 3) for value in (maps.frequency[0], maps.frequency[-1])]
    return {
        "stiffness": f"{share[0]} to {share[1]} %",
        "frequency": f"{hertz[0]} to {hertz[1]} Hz",
        "proportion": ", both in proportion" if all(map(_in_proportion, map(np.array, axes))) else "",
    }
