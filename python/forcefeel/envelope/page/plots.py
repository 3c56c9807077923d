"""Curves of an envelope: share over release angle, and impedance at the grip over frequency."""

import numpy as np
import plotly.graph_objects as go
from numpy.typing import NDArray

from forcefeel.envelope.passivity import ARM_HZ
from forcefeel.envelope.result import Envelope
from forcefeel.loader.loader import FEEL_SETTING
from forcefeel.page.canvas import add_curve, frame, line
from forcefeel.page.palette import COMPENSATED, COMPLIANT, IDEAL, RIGID, LineStyle
from forcefeel.units import ANGLE, UnitSystem, to_text

_OTHERS = ("#A8568A", "#B57A00", "#56B4E9", "#6B7580")
_LOOKS = {
    "original": LineStyle(COMPLIANT),
    "published": LineStyle(COMPENSATED, "solid", 2.6),
    "converged": LineStyle(RIGID, "dash", 2.4),
}


def _law_looks(envelope: Envelope) -> dict[str, LineStyle]:
    others = iter(_OTHERS * len(envelope.laws))
    return {name: _LOOKS.get(name) or LineStyle(next(others), "dashdot") for name in envelope.laws}


def by_angle(envelope: Envelope, units: UnitSystem) -> go.Figure:
    """Share that passes with the nominal plant over the release angle."""
    picture, points = go.Figure(), envelope.by_angle
    angles = [ANGLE.from_si(point.release_rad, units) for point in points]
    curves = {
        name: ([100 * point.passes[name] for point in points], each) for name, each in _law_looks(envelope).items()
    }
    curves["allowed by drive and sensors"] = [100 * point.allowed for point in points], LineStyle(IDEAL, "dot")
    for name, (shares, each) in curves.items():
        picture.add_scatter(
            x=angles, y=shares, mode="lines+markers", name=name, line=line(each), hovertemplate="%{y:.1f} %"
        )
    frame(picture, 300, top=40)
    picture.update_xaxes(
        type="log",
        title_text=f"Angle of the release, {ANGLE.shown(units)}",
        tickvals=angles,
        ticktext=[to_text(angle, 3) for angle in angles],
        hoverformat=".3~g",
    )
    picture.update_yaxes(title_text="Settings that pass, %", range=[0, 103])
    return picture


def impedance(envelope: Envelope) -> go.Figure:
    """Phase of the grip impedance at the loader's own setting; beyond 90 deg the grip feeds energy into the hand."""
    picture = go.Figure()
    for name, look in _law_looks(envelope).items():
        grip = envelope.passivity[name]
        add_curve(
            picture, grip.frequency_hz, grip.phase_deg, name if grip.stable else f"{name} (unstable)", look, "%{y:.1f}°"
        )
    add_curve(
        picture,
        grip.frequency_hz,
        _ideal_phase(envelope, grip.frequency_hz),
        "I, B, G alone",
        LineStyle(IDEAL, "dot"),
        "%{y:.1f}°",
    )
    frame(picture, 380, top=40)
    for low, high in ((-180, -90), (90, 180)):
        picture.add_hrect(low, high, fillcolor="#F3D6D2", opacity=0.55, line_width=0, layer="below")
    picture.add_vline(ARM_HZ, line={"color": "#6B7580", "dash": "dash", "width": 1})
    ticks = [0.05, 0.1, 0.5, 1, 5, 10, 50, 100, 500]
    picture.update_xaxes(
        type="log",
        title_text="Frequency, Hz",
        range=np.log10(grip.frequency_hz[[0, -1]]).tolist(),
        tickvals=ticks,
        ticktext=[f"{tick:g}" if tick not in {0.05, 0.5, 5, 50, 500} else "" for tick in ticks],
        hoverformat=".3~g",
    )
    picture.update_yaxes(title_text="Phase of Z, deg", range=[-180, 180], tickvals=[-180, -90, 0, 90, 180])
    return picture


def _ideal_phase(envelope: Envelope, frequency_hz: NDArray[np.float64]) -> NDArray[np.float64]:
    """Phase of ``Z = I s + B + G / s``; the lever arm does not change it."""
    inertia, damping, stiffness = (envelope.plan.given[key] for key in FEEL_SETTING)
    s = 2j * np.pi * frequency_hz
    return np.asarray(np.degrees(np.angle(inertia * s + damping + stiffness / s)))
