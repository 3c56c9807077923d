"""The feel programmed anew while the column moves: no bump, and then the new feel; runs that start held or at rest."""

import numpy as np
import pytest

from forcefeel.inputs import Chirp, HandsOff, Release
from forcefeel.simulation import FeelChange, Scenario, simulate
from tests.nonlinear_witness import Machine
from tests.side_by_side import DEG, GAINS, law_of, loader_of

CHANGES = {
    "stiffness": {"feel.stiffness": 2000.0},
    "inertia": {"feel.inertia": 10.0},
    "damping": {"feel.damping": 100.0},
    "preload": {"feel.preload": 20.0},
    "breakout": {"feel.breakout": 10.0},
    "friction": {"feel.coulomb_friction": 10.0},
    "hysteresis": {"feel.hysteresis": 20.0},
    "quadratic damping": {"feel.quadratic_damping": 1000.0},
    "soft stops": {"feel.soft_stop_low": -0.03, "feel.soft_stop_high": 0.03},
}
PULL = Chirp(150.0, 0.5, 0.5, 6.0)
LOADER = loader_of(Machine(orifice=True))


def acceleration(run):
    return np.diff(run.history.feel_velocity_v_per_s.values) / 1e-3


@pytest.mark.parametrize("name", CHANGES)
def test_change_does_not_bump_and_then_is_the_new_feel(name):
    change = FeelChange(1.2, CHANGES[name], 0.5)
    changed = simulate(LOADER, Scenario(PULL, 6.0, feel_changes=(change,)))
    before = simulate(LOADER, Scenario(PULL, 6.0))
    after = simulate(LOADER.replace(CHANGES[name]), Scenario(PULL, 6.0))
    jumps = [np.abs(np.diff(acceleration(run))) for run in (changed, before, after)]
    # At the ends of the fade, where a feel swapped at once would jump.
    for at in (1200, 1700):
        natural = max(jump[at - 20 : at + 20].max() for jump in jumps[1:])
        assert jumps[0][at - 3 : at + 3].max() < 2 * natural + 0.5  # V/s^2 per step; friction at once: 30
    theta = [run.history.column_angle_rad.values for run in (changed, before, after)]
    np.testing.assert_array_equal(theta[0][:1200], theta[1][:1200])
    assert np.abs(theta[1] - theta[2]).max() > 1e-3
    assert np.abs(theta[0] - theta[2])[5500:].max() < 1e-4  # what swung on the way has died out


@pytest.mark.parametrize("gains", [None, GAINS], ids=["original", "feedback"])
@pytest.mark.parametrize("angle", [-0.1, 0.1])
def test_grip_is_held_until_it_is_let_go(angle, gains):
    machine = Machine(gains=gains, orifice=True, coulomb_friction=2.0, backlash=0.002, gravity_torque=50.0)
    run = simulate(loader_of(machine), Scenario(Release(angle, 0.1), 1.0), law_of(machine))
    theta = run.history.column_angle_rad.values
    np.testing.assert_allclose(theta[:101], angle, rtol=0, atol=1e-9)
    assert abs(theta[150] - angle) > 0.005
    at_once = simulate(
        loader_of(machine), Scenario(Release(angle), 0.9), law_of(machine)
    ).history.column_angle_rad.values
    np.testing.assert_allclose(theta[100:], at_once, rtol=0, atol=2e-5)


@pytest.mark.parametrize("gains", [None, GAINS], ids=["original", "feedback"])
def test_nobody_at_the_grip_is_rest(gains):
    machine = Machine(
        gains=gains,
        orifice=True,
        gravity_torque=200.0,
        gravity_angle=20 * DEG,
        feel_preload=3.0,
        feel_soft_stop_high=0.0,
        load_cell_offset=1.0,
        potentiometer_offset=0.01,
    )
    theta = simulate(loader_of(machine), Scenario(HandsOff(), 2.0), law_of(machine)).history.column_angle_rad.values
    assert abs(theta[0]) > 1e-4
    assert np.ptp(theta) < 1e-12
