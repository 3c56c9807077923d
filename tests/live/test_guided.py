"""What a host's packets do to the column under a law, in virtual time: each packet comes before a cycle of its own."""

import itertools

import numpy as np
import pytest

import forcefeel as ff
from tests.live.planned import planned

APART = 33
"""Cycles between two packets: of a host with 60 a second, at 2 kHz."""
BEGINS = 606 * APART
ACTIVE, AUTOPILOT, JAM = 1, 2, 8
NONE = {
    "dynamic_pressure": 0.0,
    "spring_factor": 1.0,
    "trim": 0.0,
    "autopilot_position": 0.0,
    "autopilot_force": 0.0,
    "added_force": 0.0,
    "shaker": 0.0,
    "pusher_force": 0.0,
    "trim_runaway_rate": 0.0,
    "jam_force": 0.0,
    "added_stiffness": 0.0,
    "added_damping": 0.0,
    "true_airspeed": 0.0,
    "angle_of_attack": 0.0,
    "sideslip": 0.0,
    "roll_rate": 0.0,
    "pitch_rate": 0.0,
    "yaw_rate": 0.0,
    "load_factor": 1.0,
    "mach": 0.0,
    "tab": 0.0,
    "flap": 0.0,
}
STANDS_RAD = 2.5e-3
"""Friction, resolution of the sensors and what is left of a transient."""
LOADERS = {"elevator-2khz": ff.digital_elevator, "elevator-electric": lambda: ff.loader.electric("elevator-electric")}


FOLLOWS_RAD = 1.5e-3
"""By how much a column under a law lags the programmed control on its way."""


def guided(loader, parts, hand=()):
    """Columns of a run under ``robust``: the host's switches and values from a cycle on each, the hand's force likewise."""
    requests, ends = [(0, "on", [])], [begin for begin, *_ in parts[1:]] + [parts[-1][0] + 14_000]
    for (begin, switches, values), end in zip(parts, ends, strict=True):
        numbers = [*({**NONE, **values}.values())]
        requests += [(cycle, "host", [float(cycle), float(switches), *numbers]) for cycle in range(begin, end, APART)]
    force = np.zeros(ends[-1])
    for begin, newtons in hand:
        force[begin:] = newtons
    return planned(loader, force, requests, host="127.0.0.1:0")


@pytest.mark.parametrize("name", LOADERS)
def test_autopilot_backdrives_column_and_hand_overrides(name):
    loader = LOADERS[name]()
    arm, stiffness = loader["column.grip_arm"], loader["feel.stiffness"]
    angle, force = 0.05, 0.05 * stiffness / arm
    engaged = ACTIVE | AUTOPILOT
    weak = {"autopilot_position": angle, "autopilot_force": 0.5 * force}
    found = guided(
        loader,
        [(0, engaged, {**weak, "autopilot_force": 10 * force}), (BEGINS, engaged, weak)],
        hand=[(10_000, -force), (BEGINS, -force)],
    )
    column = found["column_angle_rad"]
    # The servo carries the feel's spring: it comes to its place.
    assert column[9_000:10_000].mean() == pytest.approx(angle, abs=STANDS_RAD)
    # A hand meets the servo's spring of four times the feel's, and that: 5 G (theta_a - theta) = R_p F.
    assert column[19_000:20_000].mean() == pytest.approx(angle - angle / 5, abs=STANDS_RAD)
    # It slips at half the hand's force: G theta = R_p (F_a - F).
    assert column[-1000:].mean() == pytest.approx(-0.5 * angle, abs=STANDS_RAD)
    assert found["added_force_n"][-1] == pytest.approx(0.5 * force, rel=1e-6)  # single precision
    assert not found["trips"].any()  # being driven back is no runaway
    # No step: what a packet changes takes as long as packets are apart.
    assert np.abs(np.diff(found["added_force_n"])).max() < 1.001 * 9.5 * force / APART


def driven_back(loader, force, angles):
    """Angle of the programmed control on its way from one place of the autopilot to another: semi-implicit Euler."""
    inertia, damping, stiffness, arm, period = (
        loader[key]
        for key in ("feel.inertia", "feel.damping", "feel.stiffness", "column.grip_arm", "controller.period")
    )
    fine, (begin, end) = 10, angles
    angle, rate, found = begin, 0.0, []
    for k in range(fine * 3000):
        place = begin + (end - begin) * min(1.0, k / (fine * APART))  # a packet's values come evenly
        servo = np.clip(stiffness * place + 4 * stiffness * (place - angle), -arm * force, arm * force)
        rate += period / fine * (servo - damping * rate - stiffness * angle) / inertia
        angle += period / fine * rate
        found.append(angle)
    return np.array(found[::fine])


@pytest.mark.parametrize("name", LOADERS)
@pytest.mark.parametrize("strength", [10.0, 1.3])
def test_autopilot_column_motion_matches_equation(name, strength):
    """Strong, and so weak that the clutch slips on the way; both come to their place."""
    loader, angles = LOADERS[name](), (0.03, 0.05)
    force = strength * angles[1] * loader["feel.stiffness"] / loader["column.grip_arm"]
    engaged = [{"autopilot_position": angle, "autopilot_force": force} for angle in angles]
    found = guided(loader, [(0, ACTIVE | AUTOPILOT, engaged[0]), (BEGINS, ACTIVE | AUTOPILOT, engaged[1])])
    column = found["column_angle_rad"]
    expected = driven_back(loader, force, angles)
    assert np.abs(column[BEGINS : BEGINS + len(expected)] - expected).max() < FOLLOWS_RAD
    for at, angle in zip((BEGINS, len(column)), angles, strict=True):
        assert column[at - 2000 : at].mean() == pytest.approx(angle, rel=1e-3)  # noise and resolution of the sensors
        assert np.ptp(column[at - 2000 : at]) < FOLLOWS_RAD


