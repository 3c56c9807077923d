"""Simulators that speak the real bytes, the bridge, and a loader that runs."""

import re
import socket
import threading
import time
from math import radians
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from tests.bridge.emulators import XPlaneEmulator
from tests.live.unhurried import unhurried_elevator

import forcefeel as ff
from forcefeel import _core
from forcefeel.bridge.run import packet_of

EXAMPLES = Path(__file__).parents[2] / "examples/simulators"
SURFACE = {
    "surface.area": 1.0,
    "surface.chord": 0.4,
    "surface.gearing": 1.0,
    "surface.per_deflection": -0.3,
    "surface.per_flow": -0.5,
    "surface.flow_per_attack": 1.0,
}
SETTINGS = ff.bridge.BridgeSettings(travel_rad=0.25, tab_rad=0.4)
POSITION = "sim/flightmodel/position"
FLIGHT = {
    f"{POSITION}/true_airspeed": 50.0,
    "sim/weather/rho": 1.2,
    f"{POSITION}/alpha": 6.0,
    f"{POSITION}/beta": -2.0,
    f"{POSITION}/P": 3.0,
    f"{POSITION}/Q": 4.0,
    f"{POSITION}/R": 5.0,
    "sim/flightmodel/forces/g_nrml": 1.25,
    "sim/flightmodel/misc/machno": 0.15,
    "sim/time/paused": 0.0,
    "sim/cockpit2/annunciators/stall_warning": 0.0,
    "sim/flightmodel2/controls/elevator_trim": 0.5,
    "sim/operation/failures/rel_elv_L_jam": 0.0,
}
PATIENCE_S = 30.0


def settled(running, report_of) -> None:
    until = time.monotonic() + PATIENCE_S
    while not report_of():
        assert time.monotonic() < until, running.host
        time.sleep(0.02)


def test_x_plane_flies_a_loader_and_is_moved_by_its_column():
    loader = unhurried_elevator().replace(SURFACE, si=True)
    ended = threading.Event()
    with XPlaneEmulator(dict(FLIGHT)) as x_plane, ff.live.start(loader, "robust", host=0) as running:
        running.on()
        address, _, port = running.host.listens.rpartition(":")
        simulator = ff.bridge.XPlane(x_plane.address, ff.bridge.Axis.PITCH)
        reports = []
        runs = threading.Thread(
            target=lambda: reports.append(ff.bridge.bridge(simulator, (address, int(port)), SETTINGS, ended.is_set))
        )
        runs.start()
        column = ff.live.COLUMNS.index

        def row():
            return running.history(-1.0, 1)[0]

        settled(running, lambda: len(running.history(-1.0, 1)) and row()[column("host_share")] == 1.0)
        # k^2 q S c C_delta, with q = rho V^2 / 2, in single precision.
        pressure = 0.5 * 1.2 * 50.0**2
        settled(
            running,
            lambda: (
                row()[column("added_stiffness_n_m_per_rad")] == pytest.approx(pressure * 0.4 * 0.3, rel=1e-6)
            ),  # single precision
        )
        still = pressure * 0.4 * -0.5 * radians(6.0)
        expected = still / (loader["feel.stiffness"] + pressure * 0.4 * 0.3)
        settled(
            running, lambda: abs(running.history(-1.0, 500)[:, column("column_angle_rad")].mean() - expected) < 1e-3
        )
        ratio = "sim/joystick/yoke_pitch_ratio"
        settled(running, lambda: abs(x_plane.set.get(ratio, 9.0) - expected / SETTINGS.travel_rad) < 0.02)
        assert x_plane.set["sim/operation/override/override_joystick_pitch"] == 1.0
        assert {rate for rate, _ in x_plane.asked.values()} == {60}
        ended.set()
        runs.join()
        settled(running, lambda: x_plane.set["sim/operation/override/override_joystick_pitch"] == 0.0)
        settled(running, lambda: {rate for rate, _ in x_plane.asked.values()} == {0})
    (report,) = reports
    assert (report.loader_state, report.refused) == ("active", False)
    assert report.answers > 10


