"""The pictures of a commissioning: the identified curve over the bench data, and the settings that the law renders."""

import math

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from forcefeel.bench.channels import channel_unit
from forcefeel.commission.result import Curve, EnvelopeResult
from forcefeel.envelope.result import COLORS
from forcefeel.loader.loader import Loader
from forcefeel.page.canvas import add_curve, frame
from forcefeel.page.palette import COMPENSATED, IDEAL, LineStyle
from forcefeel.page.setting_maps import SettingMaps
from forcefeel.page.typography import unit_text
from forcefeel.units import UnitSystem

_STYLES = {
    "measured": LineStyle("#8DBBDD", "solid", 3.4),
    "loader file": LineStyle(IDEAL, "dash", 1.6),
    "identified": LineStyle(COMPENSATED, "solid", 1.8),
}


def curve(data: Curve, units: UnitSystem) -> go.Figure:
    """Measured, by the loader file and identified: a record over time, or gain and phase over frequency."""
    curves = {"measured": data.measured, "loader file": data.before, "identified": data.modeled}
    parts = 2 if data.response else 1
    picture = make_subplots(rows=parts, cols=1, shared_xaxes=True, vertical_spacing=0.06)
    unit = channel_unit(data.channel)
    for name, values in curves.items():
        rows = (
            (20 * np.log10(np.array(values[0])), np.degrees(values[1]))
            if data.response
            else (unit.from_si(1.0, units) * np.array(values[0]),)
        )
        for row, numbers in enumerate(rows, 1):
            add_curve(picture, data.at, numbers, name, _STYLES[name], "%{y:.4~g}", showlegend=row == 1, row=row, col=1)
    frame(picture, 440 if data.response else 340, top=60)
    if data.response:
        picture.update_yaxes(title_text="Gain, dB re 1 SI unit", row=1, col=1)
        picture.update_yaxes(title_text="Phase, deg", row=2, col=1)
        ends = [math.log10(data.at[0]), math.log10(data.at[-1])]
        ticks = [10.0**power for power in range(math.floor(ends[0]), math.ceil(ends[1]) + 1)]
        picture.update_xaxes(type="log", range=ends, tickvals=ticks, ticktext=[f"{tick:g}" for tick in ticks])
        picture.update_xaxes(title_text="Frequency, Hz", row=2, col=1)
    else:
        picture.update_yaxes(
            title_text=f"{data.channel.replace('_', ' ').capitalize()}, {unit_text(unit.shown(units))}"
        )
        picture.update_xaxes(title_text="Time, s", range=[data.at[0], data.at[-1]])
    return picture


def outcome_maps(envelope: EnvelopeResult, law: str, loader: Loader) -> SettingMaps | None:
    """The map of the law over the settings; ``None`` if the result has none."""
    outcomes = envelope.outcomes
    if outcomes is None:
        return None
    return SettingMaps(
        stiffness=outcomes.stiffness,
        frequency=outcomes.frequency,
        damping=outcomes.damping,
        colors=COLORS,
        cells={law: np.array(outcomes.kinds, dtype=np.int8)},
        loader=loader,
    )
