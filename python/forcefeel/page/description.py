"""What a plot shows, in a sentence or two, for those who cannot see it."""

import re
from collections.abc import Iterator

import numpy as np
import plotly.graph_objects as go

from forcefeel.units import to_text

_TAG = re.compile(r"<[^>]*>")
_BREAK = re.compile(r"<br>")
_DIGITS = 3


def described(picture: go.Figure) -> str:
    """Names of the axes, and each curve with its lowest and highest value in view of its axis."""
    x, y = (list(dict.fromkeys(_titles(picture, axis))) for axis in "xy")
    over = f" over {'; '.join(x)}" if x else ""
    curves = "; ".join(dict.fromkeys(_curves(picture)))
    return f"Plot of {'; '.join(y) or 'values'}{over}.{f' {curves}.' if curves else ''}"


def _titles(picture: go.Figure, axis: str) -> Iterator[str]:
    """The titles of all axes of one direction."""
    for one in picture.select_xaxes() if axis == "x" else picture.select_yaxes():
        if one.title.text:
            yield _bare(one.title.text)


def _curves(picture: go.Figure) -> Iterator[str]:
    for one in picture.data:
        along = one.z if one.type == "heatmap" else one.x if getattr(one, "orientation", None) == "h" else one.y
        name = _bare(one.name or ("colour" if one.type == "heatmap" else ""))
        if along is None or not name:
            continue
        values = np.asarray(along)
        if values.dtype == object:
            values = np.array([np.nan if value is None else value for value in values.ravel()])
        if not np.issubdtype(values.dtype, np.number) or not np.isfinite(values).any():
            continue
        yield f"{name}: {_range(float(np.nanmin(values)), float(np.nanmax(values)))}"


def _range(low: float, high: float) -> str:
    lowest, highest = to_text(low, _DIGITS), to_text(high, _DIGITS)
    return lowest if lowest == highest else f"{lowest} to {highest}"


def _bare(text: str) -> str:
    """Without the tags by which Plotly sets it."""
    return _TAG.sub("", _BREAK.sub(" ", text))
