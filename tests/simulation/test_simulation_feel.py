"""The feel programmed anew while the column moves: no bump, and then the new feel; runs that start held or at rest."""

import numpy as np
import pytest

from forcefeel.errors import InputError
from forcefeel.simulation import FeelChange, Scenario, simulate
from forcefeel.simulation.inputs import Chirp, HandsOff, Release, Schedule
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
def test_feel_change_is_bumpless_and_reaches_new_feel(name):
    change = FeelChange(1.2, CHANGES[name], 0.5)
    changed = simulate(LOADER, Scenario(PULL, 6.0, feel_changes=(change,)))
    before = simulate(LOADER, Scenario(PULL, 6.0))
    after = simulate(LOADER.replace(CHANGES[name], si=True), Scenario(PULL, 6.0))
    jumps = [np.abs(np.diff(acceleration(run))) for run in (changed, before, after)]
    # At the ends of the fade, where a feel swapped at once would jump.
    for at in (1200, 1700):
        natural = max(jump[at - 20 : at + 20].max() for jump in jumps[1:])
        assert jumps[0][at - 3 : at + 3].max() < 2 * natural + 0.5  # V/s^2 per step; friction at once: 30
    theta = [run.history.column_angle_rad.values for run in (changed, before, after)]
    np.testing.assert_array_equal(theta[0][:1200], theta[1][:1200])
    assert np.abs(theta[1] - theta[2]).max() > 1e-3
    assert np.abs(theta[0] - theta[2])[5500:].max() < 1e-4  # what swung on the way has died out


# Limits that hold from the end of a change on: 0.1 rad/s, 0.02 rad, 0.02 rad/s, where the pull alone goes to 0.26 rad/s, 0.07 rad.
PER_ANGLE = LOADER["potentiometer.gain"] * LOADER["linkage.ratio"] * LOADER["column.base_arm"]
LIMIT, STOP = 0.1, 0.02
TAKES_HOLD_S = 0.02
LAG_RAD = 1e-4
"""A column lags a neutral that moves on at 0.001 rad/s by B / G, 0.03 s of it. Measured: 3e-5."""
ROUNDING = 1e-12  # effects that are in play only later may round otherwise


def control(run):
    """Angle, velocity and acceleration of the programmed control, rad."""
    velocity = run.history.feel_velocity_v_per_s.values / PER_ANGLE
    return run.history.feel_position_v.values / PER_ANGLE, velocity, np.diff(velocity) / 1e-3


@pytest.mark.parametrize("done", [1700, 1900])
def test_velocity_limit_engages_without_velocity_jump(done):
    """Programmed while the control is slower than it (1.7 s) and twice as fast (1.9 s)."""
    change = FeelChange(done * 1e-3 - 0.5, {"feel.velocity_limit": LIMIT}, 0.5)
    run, free = (simulate(LOADER, Scenario(PULL, 6.0, feel_changes=changes)) for changes in ((change,), ()))
    _, velocity, slowing = control(run)
    np.testing.assert_allclose(velocity[: done + 1], control(free)[1][: done + 1], rtol=0, atol=ROUNDING)
    beyond = max(abs(velocity[done]) - LIMIT, 0.0)
    held = (
        np.abs(control(free)[2]).max() + LIMIT / 1e-3 * 1e-2
    )  # what the pull asks for, and friction of the limit's corner
    assert np.abs(slowing[done : done + 300]).max() < 2 * held + 2 * beyond / TAKES_HOLD_S
    assert np.abs(velocity[done + 5 * round(TAKES_HOLD_S / 1e-3) :]).max() < LIMIT * 1.01
    column = run.history.column_velocity_rad_per_s.values
    assert np.abs(np.diff(column))[done - 3 : done + 300].max() < 0.1 * max(LIMIT, abs(velocity[done]))


def test_stop_programmed_behind_control_lets_control_return():
    """At 1.7 s the control is at -0.056 rad on its way back: nothing moves it but the pull, and then the stop holds."""
    stops = {"feel.hard_stop_low": -STOP, "feel.hard_stop_high": STOP}
    run, free = (
        simulate(LOADER, Scenario(PULL, 6.0, feel_changes=changes)) for changes in ((FeelChange(1.2, stops, 0.5),), ())
    )
    (angle, _, _), (freely, _, _) = control(run), control(free)
    assert angle[1700] < -2 * STOP
    back = int(np.flatnonzero(angle[1700:] >= -STOP)[0]) + 1700
    np.testing.assert_allclose(angle[: back + 1], freely[: back + 1], rtol=0, atol=ROUNDING)
    assert (angle[back:] >= -STOP - ROUNDING).all()
    assert (angle[back:] <= STOP + ROUNDING).all()


