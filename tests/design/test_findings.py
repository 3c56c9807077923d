"""The conclusions in words, and the data behind the figures."""

from dataclasses import replace

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.laws.analog import recursion
from forcefeel.loader.beyond_linear import left_out
from tests.parametrization import mostly_slow

LINK_DB = 2e-3
"""The link bends by (f / f_n)^2, f_n being its 12 Hz, which at the figures' lowest frequency of 0.1 Hz is 6e-4 dB."""

HEAVY = {
    "feel.inertia": "240 lb in s^2/rad",
    "feel.damping": "1216 lb in s/rad",
    "feel.stiffness": "38400 lb in/rad",
    "feel.maximum_stiffness": "288000 lb in/rad",
}
"""A feel beside which the column's own inertia is small."""


@pytest.fixture(scope="module")
def loader():
    return ff.elevator()


@pytest.fixture(scope="module")
def found(loader):
    return ff.design_loader(loader)


def said(design):
    return ff.design.conclusions(design, ff.UnitSystem.US)


@pytest.mark.slow
def test_elevator_is_statically_accurate_but_dynamically_wrong(found):
    words = said(found)
    assert words.ok
    assert words.verdict.endswith("settles at the programmed deflection, but its frequency is wrong.")
    text = " ".join(words.findings)
    for figure in (
        "11.4 Hz",
        "10.8 Hz",
        "60.6 %",
        "319.9 lb in/rad",
        "3792 lb in/rad",
        "1.62 Hz",
        "1.58 Hz",
        "1699",
        "70.8 %",
    ):
        assert figure in text
    assert "c_2 and c_6 can be dropped" in text


@pytest.mark.parametrize(
    ("changes", "settings", "verdict"),
    mostly_slow(
        [
            ({}, ff.laws.DesignSettings(), "does not settle"),
            ({"valve.natural_frequency": "5 rad/s"}, None, "do not close this loop"),
            ({}, ff.laws.DesignSettings(r2=1e4), "no gains to evaluate"),
            (HEAVY, ff.laws.DesignSettings(r2=0.14), "at rest and in motion"),
        ]
    ),
)
def test_verdict_matches_each_case(loader, changes, settings, verdict, monkeypatch):
    monkeypatch.setattr(recursion, "MOST_STEPS", 1_000_000)  # of one that never settles
    words = said(ff.design_loader(loader.replace(changes, si=True), settings))
    assert verdict in words.verdict
    assert words.ok is (verdict in {"does not settle", "at rest and in motion"})


@pytest.mark.slow
def test_stiff_link_is_reported_as_rigid(loader):
    stiff = loader.replace({"linkage.stiffness": "1e8 lb/in", "linkage.damping": "3000 lb s/in"})
    assert said(ff.design_loader(stiff)).findings[0].startswith("The linkage is nearly rigid")


@pytest.mark.slow
def test_tangent_in_figure_2_touches_its_curve(loader):
    other = loader.replace({"valve.pressure_gain": "0.05 in^5/(lb s)"})
    curves = ff.design.figures(ff.design_loader(other))[0].curves
    curve, line = (curves[name]["flow_m3_per_s"] for name in ("20 % of rated current", "tangent at 20 %, eq. (2)"))
    touch = int(np.argmin(np.abs(curve - line)))
    pressure = curves["20 % of rated current"]["load_pressure_pa"][touch]
    assert pressure == pytest.approx(0.33 * other["valve.supply_pressure"])
    assert np.all(line >= curve - 1e-12)  # the curve bends downwards


def test_column_and_piston_match_at_low_frequency_in_figures_8_and_9(found):
    for figure in ff.design.figures(found)[1:3]:
        piston, column = (figure.curves[f"compliant link, {name}"]["gain_db"][0] for name in ("piston", "column"))
        assert column == pytest.approx(piston, abs=LINK_DB)


@pytest.mark.slow
def test_effects_omitted_by_linear_models_are_reported(loader):
    assert not any("models neglect" in finding for finding in said(ff.design_loader(loader)).findings)
    curve = ff.loader.Curve((-0.5, 0.0, 0.5), (-300.0, 0.0, 200.0))
    more = replace(loader.replace({"valve.orifice": True}), force_curve=curve)
    assert said(ff.design_loader(more)).findings[-1] == (
        "The linear models neglect valve.orifice and feel.force_curve; forcefeel simulate includes them."
    )
    assert left_out(loader.replace({"valve.orifice": True})).startswith("The linear models neglect valve.orifice;")
    many = more.replace({"column.coulomb_friction": "3 lb", "feel.breakout": "1 lb", "feel.deadband": "1 deg"})
    assert "column.coulomb_friction, feel.deadband and 2 more of the loader's optional rows;" in left_out(many)
