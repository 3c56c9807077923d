"""A hand, a loader and JSBSim's c172p, against the hinge moment worked out from JSBSim's own states."""

import sys
from pathlib import Path

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.fly import aircraft as aircraft_module

SPEED, ALTITUDE = 51.4, 900.0
FT = 0.3048
AREA, CHORD, TAIL = 14.5 * FT**2, 1.2 * FT, 15.7 * FT
HAND_N = -15.0


@pytest.fixture(scope="module")
def flown():
    hand = HAND_N * np.clip((np.arange(2500) * ff.fly.FRAME_S - 1.0) / 1.0, 0, 1)
    return ff.fly.fly(
        ff.digital_elevator(), ff.fly.Aircraft("c172p", SPEED, ALTITUDE), hand, ff.fly.FlightOptions(law="robust")
    )


def flow(state):
    return 0.6 * state["angle_of_attack"] + TAIL * state["pitch_rate"] / state["true_airspeed"]


def balance(loader, state, trimmed, angle):
    """Force of the hand by ``R F = G theta - q S c (C_alpha (alpha_s - alpha_s0) + C_delta theta)``."""
    moment = state["dynamic_pressure"] * AREA * CHORD * (-0.1 * (flow(state) - flow(trimmed)) - 0.3 * angle)
    return (30.0 * angle - moment) / loader["column.grip_arm"]


@pytest.mark.slow
def test_hand_carries_the_hinge_moment_of_the_flight(flown):
    trimmed = ff.fly.Aircraft("c172p", SPEED, ALTITUDE).state()
    # From 3 s on the short period has died; what is left is the slow loss of speed.
    forces = balance(flown.loader, flown.states, trimmed, flown.angle_rad)[1500:2300]
    assert forces.mean() == pytest.approx(HAND_N, rel=0.01)  # of what is left of the swing
    assert flown.states["load_factor"].max() > 1.35


def test_untouched_aircraft_stays_trimmed(flown):
    calm = slice(0, 480)
    assert np.abs(flown.angle_rad[calm]).max() < 1e-3  # noise and steps of the sensors
    assert np.abs(flown.states["load_factor"][calm] - flown.states["load_factor"][0]).max() < 0.01


def test_force_per_g_is_that_of_trimmed_pull_ups(flown):
    trims = {n: ff.fly.Aircraft("c172p", SPEED, ALTITUDE, n) for n in (1.0, 1.2, 1.4)}
    states = {n: of.state() for n, of in trims.items()}
    zero = trims[1.0].trimmed
    forces = [balance(flown.loader, states[n], states[1.0], trims[n].trimmed - zero) for n in (1.2, 1.4)]
    expected = (forces[1] - forces[0]) / (states[1.4]["load_factor"] - states[1.2]["load_factor"])
    assert ff.fly.force_per_g(ff.digital_elevator(), "c172p", SPEED, ALTITUDE) == pytest.approx(
        expected, rel=1e-9
    )  # the tab, by rounding
    # JSBSim pulls up at the rate g (n - 1) / V.
    turn = 9.80665 * (1.4 - 1.0) / states[1.4]["true_airspeed"]
    assert states[1.4]["pitch_rate"] == pytest.approx(turn, rel=2e-3)  # its gravity is that of the altitude
    # In flight speed is lost meanwhile, and with it some of the load factor.
    gained = flown.states["load_factor"][1200:1600].mean() - states[1.0]["load_factor"]
    assert 0.8 < gained * expected / HAND_N < 1.05


def test_what_cannot_fly_is_named(forcefeel, monkeypatch):
    for words, part in (
        (
            ("--aircraft", "c172"),
            "expected one of 737, T38, c172p, f16 or a TOML file, got 'c172'; did you mean c172p?",
        ),
        (("--speed", "20 kt"), "c172p does not trim at 20 kt: no balance of lift and weight"),
        (("--speed", "100"), "--speed"),
        (("--duration", "0 s"), "--duration"),
        (("--record", "none.csv"), "none.csv"),
        (("--record", "none.csv", "--force", "-5 N"), "--force: --record is the force of the hand"),
        (("--record", "none.csv", "--maneuver", "stall"), "--record: --maneuver does not use it"),
        (("--force", "4000 N"), "the supervisor stopped it"),
        (("elevator-1974",), "a live loop requires"),
    ):
        status, out, err = forcefeel("fly", *words)
        assert (status, out) == (2, ""), words
        assert part in err
    monkeypatch.setitem(sys.modules, "jsbsim", None)
    with pytest.raises(ff.InputError, match=r"pip install 'forcefeel\[fly\]'"):
        ff.fly.Aircraft("c172p", SPEED, ALTITUDE)


