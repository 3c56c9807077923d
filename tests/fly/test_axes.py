"""Wheel and pedals of JSBSim's c172p, against its own sideslip trims and an aileron or rudder balanced here in each frame."""

from importlib.resources import files

import jsbsim
import numpy as np
import pytest

import forcefeel as ff
from forcefeel.fly.report import fly_rules
from forcefeel.fly.rules import Outcome
from tests.parametrization import mostly_slow

FT, KNOT, PSF = 0.3048, 1852 / 3600, 4.4482216152605 / 0.3048**2
SPEED, ALTITUDE, SLIP = 100 * KNOT, 914.4, np.radians(5)
LOADERS = {"roll": "aileron-wheel", "yaw": "rudder-pedals"}
CONTROLS = {  # position, command, area times chord, gearing, spring, flow by sideslip and by rate times arm
    "roll": ("fcs/left-aileron-pos-rad", "fcs/aileron-cmd-norm", 18.3 * 0.8 * FT**3, 0.25, 4.0, 0.0, ("p", -13 * FT)),
    "yaw": ("fcs/rudder-pos-rad", "fcs/rudder-cmd-norm", 7.4 * FT**3, -1.0, 100.0, -0.9, ("r", 15.7 * FT)),
}
FLOWN = 0.02
"""Of a force: the sideslip reached beside that trimmed."""
CLOSE, PARTS = 0.03, 10
"""Of the largest rate: the loader's delay in a quick push; steps of the witness in a frame."""


def case_of(axis, aircraft="c172p", **changes):
    loader = ff.loader.electric(LOADERS[axis]).replace(changes)
    return ff.fly.FlightCase(loader, aircraft, SPEED, ALTITUDE, "robust", axis)


@pytest.fixture(scope="module", params=mostly_slow(CONTROLS))
def case(request):
    return case_of(request.param)


def trimmed(sideslip=0.0):
    model = jsbsim.FGFDMExec(None)
    model.set_debug_level(0)
    model.load_model("c172p")
    model.set_dt(0.002)
    model["ic/vc-kts"], model["ic/h-sl-ft"], model["ic/gamma-deg"] = SPEED / KNOT, ALTITUDE / FT, 0.0
    if sideslip:
        model["ic/beta-deg"] = np.degrees(sideslip)
    model["propulsion/fuel_freeze"] = 1
    model.run_ic()
    model["propulsion/set-running"] = -1
    model["simulation/do_simple_trim"] = 1
    return model


def air(model, axis):
    """Moment of unit coefficient at the control, N m, and the flow at the surface."""
    _, _, volume, gearing, _, by_slip, (rate, arm) = CONTROLS[axis]
    turning = arm * model[f"velocities/{rate}-rad_sec"] / (model["velocities/vt-fps"] * FT)
    return gearing * model["aero/qbar-psf"] * PSF * volume, by_slip * model["aero/beta-rad"] + turning


def measures_of(maneuver):
    return {measure.name: measure for measure in maneuver.measures}


def test_sideslip_has_the_force_of_the_trim_that_jsbsim_gives(case):
    """``R F = G theta - k q S c (C_alpha (alpha_s - alpha_s0) + C_delta (delta - delta_0))``."""
    position, _, _, gearing, spring, *_ = CONTROLS[case.axis]
    level, slipped = trimmed(), trimmed(SLIP)
    deflection = slipped[position] - level[position]
    moment, flow = air(slipped, case.axis)
    torque = spring * deflection / gearing - moment * (-0.1 * (flow - air(level, case.axis)[1]) - 0.3 * deflection)
    expected = torque / case.feel["column.grip_arm"]
    measures = measures_of(ff.fly.fly_maneuver(case, "sideslip"))
    assert abs(expected) > 10
    for name, number, close in (
        ("force", expected, abs(FLOWN * expected)),
        ("force of the programmed feel in the same states", expected, abs(FLOWN * expected)),
        ("sideslip", slipped["aero/beta-rad"], np.radians(0.05)),
        ("bank", slipped["attitude/phi-rad"], np.radians(0.3)),
        ("control angle", deflection / gearing, np.radians(0.15)),
    ):
        assert measures[name].with_loader == pytest.approx(number, abs=close), name
        assert measures[name].alone == pytest.approx(number, abs=close), name


