"""Maneuvers: a release against JSBSim with the elevator balanced here, modes against a linear model's, levers."""

from types import SimpleNamespace

import jsbsim
import numpy as np
import pytest

import forcefeel as ff
from forcefeel.fly import maneuvers
from forcefeel.fly.aircraft import silent
from tests.fly.test_modes import stick_free

FT, KNOT = 0.3048, 1852 / 3600
SPEED, ALTITUDE = 100 * KNOT, 900.0
AREA, CHORD, TAIL = 14.5 * FT**2, 1.2 * FT, 15.7 * FT
QUASI_STEADY = 0.005
"""Here the elevator has neither inertia nor damping."""

CLOSE = 0.03
"""A pulse of 0.1 g is not small; sensors and delay of a loader without friction."""


@pytest.fixture(scope="module")
def case():
    return ff.fly.FlightCase(ff.digital_elevator(), "c172p", SPEED, ALTITUDE, "robust")


def trimmed(speed):
    model = jsbsim.FGFDMExec(None)
    model.set_debug_level(0)
    model.load_model("c172p")
    model.set_dt(0.002)
    model["ic/vc-kts"], model["ic/h-sl-ft"], model["ic/gamma-deg"] = speed / KNOT, ALTITUDE / FT, 0.0
    model["propulsion/fuel_freeze"] = 1
    model.run_ic()
    model["propulsion/set-running"] = -1
    model["simulation/do_simple_trim"] = 1
    return model


def flow(model):
    return 0.6 * model["aero/alpha-rad"] + TAIL * model["velocities/q-rad_sec"] / (model["velocities/vt-fps"] * FT)


@pytest.mark.slow
def test_release_flies_as_jsbsim_with_a_balanced_elevator(case):
    """``G theta = R F + q S c (C_alpha (alpha_s - alpha_s0) + C_delta theta)`` gives the elevator in each frame."""
    release = ff.fly.fly_maneuver(case, "release", ff.fly.ManeuverRequest(off_trim=0.85))
    still, model = trimmed(SPEED), trimmed(0.85 * SPEED)
    at_zero, neutral, tab = flow(still), still["fcs/elevator-pos-rad"], model["fcs/pitch-trim-cmd-norm"]
    model["fcs/throttle-cmd-norm"] = still["fcs/throttle-cmd-norm"]
    speeds, ailerons = [], model["fcs/aileron-cmd-norm"]
    for force in release.alone.force_n:
        speeds.append(model["velocities/vc-kts"] * KNOT)
        moment = model["aero/qbar-psf"] * 4.4482216152605 / FT**2 * AREA * CHORD
        arm = case.feel["column.grip_arm"]
        angle = neutral + (arm * force - 0.1 * moment * (flow(model) - at_zero)) / (30.0 + 0.3 * moment)
        # The wings are held level.
        level = model["attitude/phi-rad"] + 0.5 * model["velocities/p-rad_sec"]
        model["fcs/aileron-cmd-norm"] = ailerons - level
        model["fcs/elevator-cmd-norm"] = (angle / 0.40135 if angle > 0 else angle / 0.48869) - tab
        model.run()
    for flown in (release.flown, release.alone):
        assert flown.states["calibrated_airspeed"] == pytest.approx(np.array(speeds), rel=QUASI_STEADY)
    measures = {measure.name: measure for measure in release.measures}
    returned = measures["speed of return"]
    assert min(speeds[5000:]) < returned.with_loader < max(speeds[5000:])
    assert measures["off the trim speed"].with_loader == pytest.approx(returned.with_loader / SPEED - 1)