def test_flight_that_the_loader_cannot_render_is_refused(monkeypatch):
    """An overbalanced elevator: it must not be flown without its moment."""
    whole = aircraft_module.with_surface
    monkeypatch.setattr(
        "forcefeel.fly.run.with_surface",
        lambda *of: whole(*of).replace({"surface.per_deflection": 0.9}, si=True),
    )
    with pytest.raises(ff.InputError, match="cannot render the hinge moment at"):
        ff.fly.fly(
            ff.digital_elevator(),
            ff.fly.Aircraft("c172p", SPEED, ALTITUDE),
            np.zeros(9),
            ff.fly.FlightOptions(law="robust"),
        )


def test_command_prints_and_writes_the_flight(forcefeel, tmp_path):
    status, out, err = forcefeel("fly", "--duration", "2 s", "--out", str(tmp_path / "flight.csv"))
    assert (status, err) == (0, "")
    assert "pull per g" in out
    assert "illustrative" in out
    lines = (tmp_path / "flight.csv").read_text(encoding="utf-8").splitlines()
    assert lines[0].startswith("time_s,force_n,column_angle_rad,dynamic_pressure_pa,true_airspeed_m_per_s")
    assert len(lines) == 1001
    # The same force as a record: a ramp from 1 to 2 s.
    (tmp_path / "hand.csv").write_text("time (s),force (N)\n3,0\n4,0\n5,-15\n", encoding="utf-8")
    status, out, err = forcefeel("fly", "--record", "hand.csv", "--out", "again.csv")
    assert (status, err) == (0, "")
    assert "hand.csv at the grip" in out
    again = np.genfromtxt(tmp_path / "again.csv", delimiter=",", names=True)
    flown = np.genfromtxt(lines, delimiter=",", names=True)
    for name in ("force_n", "column_angle_rad", "load_factor"):
        assert again[name] == pytest.approx(flown[name], abs=1e-6)  # of the digits in the file


def test_reversible_control_behind_an_actuator_is_refused_and_an_irreversible_one_flies(forcefeel, tmp_path):
    own = tmp_path / "own.toml"
    text = (ff_data() / "c172p.toml").read_text(encoding="utf-8")
    own.write_text('model = "c172x"\n' + text, encoding="utf-8")
    status, _, err = forcefeel("fly", "--aircraft", str(own))
    assert status == 2
    assert "has an actuator between command and elevator" in err
    command = text.replace('moves = "surface"', 'moves = "command"\nfull_travel = "10 deg"')
    own.write_text('model = "c172x"\n' + command, encoding="utf-8")
    assert forcefeel("fly", "--aircraft", str(own), "--duration", "1.5 s")[0] == 0


def test_aircraft_writes_no_table_of_its_own(monkeypatch, tmp_path):
    """JSBSim's global5000 has an output of that kind."""
    monkeypatch.chdir(tmp_path)
    data = (Path(aircraft_module.__file__).parents[1] / "data/aircraft/737.toml").read_text(encoding="utf-8")
    (tmp_path / "my.toml").write_text(f'model = "global5000"\n{data}', encoding="utf-8")
    ff.fly.Aircraft("my.toml", 128.6, 3000.0).fly(0.0)
    assert [path.name for path in tmp_path.iterdir()] == ["my.toml"]