def test_stop_change_does_not_accelerate_control():
    """At 1.5 s it moves on outwards, beyond the new stop: it slows down over some hundredths of a second, and comes back."""
    stops = {"feel.hard_stop_low": -STOP, "feel.hard_stop_high": STOP}
    run = simulate(LOADER, Scenario(PULL, 6.0, feel_changes=(FeelChange(1.0, stops, 0.5),)))
    angle, velocity, _ = control(run)
    assert velocity[1499] < 0
    assert angle[1500] < -2 * STOP
    jumps = np.abs(np.diff(velocity[1490:1700]))
    assert jumps.max() < 0.06 * np.abs(velocity[1499])  # 1 ms of 20 ms, and what moves it anyway
    back = int(np.flatnonzero(angle[1500:] >= -STOP)[0]) + 1500
    assert (velocity[1650:back] > -1e-3 * np.abs(velocity[1499])).all()
    assert np.abs(np.diff(angle)).max() <= np.abs(velocity).max() * 1e-3 * 1.01
    assert angle[back + 10 :].min() > -STOP * 1.001
    assert angle[back + 10 :].max() < STOP * 1.001


def test_trim_rate_cannot_be_switched_off_while_trimming():
    loader = LOADER.replace({"feel.trim_rate": 0.02}, si=True)
    trim = Schedule((0.0, 1.0, 1.0), (0.0, 0.0, 0.1))
    change = FeelChange(1.7, {"feel.trim_rate": None}, 0.5)
    with pytest.raises(InputError, match=r"feel\.trim_rate: .*would jump.*give a rate"):
        simulate(loader, Scenario(HandsOff(), 8.0, trim_rad=trim, feel_changes=(change,)))


@pytest.mark.parametrize(("before", "after"), [(0.02, 0.05), (0.02, 0.001), (None, 0.02)])
def test_trim_rate_change_while_trimming_is_bumpless(before, after):
    """The neutral goes on from where it is: its velocity changes, the spring's force does not jump."""
    trim = Schedule((0.0, 1.0, 1.0), (0.0, 0.0, 0.1))
    loader = LOADER.replace({"feel.trim_rate": before}, si=True)
    change = FeelChange(1.7, {"feel.trim_rate": after}, 0.5)
    run, as_was = (simulate(loader, Scenario(HandsOff(), 8.0, trim_rad=trim, feel_changes=c)) for c in ((change,), ()))
    (angle, _, swing), (_, _, naturally) = control(run), control(as_was)
    np.testing.assert_allclose(angle[:2201], control(as_was)[0][:2201], rtol=0, atol=ROUNDING)
    jump, natural = (np.abs(np.diff(a))[2150:2400].max() for a in (swing, naturally))
    per_radian = LOADER["feel.stiffness"] / LOADER["feel.inertia"]  # of the neutral, 160 rad/s^2: at once it would be 9
    assert jump < natural + per_radian * 1e-3 * abs(after - (before or 0.0)) + 0.02
    reached = 0.1 if before is None else min(0.02 * 1.2 + after * 5.8, 0.1)
    assert angle[-1] == pytest.approx(reached, abs=LAG_RAD)


@pytest.mark.parametrize("gains", [None, GAINS], ids=["original", "feedback"])
@pytest.mark.parametrize("angle", [-0.1, 0.1])
def test_grip_is_held_until_release(angle, gains):
    machine = Machine(gains=gains, orifice=True, coulomb_friction=2.0, backlash=0.002, gravity_torque=50.0)
    run = simulate(loader_of(machine), Scenario(Release(angle, 0.1), 1.0), law_of(machine))
    theta = run.history.column_angle_rad.values
    np.testing.assert_allclose(theta[:101], angle, rtol=0, atol=ROUNDING)
    assert abs(theta[150] - angle) > 0.005
    at_once = simulate(
        loader_of(machine), Scenario(Release(angle), 0.9), law_of(machine)
    ).history.column_angle_rad.values
    np.testing.assert_allclose(theta[100:], at_once, rtol=0, atol=ROUNDING)


@pytest.mark.parametrize("gains", [None, GAINS], ids=["original", "feedback"])
def test_hands_off_run_stays_at_rest(gains):
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
    assert np.ptp(theta) < ROUNDING
