"""One look per configuration, the same in every figure: Okabe and Ito's colors, which the color-blind can tell apart."""

from dataclasses import dataclass

RIGID, COMPLIANT, COMPENSATED, IDEAL = "#0072B2", "#D55E00", "#009E73", "#222222"
_OCHRE, _PURPLE, _SKY = "#B57A00", "#A8568A", "#56B4E9"

CONFIGURATIONS = {"rigid": RIGID, "compliant": COMPLIANT, "compensated": COMPENSATED}
"""Color by the configuration's name."""


@dataclass(frozen=True)
class LineStyle:
    """How a curve is drawn.

    Attributes:
        color: Color.
        dash: Plotly's name of the dash.
        width: Width in pixels.
    """

    color: str
    dash: str = "solid"
    width: float = 2.0


_LOOKS = {
    "rigid": LineStyle(RIGID, "dash"),
    "rigid link": LineStyle(RIGID, "dash"),
    "compliant": LineStyle(COMPLIANT),
    "compliant link, column": LineStyle(COMPLIANT),
    "compliant link, piston": LineStyle(_OCHRE, "dashdot"),
    "compliant link, motor": LineStyle(_OCHRE, "dashdot"),
    "compliant link": LineStyle(COMPLIANT),
    "column held": LineStyle(_PURPLE, "dashdot"),
    "no current": LineStyle(_OCHRE, "dashdot"),
    "compensated": LineStyle(COMPENSATED, "solid", 2.8),
    "ideal feel": LineStyle(IDEAL, "dot"),
}
_SETTINGS = {
    "figure-11a": {"programmed setting": LineStyle(RIGID), "low setting": LineStyle(_SKY, "dash")},
    "figure-11b": {"programmed setting": LineStyle(COMPLIANT), "low setting": LineStyle(_PURPLE, "dash")},
}
_VALVE = ("#9ECAE1", "#6BAED6", "#4292C6", "#2171B5", "#084594")


def look(figure: str, label: str, position: int) -> LineStyle:
    """The look of a curve by the key of its figure, its label and its place among the figure's curves."""
    if figure == "figure-02":
        return (
            LineStyle(COMPLIANT, "dash") if label.startswith("tangent") else LineStyle(_VALVE[position % len(_VALVE)])
        )
    if label.startswith("under "):  # a law
        label = "compensated"
    return _SETTINGS.get(figure, {}).get(label) or _LOOKS.get(label) or LineStyle(IDEAL)


DARK = {
    "#FFFFFF": "#171C21",
    "#222222": "#E6EAEE",
    "#E4E7EB": "#2B323A",
    "#8A939E": "#7F8A96",
    "#6B7580": "#9AA5B1",
    "#9AA3AD": "#7F8A96",
    "#C3CAD2": "#4A545F",
    "#D9DEE4": "#39424B",
    "#F3D6D2": "#6B2F2B",
    "#B3261E": "#F28B82",
    RIGID: "#4BA3DE",
    COMPLIANT: "#F0803C",
    COMPENSATED: "#2DBE94",
    _OCHRE: "#DDA63A",
    _PURPLE: "#D98CC0",
    "#8DBBDD": "#5E93BA",
    "#9ECAE1": "#33658F",
    "#6BAED6": "#4585B5",
    "#2171B5": "#6BAED6",
    "#084594": "#B3D7F0",
    "rgba(255,255,255,0.75)": "rgba(23,28,33,0.75)",
    "rgba(255,255,255,0.8)": "rgba(23,28,33,0.8)",
    "rgba(255,255,255,0.85)": "rgba(23,28,33,0.85)",
    "rgba(34,34,34,0.10)": "rgba(230,234,238,0.12)",
}
"""What a color of the plots becomes on a dark page; one that is not here stays, as do the scales of maps."""
