"""Each force of the feel that builds up over a travel stands in every list of them: a new one cannot be forgotten."""

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.laws.made_for import design_rows
from forcefeel.laws.sampled import torque_mode
from forcefeel.loader.consistency import without_effect
from forcefeel.loader.parameters import TABLE

ROUNDING = 1e-12  # relative

STICK = ff.loader.electric("sidestick-pitch")
TRAVEL = "_travel"
TRAVELS = [key for key, row in TABLE.items() if row.part == "feel" and key.endswith(TRAVEL)]


def force_of(travel):
    """The row of the force that builds up over a travel."""
    name = travel.removesuffix(TRAVEL)
    return name if name in TABLE else f"{name}_force"


def test_ramps_cover_the_nonlinear_feel_forces():
    assert {force_of(travel) for travel in TRAVELS} >= {"feel.breakout", "feel.detent_force", "feel.hysteresis"}


@pytest.mark.parametrize("travel", TRAVELS)
def test_ramp_increases_the_feel_slope_of_a_motor(travel):
    """By its force over its travel at the grip, in the law that depends on the steepest slope."""
    plain = STICK.replace({force_of(key): 0.0 for key in TRAVELS}, si=True)
    force, length = 3.0, 0.01
    steep = plain.replace({force_of(travel): force, travel: length}, si=True)
    added = torque_mode._steepest(steep, np.ones(1)) - torque_mode._steepest(plain, np.ones(1))
    assert added == pytest.approx(force / length * STICK["column.grip_arm"], rel=ROUNDING)
    assert {travel, force_of(travel)} <= design_rows(steep).keys()


@pytest.mark.parametrize("travel", TRAVELS)
def test_travel_without_its_force_has_no_effect(travel):
    assert travel in without_effect({travel: 0.01})
