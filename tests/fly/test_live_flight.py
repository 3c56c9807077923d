"""An aircraft in real time beside a running loop: its feel, its levers, its way back, its console."""

import json
import socket
import threading
import time
from importlib.resources import files

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.live.console.ipc import FlightProxy, LoopProxy, LoopServer, pair
from tests.command_line import runs
from tests.fly.test_fly import AREA, CHORD, balance
from tests.live.console.conftest import Talk
from tests.live.unhurried import unhurried_elevator
from tests.pages import seldom_drawn

run = runs("run")

CASE = ff.fly.FlightCase.of(unhurried_elevator(), "c172p")
PULL_N, TAB_RAD = -6.0, 0.05
SETTLED_S = 2.0
"""The short period has died; the phugoid, 25 s, has hardly begun."""
LATE = 0.06
"""Share of a force: packets at 60 Hz, on a busy machine fewer, and an aircraft that still swings."""


@pytest.fixture(scope="module")
def flown():
    flight = ff.fly.LiveFlight(CASE.at)
    with (
        ff.live.start(CASE.feel, "robust", host=0) as session,
        ff.fly.fly_live(session, flight),
        ff.live.Console(session, port=0) as console,
    ):
        session.on()
        until(lambda: session.state.name == "active" and session.host.share == 1.0)
        yield session, flight, console


def until(holds):
    end = time.monotonic() + 60
    while not holds():
        assert time.monotonic() < end
        time.sleep(0.01)


def restarted(flight):
    flight.restart()
    until(lambda: abs(flight.readings()["calibrated_airspeed"] - CASE.speed_m_per_s) < 0.1)
    time.sleep(SETTLED_S)


def carried(session, flight):
    """Mean force of the hand, N, by the hinge moment of the states flown: ``test_fly.balance``."""
    forces = []
    for _ in range(20):
        time.sleep(0.05)
        angle, state = session.history(most=1)[0, session.columns.index("column_angle_rad")], flight._seen
        forces.append(balance(CASE.feel, state, CASE.trim.state(), angle))
    return np.mean(forces)


def test_hand_carries_the_hinge_moment_of_the_flight(flown):
    session, flight, _ = flown
    restarted(flight)
    assert flight.readings()["load_factor"] == pytest.approx(1.0, abs=0.02)  # of what is left of the reposition
    session.hand_force_n = PULL_N
    until(lambda: flight.readings()["load_factor"] > 1.1)
    time.sleep(SETTLED_S)
    assert carried(session, flight) == pytest.approx(PULL_N, rel=LATE)
    session.hand_force_n = 0.0
    assert flight.report.loader_state == "active"
    assert flight.readings()["refused"] == 0


@pytest.mark.slow
def test_trim_tab_moves_the_free_control_where_it_has_no_moment(flown):
    """``G theta = q S c (C_alpha (alpha_s - alpha_s0) + C_delta theta + C_tau tau)``: the tab carries what a hand would."""
    session, flight, _ = flown
    restarted(flight)
    flight.set_lever("tab", TAB_RAD)
    time.sleep(SETTLED_S)
    pressure = flight._seen["dynamic_pressure"]
    tab_n = pressure * AREA * CHORD * -0.1 * TAB_RAD / CASE.feel["column.grip_arm"]
    assert carried(session, flight) == pytest.approx(tab_n, rel=LATE)
    flight.restart()
    until(lambda: flight.readings()["tab"] == 0.0)


def test_aircraft_beyond_its_model_returns_to_the_trimmed_flight(flown, monkeypatch):
    _, flight, _ = flown
    flight.set_lever("throttle", 0.0)
    lost = flight._aircraft

    def fails():
        raise ff.InputError("aircraft: c172p left the range of its model")

    monkeypatch.setattr(lost, "state", fails)
    until(lambda: flight._aircraft is not lost)
    assert flight.readings()["throttle"] > 0.1
    states = flight.report.states
    until(lambda: flight.report.states > states + 10)


@pytest.mark.parametrize(
    ("name", "position", "part"),
    [("flaps", 0.5, "has tab, throttle, got 'flaps'"), ("throttle", 1.2, "throttle: expected 0 to 1, got 1.2")],
)
def test_unknown_lever_and_position_out_of_range_are_refused(flown, name, position, part):
    with pytest.raises(ff.InputError, match=part):
        flown[1].set_lever(name, position)


def test_irreversible_control_is_trimmed_by_its_command():
    flight = ff.fly.LiveFlight(ff.fly.FlightCase.of(unhurried_elevator(), "T38").at)
    assert list(flight.levers) == ["trim", "throttle"]