def test_bad_data_of_an_aircraft_is_named(forcefeel, tmp_path):
    text = (ff_data() / "T38.toml").read_text(encoding="utf-8")
    own = tmp_path / "own.toml"
    for old, new, part in (
        ("[control]", "[controls]", "controls: expected only"),
        ('moves = "command"', 'moves = "rope"', "control.moves: expected surface or command, got 'rope'"),
        ('full_travel = "10 deg"', "", "control.full_travel: required"),
        ('"10 deg"', '"10"', "own.toml"),
        ('"10 deg"', '"nan deg"', "own.toml"),
        ("gearing = 1.0", "gearing = 0.0", "surface.gearing: expected a number other than 0"),
        ("gearing = 1.0", "gearing = nan", "surface.gearing"),
        ("damping_ratio = 0.7", "damping_ratio = -0.7", "feel.damping_ratio: expected a number above 0"),
        ('speed = "300 kt"', "speed = 300", "flight.speed"),
        ("[control]", "[control", "cannot read"),
        ('"150 N m/rad"', '"150"', "feel.stiffness"),
        (
            "damping_ratio =",
            "damping_ration =",
            "feel.damping_ration: expected only damping_ratio, stiffness; did you mean",
        ),
        ("full_travel =", "full_traval =", "control.full_traval: expected only full_travel, grip, moves; did you mean"),
        ("altitude =", "altitud =", "flight.altitud: expected only"),
        ('grip = "stick"', 'grip = "yoke"', "control.grip: expected wheel or stick or pedals, got 'yoke'"),
        ('category = "military"', 'category = "light"', "flight.maximum_weight: required"),
        (
            'category = "military"',
            'category = "military"\nmaximum_weight = "2 lb"',
            "expected only with category = light",
        ),
        ("limit_load_factor = 7.33", "limit_load_factor = 1", "flight.limit_load_factor: expected a number above 1"),
        ("bobweight =", "bobwaight =", "bobwaight"),
    ):
        assert old in text
        own.write_text('model = "T38"\n' + text.replace(old, new), encoding="utf-8")
        status, out, err = forcefeel("fly", "--aircraft", str(own))
        assert (status, out) == (2, ""), new
        assert part in err, err
    own.write_text('model = "nowhere"\n' + text, encoding="utf-8")
    assert "JSBSim has no aircraft 'nowhere'" in forcefeel("fly", "--aircraft", str(own))[2]
    assert "cannot read" in forcefeel("fly", "--aircraft", str(tmp_path / "none.toml"))[2]


BY_HAND = {  # speed, C_alpha, C_delta with its tab, area, chord, arm of the tail, boost share, bobweight, spring
    "737": (128.6, -0.08, -0.26 - 0.5 * 0.08, 70 * FT**2, 2.4 * FT, 48 * FT, 0.1, 0.0, 60.0),
    "T38": (154.0, 0.0, -1.0, 0.5 * FT**2, 1.3 * FT, 0.0, 1.0, -13.0, 150.0),
    "f16": (180.0, 0.0, -1.0, 0.25 * FT**2, 1.3 * FT, 0.0, 1.0, 0.0, 300.0),
}


def torque_by_hand(name, state, angle, tab, grip_arm):
    """Torque on the column of feel and hinge moment at rest; the 737's coefficients grow with the Mach number."""
    _, per_flow, per_deflection, area, chord, tail, share, bobweight, spring = BY_HAND[name]
    grown = (1 - state["mach"] ** 2) ** -0.5 if name == "737" else 1.0
    at_tail = 0.6 * state["angle_of_attack"] + tail * state["pitch_rate"] / state["true_airspeed"]
    moment = share * state["dynamic_pressure"] * area * chord
    air = moment * (tab + grown * (per_flow * at_tail + per_deflection * angle))
    return air - grip_arm * bobweight * state["load_factor"] - spring * angle


@pytest.mark.parametrize("name", BY_HAND)
def test_held_force_is_the_balance_of_the_data_worked_out_by_hand(name):
    trim, pull = (ff.fly.Aircraft(name, BY_HAND[name][0], 3048.0, n) for n in (1.0, 1.3))
    loader = ff.fly.with_surface(ff.digital_elevator(), trim)
    arm, still = loader["column.grip_arm"], trim.state()
    with_none, with_one = (torque_by_hand(name, still, 0.0, tab, arm) for tab in (0.0, 1.0))
    tab = -with_none / (with_one - with_none)
    expected = -torque_by_hand(name, pull.state(), pull.angle_from(trim), tab, arm) / arm
    assert ff.fly.trimmed_force(loader, trim, pull) == pytest.approx(expected, rel=1e-9)  # the tab, by rounding
    assert expected < -1  # a pull


def ff_data():
    return Path(ff.__file__).parent / "data" / "aircraft"
