"""Loaders at the ends of their ranges: what the file allows is answered, without a crash and without a library's warning."""

from contextlib import suppress
from math import exp, log

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import forcefeel as ff
from forcefeel.design import workflow
from forcefeel.design.assessment import assess, peaks
from forcefeel.errors import InputError
from forcefeel.loader.parameters import HYDRAULIC, TABLE, is_switch, limits_si, required, table

PLAIN = ff.elevator().with_tolerances(dict.fromkeys(ff.elevator().tolerances))
SHARE = st.one_of(st.sampled_from([0.0, 1.0]), st.floats(0, 1))
FEW = max(5, settings.default.max_examples // 8)
"""An analysis takes a hundred times as long as a run."""


def at(key: str, share: float) -> float:
    """A value at a share of a row's range, evenly in proportion where the range allows."""
    low, high = limits_si(TABLE[key])
    if is_switch(TABLE[key]):
        return float(share > 0.5)
    return exp(log(low) + share * (log(high) - log(low))) if low > 0 else low + share * (high - low)


DIGITAL = ff.digital_elevator().with_tolerances(dict.fromkeys(PLAIN.tolerances))
ROWS, REQUIRED = tuple(table(HYDRAULIC)), tuple(required(HYDRAULIC))


@st.composite
def loaders(draw, keys=ROWS):
    """A loader with some rows anywhere in their ranges, half of them at the ends."""
    base = draw(st.sampled_from([PLAIN, DIGITAL]))
    chosen = draw(st.lists(st.sampled_from(keys), unique=True, min_size=1, max_size=12))
    changes = {}
    for key in chosen:
        low, high = limits_si(TABLE[key])
        changes[key] = min(max(at(key, draw(SHARE)), low), high)
    try:
        return base.replace(changes)
    except InputError:  # rows that do not go together
        return base


@given(loaders())
@pytest.mark.parametrize("force", [ff.Release(0.1, 0.1), ff.Step(50.0, 0.1)], ids=["release", "step"])
def test_every_loader_runs(force, loader):
    with suppress(InputError):  # a period of which the run has no whole number
        assert ff.simulate(loader, ff.Scenario(force, duration_s=0.2)).status in ff.simulation.RunStatus


@pytest.mark.slow
@given(loaders(REQUIRED))
@settings(max_examples=FEW)
def test_every_loader_is_analyzed(loader):
    found = workflow.analyze(loader)
    for one in found.servos:
        assert one.column_resonance is None or one.column_resonance.frequency_rad_per_s > 0


@given(loaders())
@settings(max_examples=FEW)
def test_every_loader_is_compensated(loader):
    found = ff.design_gains(loader)
    law = found.law(loader)
    judged = assess(loader, law, found.settings)
    if judged.stable:
        peaks(loader, law)


SERVO_AT_REST = {
    "actuator.area": "1000 in^2",
    "actuator.oil_volume": "0.001 in^3",
    "linkage.damping": "0.001 lb s/in",
    "column.inertia": "1e5 lb in s^2",
    "potentiometer.gain": "0.001 V/in",
}


def test_servo_with_slowest_mode_below_rounding_is_analyzed():
    """The pole of the position loop, 1e-9 of the others, comes out as zero: it has no peak."""
    found = workflow.analyze(PLAIN.replace(SERVO_AT_REST))
    assert any(one.column_resonance is None for one in found.servos)


LOST = [
    ("highest linkage.stiffness", "lowest amplifier.admittance", "lowest valve.current_gain"),
    ("highest linkage.stiffness", "lowest linkage.damping", "highest actuator.area"),
    ("highest actuator.area", "highest linkage.stiffness", "lowest potentiometer.gain"),
    ("lowest valve.current_gain", "lowest amplifier.admittance", "lowest potentiometer.gain"),
]
"""Ends of ranges at which the matrices leave no digit of an equilibrium."""


def angle_per_newton(loader):
    """The column's angle at rest under a pilot force of 1 N: every term of it has the same sign, so nothing is lost.

    At rest the load cell holds the grip, F_c = -F_p R_p / (alpha R_b), the feel's spring its voltage, G delta = -G_max K_1 F_c,
    and the valve the actuator's leak, C_i K_2 (delta - K_3 x_p) = C_p F_c / A; the link stretches by F_c / k.
    """
    ratio, arm = loader["linkage.ratio"], loader["column.base_arm"]
    force = -loader["column.grip_arm"] / (ratio * arm)
    delta = -loader["feel.maximum_stiffness"] * loader["load_cell.gain"] * force / loader["feel.stiffness"]
    gain = loader["valve.current_gain"] * loader["amplifier.admittance"]
    piston = (delta - loader["valve.pressure_gain"] * force / (loader["actuator.area"] * gain)) / loader[
        "potentiometer.gain"
    ]
    return (piston - force / loader["linkage.stiffness"]) / ratio / arm


SEARCHED = 1e-6
"""Relative: the engine halves the range in which it looks for an equilibrium until doubles end."""


@pytest.mark.parametrize("ends", [(), *LOST], ids=" ".join)
def test_release_starts_at_held_angle_without_matrix_equilibrium(ends):
    given = (end.split() for end in ends)
    loader = PLAIN.replace({key: limits_si(TABLE[key])[which == "highest"] for which, key in given}, si=True)
    run = ff.simulate(loader, ff.Scenario(ff.Release(0.1, 0.1), duration_s=0.2))
    assert run.method == ("stepped" if ends else "exact")
    assert float(run.history["column_angle_rad"][0]) == pytest.approx(0.1, rel=1e-12)  # some roundings
    assert float(run.history["pilot_force_n"][0]) * angle_per_newton(loader) == pytest.approx(0.1, rel=SEARCHED)
