"""What ``plot`` and ``plot_bode`` of the results draw. Handed arrays and words; imported only when a picture is asked for.

Whoever gives axes gets the picture on them and nothing else is touched; without, Matplotlib's current backend opens a figure.
"""

import io
from base64 import b64encode
from collections.abc import Mapping, Sequence
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import FuncFormatter, LogLocator, MultipleLocator, NullFormatter
from numpy.typing import NDArray

from forcefeel.errors import InputError, type_text

Curves = Mapping[str, tuple[NDArray[np.float64], NDArray[np.float64]]]
"""Abscissas and ordinates of curves by what the legend calls them."""

_LOOKS: Sequence[Mapping[str, Any]] = (
    {"color": "#D55E00", "linewidth": 2.0},
    {"color": "#0072B2", "linestyle": "--"},
    {"color": "#222222", "linestyle": ":"},
    {"color": "#009E73", "linestyle": "-."},
    {"color": "#A8568A", "linestyle": (0, (5, 1, 1, 1, 1, 1))},
)
"""Okabe and Ito's hues, which the color-blind can tell apart; dashes for print without color."""


def curves(given: Curves, x_label: str, y_label: str, title: str, ax: Axes | None) -> Axes:
    """Curves over one axis, with a legend."""
    ax = _axes(ax)
    _lines(ax, given)
    ax.set(xlabel=x_label, ylabel=y_label, title=title)
    ax.legend()
    return ax


def bode(responses: Mapping[str, tuple[NDArray[np.float64], NDArray[np.complex128]]], gain_label: str, title: str,
         ax: Sequence[Axes] | None) -> NDArray[np.object_]:  # fmt: skip
    """Gain and phase over the frequency in Hz, above one another.

    Args:
        responses: Frequencies in Hz and complex responses by what the legend calls them.
        gain_label: What the gain is, with its unit.
        title: Title.
        ax: Axes for gain and phase; of a figure of its own where there are none.
    """
    if ax is None:
        _, pair = plt.subplots(2, 1, sharex=True, layout="constrained")
    else:
        pair = np.asarray(ax, dtype=object).ravel()
        if len(pair) != 2 or not all(isinstance(axes, Axes) for axes in pair):
            raise InputError(f"ax: expected two Matplotlib axes, for gain and phase, got {type_text(ax)}")
    gain, phase = pair
    _lines(gain, {name: (at, np.abs(value)) for name, (at, value) in responses.items()})
    _lines(phase, {name: (at, np.degrees(np.unwrap(np.angle(value)))) for name, (at, value) in responses.items()})
    gain.set(xscale="log", yscale="log", ylabel=gain_label, title=title)
    phase.set(xscale="log", xlabel="Frequency, Hz", ylabel="Phase, deg")
    phase.yaxis.set_major_locator(MultipleLocator(90))
    gain.legend()
    return np.asarray(pair)


def cells(
    kinds: NDArray[np.int8], colors: Mapping[str, str], x: NDArray[np.float64], y: NDArray[np.float64], *,
    labels: tuple[str, str, str], own: tuple[float, float], ax: Axes | None,
) -> Axes:  # fmt: skip
    """A map of cells, each in the color of its kind, on two axes of even steps in proportion.

    Args:
        kinds: Places in ``colors``, (y, x).
        colors: Color by what the legend calls it.
        x: Middles of the columns, rising, above 0.
        y: Middles of the rows, rising, above 0.
        labels: Of x, of y, and the title.
        own: A point to mark; drawn if it is in view.
        ax: Axes; of a figure of its own where there are none.
    """
    ax = _axes(ax)
    names = list(colors)
    norm = BoundaryNorm(np.arange(len(names) + 1) - 0.5, len(names))
    ax.pcolormesh(_edges(x), _edges(y), kinds, cmap=ListedColormap(list(colors.values())), norm=norm)
    ax.set(xscale="log", yscale="log", xlabel=labels[0], ylabel=labels[1], title=labels[2])
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_formatter(NullFormatter())
    handles: list[Any] = [Patch(color=colors[names[k]], label=names[k]) for k in np.unique(kinds)]
    if x[0] <= own[0] <= x[-1] and y[0] <= own[1] <= y[-1]:
        handles += ax.plot(
            *own, "o", markerfacecolor="white", markeredgecolor="black", label="the loader's own setting"
        )
    ax.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=2, fontsize="small")
    return ax


def intervals(
    estimates: Mapping[str, tuple[float, float, float]], allowed: Mapping[str, tuple[float, float]], *,
    lost: Sequence[str], x_label: str, title: str, ax: Axes | None,
) -> Axes:  # fmt: skip
    """Values with their intervals, a row each, over what was allowed.

    Args:
        estimates: Value, lower and upper end, by the row's name.
        allowed: Ends of the band behind it; not every row has one.
        lost: Rows that have no value.
        x_label: What the values are, with their unit.
        title: Title.
        ax: Axes; of a figure of its own where there are none.
    """
    ax = _axes(ax)
    rows = {name: -k for k, name in enumerate([*estimates, *lost])}
    if allowed:
        spans = [high - low for low, high in allowed.values()]
        lows = [low for low, _ in allowed.values()]
        ax.barh([rows[name] for name in allowed], spans, 0.5, lows, color="#C9CFD6", label="the file's tolerance")
    if estimates:
        value, low, high = np.array(list(estimates.values())).T
        look: dict[str, Any] = {"fmt": "o", "color": "#009E73", "capsize": 4, "label": "estimate, 95 %"}
        ax.errorbar(value, [rows[name] for name in estimates], xerr=[value - low, high - value], **look)
    for name in lost:
        ax.text(0, rows[name], "not determined", color="#B3261E", ha="center", va="center")
    ax.axvline(0, color="#5A6B7B", linewidth=0.8)
    ax.set(
        yticks=list(rows.values()), yticklabels=list(rows), xlabel=x_label, title=title, ylim=(-len(rows) + 0.4, 0.6)
    )
    if estimates or allowed:
        ax.legend()
    return ax


def small_axes() -> Axes:
    """Axes of a small figure that no window shows."""
    return Figure(figsize=(5.2, 2.6), dpi=100, layout="constrained").add_subplot()


def image(ax: Axes, says: str) -> str:
    """The figure of some axes as an HTML image; ``says`` is escaped, and what it shows."""
    png = io.BytesIO()
    figure = ax.get_figure(root=True)
    if figure is None:
        raise ValueError("expected axes of a figure")
    figure.savefig(png, format="png")
    return f'<img src="data:image/png;base64,{b64encode(png.getvalue()).decode()}" alt="{says}">'


def _axes(ax: Axes | None) -> Axes:
    if ax is None:
        return plt.subplots(layout="constrained")[1]
    if not isinstance(ax, Axes):
        raise InputError(f"ax: expected Matplotlib axes, got {type_text(ax)}")
    return ax


def _lines(ax: Axes, given: Curves) -> None:
    for k, (name, (x, y)) in enumerate(given.items()):
        ax.plot(x, y, label=name, **_LOOKS[k % len(_LOOKS)])
    ax.grid(visible=True, color="#DDE3E9", linewidth=0.6)


def _edges(middles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Edges of cells, each half-way between two middles in proportion."""
    logs = np.log(middles)
    between = (logs[1:] + logs[:-1]) / 2
    return np.asarray(np.exp(np.concatenate([[2 * logs[0] - between[0]], between, [2 * logs[-1] - between[-1]]])))