def test_console_shows_the_flight_and_moves_its_levers(flown):
    console = flown[2]
    with Talk(console) as talk:
        hello = talk.notice("hello")["flight"]
        assert [reading["label"] for reading in hello["readings"]] == ["airspeed", "altitude", "load factor", "pitch"]
        talk.send(do="lever", name="throttle", position=0.9)
        shown = talk.notice("status", lambda it: it["flight"]["throttle"] == 0.9)["flight"]
        assert shown["altitude"] == pytest.approx(CASE.altitude_m, abs=300)  # m, of some seconds of flight
        talk.send(do="restart_flight")
        talk.notice("status", lambda it: it["flight"]["throttle"] != 0.9)
        talk.send(do="lever", name="trim", position=0.1)
        assert "has tab, throttle, got 'trim'" in talk.notice("refused")["reason"]


def test_console_in_another_process_reaches_the_flight(flown):
    session, flight, _ = flown
    ours, theirs = pair()
    server = threading.Thread(target=LoopServer(session, theirs).until_gone)
    server.start()
    proxy = FlightProxy(LoopProxy(ours), flight.levers)
    assert proxy.readings().keys() == flight.readings().keys()
    proxy.set_lever("tab", 0.01)
    assert flight.readings()["tab"] == 0.01
    with pytest.raises(ff.InputError, match="expected"):
        proxy.set_lever("tab", 3.0)
    proxy.restart()
    until(lambda: flight.readings()["tab"] == 0.0)
    ours.shutdown(socket.SHUT_RDWR)
    server.join()
    ours.close()
    theirs.close()


@pytest.mark.slow
@pytest.mark.browser
def test_page_flies_at_both_widths(flown, browser):
    _, flight, console = flown
    page = seldom_drawn(browser.new_page(viewport={"width": 1280, "height": 900}))
    page.goto(console.address)
    page.locator("#flight-calibrated_airspeed", has_text="kt").wait_for()
    page.fill("#number-throttle", "95")
    page.keyboard.press("Tab")
    until(lambda: page.evaluate("1") and flight.readings()["throttle"] == pytest.approx(0.95))
    page.set_viewport_size({"width": 390, "height": 844})
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    page.click("#restart")
    until(lambda: page.evaluate("1") and flight.readings()["throttle"] < 0.9)
    page.close()


@pytest.mark.slow
def test_command_flies_beside_the_loop(run):
    status, out, err = run(
        "elevator-2khz",
        "--aircraft",
        "c172p",
        "--headless",
        "--duration",
        "1",
        "--json",
        "--set",
        "safety.overrun_time=1 s",
    )
    assert (status, err) == (0, "")
    assert json.loads(out)["host"]["packets"] > 10


def test_refused_flight_is_a_bad_answer(run, tmp_path):
    """A surface that is overbalanced: its hinge moment is a negative spring of six times the feel's."""
    data = (files("forcefeel") / "data/aircraft/c172p.toml").read_text(encoding="utf-8")
    over = 'model = "c172p"\n' + data.replace('per_deflection = "-0.30', 'per_deflection = "0.30')
    (tmp_path / "over.toml").write_text(over, encoding="utf-8")
    status, out, _ = run("elevator-2khz", "--aircraft", "over.toml", "--headless", "--duration", "1")
    assert status == 1
    assert "the loader refused the flight" in " ".join(out.split())


@pytest.mark.parametrize(
    ("options", "part"),
    [
        (("--speed", "100 kt"), "--speed: requires --aircraft"),
        (("--aircraft", "c172p", "--host", "8732"), "--host: --aircraft is the simulator"),
        (("--aircraft", "c17"), "did you mean c172p"),
        (("--aircraft", "c172p", "--speed", "20 kt"), "c172p does not trim at 20 kt: no balance of lift and weight"),
        (("--aircraft", "c172p", "--speed", "0 kt"), "--speed: expected a speed above 0, got 0 kt"),
    ],
)
def test_bad_options_are_named(run, options, part):
    status, out, err = run("elevator-2khz", *options)
    assert (status, out) == (2, "")
    assert part in err


def test_loop_without_a_port_for_an_aircraft_is_refused():
    with (
        ff.live.start(ff.digital_elevator(), real_time=False) as session,
        pytest.raises(ff.InputError, match="start it with host=0"),
        ff.fly.fly_live(session, ff.fly.LiveFlight(CASE.at)),
    ):
        pass
