"""Dry friction of the column that a law knows: releases that are rendered with and without, hands that feel it or do not."""

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.envelope.plan import make_plan
from forcefeel.envelope.run import compute_few
from forcefeel.laws.law import Law
from forcefeel.laws.sampled.methods import METHODS, Method
from forcefeel.simulation.inputs import Recorded

GRID = {"stiffness": "5, 12, 30 %", "frequency": "0.7, 2 Hz", "damping": "0.3, 0.7"}
FRICTION = {"column.coulomb_friction": "1 lb", "column.static_friction": "1.2 lb"}
"""An eighth of the force with which the softest of these feels lets go of the elevator at 10 deg."""
NONE = dict.fromkeys(FRICTION)


def rendered(machine, law):
    """Share of the settings whose release is within tolerance, nominal."""
    plan = make_plan(machine, [law] if isinstance(law, str) else {"law": law}, GRID, arms=())
    object.__setattr__(plan, "cases", plan.cases[:1])
    return compute_few(plan).shares(next(iter(plan.compensators))).passes


PLAIN = Method(
    "plain", "of the loader without its friction", lambda it, feel: METHODS["robust"].design(it.replace(NONE), feel)
)


@pytest.mark.parametrize("name", ["elevator-2khz", "elevator-electric"])
def test_friction_that_the_law_knows_is_hardly_felt(name):
    loader = ff.digital_elevator() if name == "elevator-2khz" else ff.loader.electric(name)
    loader = loader.replace(FRICTION)
    assert rendered(loader, PLAIN) < 0.5
    assert rendered(loader, "robust") > 0.8  # of 12 settings 12 and 10


def test_a_hand_finds_the_programmed_curve_but_for_the_breakaway():
    """Slowly to and fro: where the column moves, the width of the loop is the damping's alone; without, twice the friction more."""
    feel = {"feel.inertia": 0.5, "feel.damping": 3.0, "feel.stiffness": 20.0}
    loader = ff.digital_elevator().replace(feel | FRICTION)
    time = np.linspace(0.0, 10.0, 2001)
    force = 20.0 * np.sin(2 * np.pi * 0.2 * time)
    off = {}
    for known, law in (("friction", Law.of("robust", loader)), ("none", Law.of("robust", loader.replace(NONE)))):
        history = ff.simulate(loader, ff.Scenario(Recorded(time, force), 10.0, 5e-4, 5e-3), law).history
        angle, rate = history.column_angle_rad.values, history.column_velocity_rad_per_s.values
        torque = 20.0 * angle + 3.0 * rate
        moving = (np.abs(rate) > 0.2 * np.abs(rate).max()) & (history.time_s.values > 5.0)
        push = np.interp(history.time_s.values, time, force)
        off[known] = np.mean((push - torque / loader["column.grip_arm"]) * np.sign(rate), where=moving)
    assert off["none"] == pytest.approx(loader["column.coulomb_friction"], rel=0.05)  # the noise of the sensors
    assert abs(off["friction"]) < 0.05 * loader["column.coulomb_friction"]


def test_it_goes_through_the_file_and_between_two_laws(tmp_path):
    loader = ff.digital_elevator().replace(FRICTION)
    law = Law.of("robust", loader)
    law.save(tmp_path / "law.json")
    again = Law.of(tmp_path / "law.json", loader)
    np.testing.assert_array_equal(again.sampled.rows(), law.sampled.rows())
    other = Law.of("robust", loader.replace({"column.coulomb_friction": "2 lb", "column.static_friction": None}))
    level = law.sampled.between(other.sampled, 0.5).friction[0, -4]
    assert level == pytest.approx(1.5 * loader["column.coulomb_friction"] * loader["column.grip_arm"])