@pytest.mark.slow
def test_friction_keeps_a_released_column_off_and_a_pulse_from_moving_it():
    """8 lb hold more than the air of 85 % of the speed; the hand has to overcome them before the flight begins."""
    loader = ff.digital_elevator().replace({"column.coulomb_friction": "8 lb"})
    case = ff.fly.FlightCase(loader, "c172p", SPEED, ALTITUDE, "robust")
    release = ff.fly.fly_maneuver(case, "release", ff.fly.ManeuverRequest(off_trim=0.85))
    assert release.flown.angle_rad[0] == pytest.approx(
        release.alone.angle_rad[0], rel=0.06
    )  # as near as a hand brings it
    assert abs(release.flown.angle_rad[-1]) > 0.005 > 10 * abs(release.alone.angle_rad[-1])
    pulse = ff.fly.fly_maneuver(case, "short-period")
    assert abs(pulse.flown.angle_rad).max() < 0.05 * abs(pulse.alone.angle_rad).max()
    assert not any("mode" in measure.name for measure in pulse.measures)


@pytest.mark.slow
def test_stick_free_modes_are_those_of_a_linear_model(case):
    """Of JSBSim's derivatives with the column free: phugoid, short period, column."""
    phugoid, *quick = stick_free("c172p", case.feel)
    period, damping = ff.fly.fly_maneuver(case, "phugoid").measures
    for period_s in (period.with_loader, period.alone):
        assert period_s == pytest.approx(2 * np.pi / phugoid.imag, rel=0.01)  # of the speed that the pulse left
    measures = {measure.name: measure for measure in ff.fly.fly_maneuver(case, "short-period").measures}
    dampings = [damping, *(measures[f"damping ratio of mode {k}"] for k in (1, 2))]
    for measure, pole in zip(dampings, (phugoid, *quick), strict=True):
        assert measure.alone == pytest.approx(-pole.real / abs(pole), rel=CLOSE)
        assert measure.with_loader == pytest.approx(measure.alone, rel=CLOSE)
    for k, pole in enumerate(quick, 1):
        frequency = measures[f"frequency of mode {k}"]
        assert frequency.alone == pytest.approx(abs(pole), rel=CLOSE)
        assert frequency.with_loader == pytest.approx(frequency.alone, rel=CLOSE)


def test_wind_up_turn_banks_to_the_load_factor(case):
    turn = ff.fly.fly_maneuver(case, "wind-up-turn", ff.fly.ManeuverRequest(load_factor=1.3))
    measures = {measure.name: measure.alone for measure in turn.measures}
    assert np.cos(measures["bank"]) == pytest.approx(1 / 1.3, rel=0.04)  # the bank lags by a second of the six
    assert measures["load factor"] == pytest.approx(1.3, abs=0.07)  # of a pilot in no hurry
    assert measures["force"] < -5


@pytest.mark.slow
def test_levers_move_and_the_hand_is_off(case):
    for name, key, sign in (("power", "altitude", 1), ("flaps", "pitch_attitude", -1)):
        flown = ff.fly.fly_maneuver(case, name).flown
        assert not flown.force_n.any()
        changes = flown.states[key] - flown.states[key][0]
        assert abs(changes[: round(5 / ff.fly.FRAME_S)]).max() < 0.05 * abs(changes).max()
        assert sign * changes[-1] > 0


def test_speed_brake_goes_out_and_in_each_with_fifteen_seconds_after(case):
    """14 CFR Part 60, App. A, 2.c.3: free response from 5 s before each change to 15 s after it."""
    with pytest.raises(ff.InputError, match="c172p has no speed brake that a lever moves"):
        ff.fly.fly_maneuver(case, "speed-brake")
    brakes = ff.fly.FlightCase(ff.digital_elevator(), "T38", 300 * KNOT, 3048.0, "robust")
    plan, moved = maneuvers.MANEUVERS["speed-brake"](brakes, ff.fly.ManeuverRequest()), []
    recorder = SimpleNamespace(set_speed_brake=moved.append)
    for time in (0, 5, 5.5, 6, 21, 21.75, 22, 37):
        plan.levers(time, recorder)
    assert moved == [0, 0, 0.5, 1, 1, 0.25, 0, 0]
    assert plan.lasts_s == 37