@pytest.mark.parametrize("name", LOADERS)
def test_jam_holds_column_up_to_jam_force(name):
    loader = LOADERS[name]()
    arm, stiffness = loader["column.grip_arm"], loader["feel.stiffness"]
    at, breaks = 0.05, 0.1 * stiffness / arm
    jammed = {"jam_force": breaks}
    parts = [
        (0, ACTIVE, {"trim": at}),
        (BEGINS, ACTIVE | JAM, {"trim": at, **jammed}),
        (2 * BEGINS, ACTIVE | JAM, jammed),
    ]
    # The trim has gone back to zero: the jam carries the spring.
    assert guided(loader, parts)["column_angle_rad"][-1000:].mean() == pytest.approx(at, abs=STANDS_RAD)
    for share in (0.4, 1.6):
        parts = [(0, ACTIVE, {}), (BEGINS - 30 * APART, ACTIVE | JAM, jammed)]
        column = guided(loader, parts, hand=[(BEGINS, share * breaks)])["column_angle_rad"]
        # Held, by four springs and the feel's own: 5 G theta = R_p F; broken out: G theta = R_p (F - F_j).
        held = share * breaks * arm / (5 * stiffness)
        expected = held if held < breaks * arm / (4 * stiffness) else (share - 1) * breaks * arm / stiffness
        assert column[-1000:].mean() == pytest.approx(expected, abs=STANDS_RAD)


def test_trim_and_added_force_move_column_to_spring_equilibrium():
    loader = ff.digital_elevator()
    found = guided(loader, [(0, ACTIVE, {"trim": 0.03, "added_force": 40.0})])
    expected = 0.03 + 40.0 * loader["column.grip_arm"] / loader["feel.stiffness"]
    # The law is told of the force, which no hand holds: the link is not stretched by it.
    assert found["column_angle_rad"][-1000:].mean() == pytest.approx(expected, rel=1e-3)  # noise of the sensors


def test_added_spring_moves_the_place_where_no_hand_is_needed():
    loader = ff.loader.electric("elevator-electric")
    stiffness = loader["feel.stiffness"]
    found = guided(loader, [(0, ACTIVE, {"trim": 0.06, "added_force": 40.0, "added_stiffness": 2 * stiffness})])
    expected = (0.06 * stiffness + 40.0 * loader["column.grip_arm"]) / (3 * stiffness)
    assert found["column_angle_rad"][-1000:].mean() == pytest.approx(expected, rel=2e-3)  # noise of the sensors


RATIO = 0.2
LONG_N = 150.0
"""A force that a hand may hold for long: safety.force_limit is twice that."""
RELEASED = 16_000
"""The cycle in which the hand lets go."""


@pytest.mark.parametrize("name", LOADERS)
@pytest.mark.parametrize("hertz", [1.0, 2.0, 3.0, 4.0])
def test_spring_of_a_host_at_60_hz_keeps_its_damping_with_jitter_and_lost_packets(name, hertz):
    """The loader closes it: damping ratio from the decay of the swings, frequency from their zeros."""
    loader = LOADERS[name]()
    inertia, arm = loader["feel.inertia"], loader["column.grip_arm"]

    def feel(w: float) -> dict[str, float]:
        return {"feel.stiffness": inertia * w**2, "feel.damping": 2 * RATIO * w * inertia}

    loader, whole = loader.replace(feel(2 * np.pi), si=True), feel(2 * np.pi * hertz)
    added = {f"added_{key[5:]}": whole[key] - loader[key] for key in whole}
    numbers = [*({**NONE, **added}.values())]
    rng = np.random.default_rng(60)
    beats = APART * np.arange(700) + rng.integers(0, 20, 700)  # up to 10 ms of jitter
    kept = beats[rng.random(700) > 0.05]
    requests = [(0, "on", []), *((int(beat), "host", [float(k), 1.0, *numbers]) for k, beat in enumerate(kept))]
    force = np.zeros(RELEASED + 4_000)
    held = min(0.05 * whole["feel.stiffness"] / arm, LONG_N)
    force[:RELEASED] = held * np.clip((np.arange(RELEASED) - 6_000) / 4_000, 0, 1)
    column = planned(loader, force, requests, host="127.0.0.1:0")["column_angle_rad"]
    assert column[RELEASED - 100 : RELEASED].mean() == pytest.approx(
        held * arm / whole["feel.stiffness"], rel=2e-3
    )  # noise
    column = column[RELEASED:]
    crossings = np.flatnonzero(np.diff(np.signbit(column)))[:3]  # a sample in steps may be zero
    first, second = (np.abs(column[a:b]).max() for a, b in itertools.pairwise(crossings))
    decrement = np.log(first / second)
    ratio = decrement / np.hypot(np.pi, decrement)
    damped_hz = 1 / ((crossings[2] - crossings[0]) * loader["controller.period"])
    assert ratio == pytest.approx(RATIO, abs=0.005)  # as asked of a host at 60 Hz
    assert damped_hz / np.sqrt(1 - ratio**2) == pytest.approx(hertz, rel=0.01)  # a zero is right to a sample
