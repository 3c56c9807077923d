"""A hand, a loader and JSBSim's c172p, against the hinge moment worked out from JSBSim's own states."""

import sys

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
    hand = HAND_N * np.clip((np.arange(625) * ff.fly.FRAME_S - 1.0) / 1.0, 0, 1)
    return ff.fly.fly(ff.digital_elevator(), ff.fly.Aircraft("c172p", SPEED, ALTITUDE), hand, "robust")


def flow(state):
    return 0.6 * state["angle_of_attack"] + TAIL * state["pitch_rate"] / state["true_airspeed"]


def balance(loader, state, trimmed, angle):
    """Force of the hand by ``R F = G theta - q S c (C_alpha (alpha_s - alpha_s0) + C_delta theta)``."""
    moment = state["dynamic_pressure"] * AREA * CHORD * (-0.1 * (flow(state) - flow(trimmed)) - 0.3 * angle)
    return (30.0 * angle - moment) / loader["column.grip_arm"]


def test_hand_carries_the_hinge_moment_of_the_flight(flown):
    trimmed = ff.fly.Aircraft("c172p", SPEED, ALTITUDE).state()
    # From 3 s on the short period has died; what is left is the slow loss of speed.
    forces = balance(flown.loader, flown.states, trimmed, flown.angle_rad)[375:575]
    assert forces.mean() == pytest.approx(HAND_N, rel=0.01)  # of what is left of the swing
    assert flown.states["load_factor"].max() > 1.35


def test_untouched_aircraft_stays_trimmed(flown):
    calm = slice(0, 120)
    assert np.abs(flown.angle_rad[calm]).max() < 1e-3  # noise and steps of the sensors
    assert np.abs(flown.states["load_factor"][calm] - flown.states["load_factor"][0]).max() < 0.01


def test_force_per_g_is_that_of_trimmed_pull_ups(flown):
    trims = {n: ff.fly.Aircraft("c172p", SPEED, ALTITUDE, n) for n in (1.0, 1.2, 1.4)}
    states = {n: of.state() for n, of in trims.items()}
    zero = trims[1.0].trimmed_rad
    forces = [balance(flown.loader, states[n], states[1.0], trims[n].trimmed_rad - zero) for n in (1.2, 1.4)]
    expected = (forces[1] - forces[0]) / (states[1.4]["load_factor"] - states[1.2]["load_factor"])
    assert ff.fly.force_per_g(flown.loader, "c172p", SPEED, ALTITUDE) == pytest.approx(
        expected, rel=1e-9
    )  # the tab, by rounding
    # JSBSim pulls up at the rate g (n - 1) / V.
    turn = 9.80665 * (1.4 - 1.0) / states[1.4]["true_airspeed"]
    assert states[1.4]["pitch_rate"] == pytest.approx(turn, rel=2e-3)  # its gravity is that of the altitude
    # In flight speed is lost meanwhile, and with it some of the load factor.
    gained = flown.states["load_factor"][300:400].mean() - states[1.0]["load_factor"]
    assert 0.8 < gained * expected / HAND_N < 1.05


def test_what_cannot_fly_is_named(forcefeel, monkeypatch):
    for words, part in (
        (("--aircraft", "c172"), "expected one of c172p, got 'c172'; did you mean c172p?"),
        (("--speed", "20 kt"), "c172p does not trim at 20 kt: no balance of lift and weight"),
        (("--speed", "100"), "--speed"),
        (("--duration", "0 s"), "--duration"),
        (("--force", "4000 N"), "the supervisor stopped it"),
        (("elevator-1974",), "a live loop requires"),
    ):
        status, out, err = forcefeel("fly", *words)
        assert (status, out) == (2, ""), words
        assert part in err
    monkeypatch.setattr(aircraft_module, "known", lambda: ["c172x"])
    with pytest.raises(ff.InputError, match="c172x has an actuator between command and elevator"):
        ff.fly.Aircraft("c172x", SPEED, ALTITUDE)
    monkeypatch.setattr(aircraft_module, "known", lambda: ["c172p"])
    monkeypatch.setitem(sys.modules, "jsbsim", None)
    with pytest.raises(ff.InputError, match=r"pip install forcefeel\[fly\]"):
        ff.fly.Aircraft("c172p", SPEED, ALTITUDE)


def test_flight_that_the_loader_cannot_render_is_refused(monkeypatch):
    """An overbalanced elevator: it must not be flown without its moment."""
    whole = aircraft_module.with_elevator
    monkeypatch.setattr(
        "forcefeel.fly.run.with_elevator",
        lambda *of: whole(*of).replace({"surface.per_deflection": 0.9}, si=True),
    )
    with pytest.raises(ff.InputError, match="cannot render the hinge moment at"):
        ff.fly.fly(ff.digital_elevator(), ff.fly.Aircraft("c172p", SPEED, ALTITUDE), np.zeros(9), "robust")


def test_command_prints_and_writes_the_flight(forcefeel, tmp_path):
    status, out, err = forcefeel("fly", "--duration", "2 s", "--out", str(tmp_path / "flight.csv"))
    assert (status, err) == (0, "")
    assert "stick force per g" in out
    assert "illustrative" in out
    lines = (tmp_path / "flight.csv").read_text(encoding="utf-8").splitlines()
    assert lines[0].startswith("time_s,force_n,column_angle_rad,dynamic_pressure_pa,true_airspeed_m_per_s")
    assert len(lines) == 251