def test_speed_brake_slows_the_aircraft():
    still, braked = (ff.fly.Aircraft("T38", 300 * KNOT, 3048.0) for _ in range(2))
    braked.set_speed_brake(1.0)
    with silent():
        for aircraft in (still, braked):
            for _ in range(500):
                aircraft.fly(aircraft.trimmed)
    lost = still.attitude()["calibrated_airspeed"] - braked.attitude()["calibrated_airspeed"]
    assert lost > 0.5  # m/s in a second: a third of a g at most


@pytest.mark.slow
def test_gear_goes_up_as_in_jsbsim_with_a_balanced_stick():
    """The T38's stick has its bobweight: ``G theta = -R W (n - n_0) - q S c (C_delta theta + tab)``; less drag, a new pitch."""
    case = ff.fly.FlightCase(ff.digital_elevator(), "T38", 300 * KNOT, 3048.0, "robust")
    speed = ff.fly.fly_maneuver(case, "gear").alone.states["calibrated_airspeed"]
    model = jsbsim.FGFDMExec(None)
    model.set_debug_level(0)
    model.load_model("T38")
    model.set_dt(0.002)
    model["ic/vc-kts"], model["ic/h-sl-ft"], model["ic/gamma-deg"] = 300.0, 3048 / FT, 0.0
    model["propulsion/fuel_freeze"] = 1
    model.run_ic()
    model["propulsion/set-running"] = -1
    model["simulation/do_simple_trim"] = 1
    pressure = 4.4482216152605 / FT**2 * 0.5 * 1.3 * FT**3
    ailerons, command, trim = (model[f"fcs/{key}-cmd-norm"] for key in ("aileron", "elevator", "pitch-trim"))
    arm, share = case.feel["column.grip_arm"], command + trim
    tab = -arm * -13.0 * model["accelerations/Nz"] / (model["aero/qbar-psf"] * pressure)
    speeds = []
    for k in range(len(speed)):
        speeds.append(model["velocities/vc-kts"] * KNOT)
        moment = model["aero/qbar-psf"] * pressure
        angle = (13.0 * arm * model["accelerations/Nz"] - moment * tab) / (150.0 + moment)
        model["gear/gear-cmd-norm"] = 1 - min(1.0, max(0.0, (0.002 * k - 5.0)))
        model["fcs/aileron-cmd-norm"] = ailerons - model["attitude/phi-rad"] - 0.5 * model["velocities/p-rad_sec"]
        model["fcs/elevator-cmd-norm"] = share + angle / np.radians(10) - trim
        model.run()
    assert speed == pytest.approx(np.array(speeds), rel=QUASI_STEADY)
    assert abs(speed[-1] - speed[0]) > 0.02 * speed[0]


def test_stall_slows_until_the_wing_no_longer_carries():
    case = ff.fly.FlightCase(
        ff.digital_elevator(), "c172p", 70 * KNOT, ALTITUDE, "robust"
    )  # sooner there than from 100 kt
    measures = {measure.name: measure.alone for measure in ff.fly.fly_maneuver(case, "stall").measures}
    assert 40 * KNOT < measures["smallest calibrated airspeed"] < 60 * KNOT  # its book has 44 to 51 kt
    assert measures["largest pull"] > 20


def test_short_swing_returns_its_last_speed_and_a_damped_one_its_center():
    time = np.arange(0, 60, 0.01)
    from forcefeel.fly.maneuvers import return_speed  # noqa: PLC0415

    assert return_speed(time[:300], 50 + time[:300]) == pytest.approx(52.8, abs=0.3)  # half a second's mean
    swing = 50 + 6 * np.exp(-0.03 * time) * np.cos(0.25 * time)
    assert return_speed(time, swing) == pytest.approx(50, abs=0.02)  # extremes between samples


def test_unknown_maneuver_and_numbers_out_of_range_are_refused(case):
    with pytest.raises(ff.InputError, match="did you mean pull-up"):
        ff.fly.fly_maneuver(case, "pullup")
    for numbers, part in (({"load_factor": 1.0}, "load factor"), ({"off_trim": 1.0}, "off trim")):
        with pytest.raises(ff.InputError, match=part):
            ff.fly.ManeuverRequest(**numbers)
