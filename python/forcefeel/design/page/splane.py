"""Poles on the s-plane: the whole picture, and the slow poles close to the imaginary axis."""

from dataclasses import dataclass

import numpy as np
import plotly.graph_objects as go

from forcefeel.design.motor_design import MotorDesign
from forcefeel.design.motor_figures import under
from forcefeel.design.page.stability import AnyDesign
from forcefeel.linear.electric_modes import ON_THE_LINK
from forcefeel.linear.models import Linkage, feel_model
from forcefeel.linear.modes import Mode
from forcefeel.page.canvas import ZERO, frame
from forcefeel.page.palette import COMPENSATED, CONFIGURATIONS, IDEAL

OUT_OF_VIEW_HZ = 1000.0
"""A pole faster than this is listed in the table of modes only."""

_DAMPING_RATIOS = (0.1, 0.2, 0.4, 0.6, 0.8)
_SYMBOLS = {"rigid": "cross-thin", "compliant": "x-thin", "compensated": "diamond-open"}


@dataclass(frozen=True)
class _Loop:
    """The poles of one loop at both settings, and how they are drawn."""

    name: str
    color: str
    symbol: str
    programmed: tuple[Mode, ...]
    low: tuple[Mode, ...]


def _loops(design: AnyDesign) -> tuple[_Loop, ...]:
    loops = tuple(
        _Loop(
            configuration.name,
            CONFIGURATIONS[configuration.name],
            _SYMBOLS[configuration.name],
            configuration.programmed.modes,
            configuration.low.modes,
        )
        for configuration in design.configurations
    )
    if not isinstance(design, MotorDesign):
        return loops
    law = _Loop(under(design.law), COMPENSATED, _SYMBOLS["compensated"], design.programmed.modes, design.low.modes)
    return (*loops, law)


def whole(design: AnyDesign) -> go.Figure:
    """Every pole up to ``OUT_OF_VIEW_HZ``."""
    return _plane(design, _up_to(design, 2 * np.pi * OUT_OF_VIEW_HZ), legend=32)


def link(design: AnyDesign) -> go.Figure:
    """The poles up to the fastest of the column swinging on its linkage."""
    if isinstance(design, MotorDesign):
        return _plane(design, _up_to(design, 1.5 * design.mode(ON_THE_LINK).frequency_rad_per_s))
    fastest = 1.5 * max(
        configuration.boundary.frequency_rad_per_s
        for configuration in design.configurations
        if configuration.linkage is Linkage.COMPLIANT
    )
    return _plane(design, _up_to(design, max(fastest, 10 * design.feel_frequency_rad_per_s)))


def feel(design: AnyDesign) -> go.Figure:
    """The poles near the programmed feel's."""
    return _plane(design, _up_to(design, 1.3 * design.feel_frequency_rad_per_s))


def _up_to(design: AnyDesign, frequency_rad_per_s: float) -> list[Mode]:
    modes = (mode for loop in _loops(design) for mode in (*loop.programmed, *loop.low))
    return [mode for mode in modes if mode.frequency_rad_per_s <= frequency_rad_per_s]


def _plane(design: AnyDesign, seen: list[Mode], legend: int = 98) -> go.Figure:
    """The part of the plane that holds ``seen``, with ``legend`` pixels above it."""
    ideal = _ideal_pole(design)
    left = 1.15 * min([-0.1 * abs(ideal), *(mode.real_per_s for mode in seen)])
    right = max(1.5 * max([0.0, *(mode.real_per_s for mode in seen)]), -0.12 * left)
    top = 1.2 * max([abs(ideal.imag), 1e-3 * abs(left), *(mode.imaginary_per_s for mode in seen)])
    picture = go.Figure()
    _damping_rays(picture, left, top)
    for low in (False, True):
        for loop in _loops(design):
            _poles(picture, loop, low=low)
    _ideal(picture, design)
    frame(picture, 460, top=legend, hover="closest")
    picture.update_xaxes(title_text="Real part, 1/s", range=[left, right], **ZERO)
    picture.update_yaxes(title_text="Imaginary part, rad/s", range=[-0.03 * top, top])
    return picture


def _poles(picture: go.Figure, loop: _Loop, *, low: bool) -> None:
    modes = loop.low if low else loop.programmed
    marker = {
        "symbol": "circle-open" if low else loop.symbol,
        "size": 8 if low else 11,
        "color": loop.color,
        "line": {"width": 1.6 if low else 2.4, "color": loop.color},
    }
    picture.add_scatter(
        x=[mode.real_per_s for mode in modes],
        y=[mode.imaginary_per_s for mode in modes],
        customdata=[[mode.frequency_rad_per_s / (2 * np.pi), mode.damping_ratio] for mode in modes],
        name=f"{loop.name}, low" if low else loop.name,
        mode="markers",
        marker=marker,
        hovertemplate="%{customdata[0]:.3~g} Hz, damping ratio %{customdata[1]:.2f}",
    )


def _ideal(picture: go.Figure, design: AnyDesign) -> None:
    frequency, damping_ratio = design.feel_frequency_rad_per_s, design.feel_damping_ratio
    pole = _ideal_pole(design)
    picture.add_scatter(
        x=[pole.real],
        y=[abs(pole.imag)],
        name="ideal feel",
        mode="markers",
        marker={"symbol": "star", "size": 9, "color": IDEAL},
        hovertemplate=f"{frequency / (2 * np.pi):.3g} Hz, damping ratio {damping_ratio:.2f}",
    )


def _ideal_pole(design: AnyDesign) -> complex:
    """The programmed feel's pole in the upper half plane; the slower one, if both are real."""
    return max(
        (complex(pole) for pole in np.linalg.eigvals(feel_model(design.loader).A)),
        key=lambda pole: (pole.imag, pole.real),
    )


def _damping_rays(picture: go.Figure, left: float, top: float) -> None:
    """Lines of constant damping ratio, each with its value where it leaves the picture."""
    for ratio in _DAMPING_RATIOS:
        slope = np.sqrt(1 - ratio**2) / ratio
        length = min(-left, top / slope)
        x, y = -length, slope * length
        picture.add_shape(
            type="line", x0=0, y0=0, x1=x, y1=y, line={"color": "#C3CAD2", "width": 1, "dash": "dot"}, layer="below"
        )
        at_top = y >= top * 0.999
        room = 0.15 * -left < length < 0.9 * -left if at_top else y < 0.9 * top
        if not room:
            continue  # no room beside the corner, or beside the upright line
        picture.add_annotation(
            x=x if at_top else 0.99 * left,
            y=0.97 * top if at_top else y,
            text=f"ζ {ratio:g}",
            showarrow=False,
            font={"size": 10.5, "color": "#6B7580"},
            bgcolor="rgba(255,255,255,0.8)",
            xanchor="center" if at_top else "left",
        )