def test_rate_is_that_of_jsbsim_with_a_free_surface(case):
    """Inertia, damping, spring and ``k q S c (C_alpha (alpha_s - alpha_s0) + C_delta delta + C_rate delta' c / 2 V)``."""
    _, command, _, gearing, spring, _, (rate, _) = CONTROLS[case.axis]
    response = ff.fly.fly_maneuver(case, f"{case.axis}-rate")
    model, feel, chord = trimmed(), case.feel, {"roll": 0.8, "yaw": 1.0}[case.axis] * FT
    share, at_zero, h = model[command], air(model, case.axis)[1], 0.002 / PARTS
    full = abs(case.trim.travel_rad * gearing)  # the same up as down
    angle, speed, rates = 0.0, 0.0, []
    for force in response.alone.force_n:
        rates.append(model[f"velocities/{rate}-rad_sec"])
        moment, flow = air(model, case.axis)
        by_rate = 0.5 * chord / (2 * model["velocities/vt-fps"] * FT)
        for _ in range(PARTS):
            from_air = moment * (-0.1 * (flow - at_zero) - gearing * (0.3 * angle + by_rate * speed))
            torque = feel["column.grip_arm"] * force + from_air - spring * angle - feel["feel.damping"] * speed
            speed += h * torque / feel["feel.inertia"]
            angle += h * speed
        model[command] = share + gearing * angle / full
        model.run()
    rates = np.array(rates)
    for flown in (response.flown, response.alone):
        row = flown.states[f"{case.axis}_rate"]
        assert row == pytest.approx(rates, abs=CLOSE * abs(rates).max())
    assert rates[np.argmax(abs(rates))] > np.radians(3)  # to the right


@pytest.mark.slow
def test_rules_of_wheel_and_pedals_are_met(case):
    report = fly_rules(case)
    assert report.fulfilled
    numbers = {verdict.rule.number for verdict in report.verdicts}
    assert numbers == ({"2.d.2", "2.d.8"} if case.axis == "roll" else {"2.d.6", "2.d.8"})


@pytest.mark.slow
def test_friction_fails_the_rules_of_wheel_and_pedals(case):
    rough = fly_rules(case_of(case.axis, **{"column.coulomb_friction": "8 lb"}))
    missed = {verdict.quantity for verdict in rough.verdicts if verdict.outcome is not Outcome.MET}
    assert "sideslip: bank" in missed


@pytest.mark.slow
@pytest.mark.parametrize("name", ["737", "T38", "f16"])
def test_every_aircraft_has_wheel_and_pedals(name, forcefeel, tmp_path):
    for loader in LOADERS.values():
        status, out, err = forcefeel("fly", loader, "--aircraft", name, "--rules", "--out-dir", str(tmp_path / loader))
        assert (status, err) == (0, "")
        assert f"as the {'roll' if loader == LOADERS['roll'] else 'yaw'} control of {name}: all" in " ".join(
            out.split()
        )


@pytest.mark.slow
def test_axis_is_the_loaders_unless_given(forcefeel):
    _, out, _ = forcefeel("fly", "aileron-wheel", "--duration", "1.5 s", "--force", "10 N")
    out = " ".join(out.split())
    assert "aileron-wheel is flown as the roll control; a positive control is turned to the right" in out
    assert "largest roll rate" in out
    _, out, _ = forcefeel("fly", "aileron-wheel", "--axis", "pitch", "--duration", "1.5 s")
    assert "aileron-wheel is flown as the pitch control, though it is built for roll" in " ".join(out.split())


def test_what_an_axis_has_not_is_refused(forcefeel, tmp_path):
    own = tmp_path / "own.toml"
    text = (files("forcefeel") / "data/aircraft/c172p.toml").read_text(encoding="utf-8")
    own.write_text('model = "c172p"\n' + text.partition("[roll.control]")[0], encoding="utf-8")
    for words, part in (
        (("aileron-wheel", "--maneuver", "pull-up"), "expected one of roll-rate, sideslip in roll, got 'pull-up'"),
        (("rudder-pedals", "--maneuver", "roll-rate"), "expected one of yaw-rate, sideslip in yaw"),
        (("elevator-2khz", "--maneuver", "sideslip"), "stall in pitch, got 'sideslip'"),
        (("aileron-wheel", "--maneuver", "sideslip", "--sideslip", "0 deg"), "sideslip: expected an angle"),
        (("aileron-wheel", "--maneuver", "sideslip", "--sideslip", "19 deg"), "and 19 deg of sideslip: no balance of"),
        (("aileron-wheel", "--sideslip", "5 deg"), "--sideslip: requires --maneuver"),
        (("aileron-wheel", "--aircraft", str(own)), "has no data of its roll control; add tables such as roll.control"),
    ):
        status, out, err = forcefeel("fly", *words)
        assert (status, out) == (2, ""), words
        assert part in err, err
    own.write_text('model = "c172p"\n' + text.replace("roll_arm", "role_arm"), encoding="utf-8")
    assert "role_arm" in forcefeel("fly", "aileron-wheel", "--aircraft", str(own))[2]
    own.write_text('model = "c172p"\n' + text.replace('grip = "pedals"', 'grip = "feet"'), encoding="utf-8")
    assert "own.toml, yaw: control.grip: expected" in forcefeel("fly", "rudder-pedals", "--aircraft", str(own))[2]
