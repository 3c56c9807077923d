"""The numbers along the edges of a map that is drawn as SVG without text, so that its cells may stretch with the page."""

from collections.abc import Sequence

from markupsafe import Markup

_MOST = 3


def marks(along: str, places: Sequence[float], values: Sequence[str], unit: str) -> Markup:
    """The numbers of an axis, at most three, the unit with the last.

    Args:
        along: ``x``, to the right, or ``y``, upward.
        places: Where the values lie, as shares of the axis from its beginning.
        values: The numbers as text.
        unit: Unit of the numbers.
    """
    last = len(values) - 1
    shown = sorted({0, last, *([last // 2] if len(values) >= _MOST else [])})
    edge = "left" if along == "x" else "bottom"
    labels = [
        Markup('<span style="{}: {:.1f}%">{}{}</span>').format(
            edge, 100 * places[k], values[k], f"\N{NO-BREAK SPACE}{unit}" if k == last else ""
        )
        for k in shown
    ]
    return Markup('<div class="marks {}">{}</div>').format(along, Markup("").join(labels))
