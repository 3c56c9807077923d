"""One look per configuration, the same in every figure: Okabe and Ito's colours, which the colour-blind can tell apart."""

from dataclasses import dataclass

RIGID, COMPLIANT, COMPENSATED, IDEAL = "#0072B2", "#D55E00", "#009E73", "#222222"
_OCHRE, _PURPLE, _SKY = "#B57A00", "#A8568A", "#56B4E9"

CONFIGURATIONS = {"rigid": RIGID, "compliant": COMPLIANT, "compensated": COMPENSATED}
"""Colour by the configuration's name."""


@dataclass(frozen=True)
class Look:
    """How a curve is drawn.

    Attributes:
        color: Colour.
        dash: Plotly's name of the dash.
        width: Width in pixels.
    """

    color: str
    dash: str = "solid"
    width: float = 2.0


_LOOKS = {
    "rigid": Look(RIGID, "dash"),
    "rigid link": Look(RIGID, "dash"),
    "compliant": Look(COMPLIANT),
    "compliant link, column": Look(COMPLIANT),
    "compliant link, piston": Look(_OCHRE, "dashdot"),
    "compensated": Look(COMPENSATED, "solid", 2.8),
    "ideal feel": Look(IDEAL, "dot"),
}
_SETTINGS = {
    "figure-11a": {"programmed setting": Look(RIGID), "low setting": Look(_SKY, "dash")},
    "figure-11b": {"programmed setting": Look(COMPLIANT), "low setting": Look(_PURPLE, "dash")},
}
_VALVE = ("#9ECAE1", "#6BAED6", "#4292C6", "#2171B5", "#084594")


def look(figure: str, label: str, position: int) -> Look:
    """The look of a curve.

    Args:
        figure: Key of its figure.
        label: Its label.
        position: Its place among the figure's curves.
    """
    if figure == "figure-02":
        return Look(COMPLIANT, "dash") if label.startswith("linear") else Look(_VALVE[position % len(_VALVE)])
    return _SETTINGS.get(figure, {}).get(label) or _LOOKS.get(label) or Look(IDEAL)