def test_x_plane_state_has_si_units():
    with XPlaneEmulator({**FLIGHT, "sim/time/paused": 1.0, "sim/operation/failures/rel_elv_L_jam": 6.0}) as x_plane:
        simulator = ff.bridge.XPlane(x_plane.address, ff.bridge.Axis.PITCH)
        until, state = time.monotonic() + PATIENCE_S, None
        while state is None:
            assert time.monotonic() < until
            state = simulator.receive()
            time.sleep(0.005)
        simulator.close()
    assert (state.frozen, state.jammed, state.shaken) == (True, True, False)
    expected = {
        "dynamic_pressure": 1500.0, "true_airspeed": 50.0, "angle_of_attack": radians(6), "sideslip": radians(-2),
        "roll_rate": radians(3), "pitch_rate": radians(4), "yaw_rate": radians(5), "load_factor": 1.25, "mach": 0.15, "tab": 0.5,
    }  # fmt: skip
    assert dict(state.numbers) == pytest.approx(expected, rel=1e-6)  # of single precision
    sequence, switches, numbers = _core.host_request(packet_of(4, state, SETTINGS))
    assert (sequence, switches) == (4, 1 | 8 | 128 | 256)
    assert (numbers["tab"], numbers["jam_force"]) == pytest.approx((0.2, 400.0))


TUBE = ("sim/operation/failures/rel_elv_R_jam", "sim/cockpit2/controls/torque_tube_split_pitch")


@pytest.mark.parametrize(
    ("left", "right", "split", "jammed"),
    [
        (0.0, 6.0, 0.0, True),
        (0.0, 6.0, 1.0, False),
        (6.0, 0.0, 1.0, True),
        (0.0, 5.0, 0.0, False),
        (0.0, None, None, False),
    ],
)
def test_torque_tube_carries_a_jam_of_the_other_side_until_it_splits(left, right, split, jammed):
    """An X-Plane without the tube does not answer its datarefs."""
    tube = {} if right is None else dict(zip(TUBE, (right, split), strict=True))
    with XPlaneEmulator({**FLIGHT, "sim/operation/failures/rel_elv_L_jam": left, **tube}) as x_plane:
        simulator = ff.bridge.XPlane(x_plane.address, ff.bridge.Axis.PITCH)
        until, states = time.monotonic() + PATIENCE_S, []
        while len(states) < 5:  # every dataref has been answered
            assert time.monotonic() < until
            states += [state] if (state := simulator.receive()) else []
            time.sleep(0.005)
        simulator.close()
    assert states[-1].jammed == jammed


def text_state(*lines: bytes):
    simulator = ff.bridge.Text(("127.0.0.1", 0))
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as wire:
        wire.bind(("127.0.0.1", 0))
        wire.settimeout(PATIENCE_S)
        for line in lines:
            wire.sendto(line, ("127.0.0.1", simulator.port))
        time.sleep(0.05)
        state = simulator.receive()
        simulator.move(0.25)
        answer = None if state is None else wire.recv(64)
    simulator.close()
    return state, answer


def test_lines_of_text_are_read_and_answered():
    good = b"dynamic_pressure=1500 true_airspeed=50.0 angle_of_attack=0.07 frozen=1\n"
    state, answer = text_state(good)
    assert (dict(state.numbers), state.frozen, answer) == (
        {"dynamic_pressure": 1500.0, "true_airspeed": 50.0, "angle_of_attack": 0.07},
        True,
        b"0.250000\n",
    )
    for bad in (
        b"",
        b"true_airspeed=50",
        b"dynamic_pressure=1 true_airspeed=nan",
        b"x=1 " + good,
        b"\xff" + good,
        b"a b c",
    ):
        assert text_state(bad) == (None, None)


