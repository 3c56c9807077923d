"""What a plot shows, in a sentence or two, for those who cannot see it."""

import re
from typing import Any

import numpy as np
import plotly.graph_objects as go

from forcefeel.units import to_text

_TAG = re.compile(r"<[^>]*>")
_BREAK = re.compile(r"<br>")
_DIGITS = 3


def described(picture: go.Figure) -> str:
    """Names of the axes, and along each the lowest and the highest value of every curve."""
    curves: dict[str, dict[str, None]] = {_title(axis): {} for axis in picture.select_yaxes()}
    for trace in picture.data:
        if text := _trace_text(trace):
            curves.setdefault(_title(_axis(picture, trace)), {})[text] = None
    over = "; ".join(dict.fromkeys(filter(None, map(_title, picture.select_xaxes()))))
    parts = [": ".join(filter(None, (title, "; ".join(texts)))) for title, texts in curves.items()]
    return f"Plot{f' over {over}' if over else ''}. {'. '.join(filter(None, parts))}."


def _axis(picture: go.Figure, trace: Any) -> Any:
    """The axis along which a trace has its values."""
    along = "x" if _lies(trace) else "y"
    name = getattr(trace, f"{along}axis") or along
    return picture.layout[name.replace(along, f"{along}axis", 1)]


def _lies(trace: Any) -> bool:
    return getattr(trace, "orientation", None) == "h"


def _trace_text(trace: Any) -> str:
    """A trace's name with its lowest and highest value; nothing of one without numbers, or of nameless dots on a curve."""
    if trace.type == "heatmap":
        name, along = trace.colorbar.title.text or "color", trace.z
    else:
        name, along = _bare(trace.name or ""), trace.x if _lies(trace) else trace.y
    if along is None or not (name or trace.type == "bar"):
        return ""
    values = np.array([np.nan if value is None else value for value in np.ravel(along)])
    if not np.issubdtype(values.dtype, np.number) or not np.isfinite(values).any():
        return ""
    return f"{name} {_range(float(np.nanmin(values)), float(np.nanmax(values)))}".lstrip()


def _title(axis: Any) -> str:
    return _bare(axis.title.text or "")


def _range(low: float, high: float) -> str:
    lowest, highest = to_text(low, _DIGITS), to_text(high, _DIGITS)
    return lowest if lowest == highest else f"{lowest} to {highest}"


def _bare(text: str) -> str:
    """Without the tags by which Plotly sets it."""
    return _TAG.sub("", _BREAK.sub(" ", text))