def test_flightgear_protocol_file_makes_lines_that_are_read():
    (output,) = ElementTree.parse(EXAMPLES / "forcefeel.xml").iter("output")
    assert output.findtext("line_separator") == "newline"
    assert output.findtext("var_separator") == "space"
    words = [
        chunk.findtext("format") % (0 if chunk.findtext("type") == "bool" else 1.5) for chunk in output.iter("chunk")
    ]
    state, _ = text_state(" ".join(words).encode() + b"\n")
    assert state.numbers["pitch_rate"] == state.numbers["dynamic_pressure"] == 1.5
    factors = {chunk.findtext("name"): chunk.findtext("factor") for chunk in output.iter("chunk")}
    assert float(factors["pressure"]) == pytest.approx(4.4482216152605 / 0.3048**2, rel=1e-7)  # lb/ft^2, eight digits
    assert float(factors["attack"]) == pytest.approx(np.pi / 180, rel=1e-6)  # of seven digits


def test_export_script_of_dcs_makes_lines_that_are_read():
    (form,) = re.findall(r'string\.format\("([^"]+)"', (EXAMPLES / "Export.lua").read_text(encoding="utf-8"))
    state, _ = text_state((form.replace("\\n", "\n") % (1500.0, 50.0, 0.1, 1.2, 0.15)).encode())
    assert dict(state.numbers) == {
        "dynamic_pressure": 1500.0, "true_airspeed": 50.0, "angle_of_attack": 0.1, "load_factor": 1.2, "mach": 0.15,
    }  # fmt: skip


MUTATED = 4_000


def test_mutated_packets_are_left_out_without_an_error():
    """A state that comes of one makes a packet that a loader takes, its numbers within range."""
    random = np.random.default_rng(35)
    x_plane = ff.bridge.XPlane(("127.0.0.1", 9), ff.bridge.Axis.PITCH)
    text = ff.bridge.Text(("127.0.0.1", 0))
    values = np.arange(13, dtype=np.float32)
    body = b"RREF," + b"".join(np.int32(k).tobytes() + value.tobytes() for k, value in enumerate(values))
    line = b"dynamic_pressure=1500 true_airspeed=50.0 angle_of_attack=0.07 load_factor=1.1 frozen=0\n"
    taken = 0
    for _ in range(MUTATED):
        for given, take in ((body, x_plane._take), (line, text._state)):
            packet = bytearray(given)
            for place in random.integers(0, len(packet), random.integers(1, 5)):
                packet[place] = random.integers(0, 256)
            state = take(bytes(packet[: random.integers(1, len(packet) + 1)] if random.random() < 0.3 else packet))
            if isinstance(state, ff.bridge.SimulatorState):
                taken += 1
                assert _core.host_request(packet_of(1, state, SETTINGS)) is not None
        assert all(np.isfinite(value) for value in x_plane._values.values())
    assert 0 < taken < MUTATED
    x_plane.close()
    text.close()


@pytest.mark.parametrize(
    ("words", "part"),
    [
        (("x-plane", "--answers", "127.0.0.1:5"), "--answers"),
        (("text", "--at", "here"), "--at: expected an address"),
        (("text", "--at", "192.0.2.1:5000"), "cannot listen at"),
        (("text", "--loader", "127.0.0.1:0"), "--loader"),
        (("text", "--travel", "0 deg"), "--travel: expected a value above 0"),
        (("text", "--travel", "15"), "--travel"),
        (("fsx",), "expected x-plane or text"),
    ],
)
def test_bad_option_is_named(forcefeel, words, part):
    status, out, err = forcefeel("bridge", *words)
    assert (status, out) == (2, "")
    assert part in err


def test_silent_simulator_and_silent_loader_are_said(forcefeel):
    status, out, _ = forcefeel("bridge", "text", "--at", "127.0.0.1:49555", "--duration", "100 ms")
    assert status == 1
    assert "no state came" in out
