"""What watchers see and what the one who holds control may do."""

import socket
import time
from types import SimpleNamespace

import numpy as np
import pytest
from websockets.exceptions import ConnectionClosed

import forcefeel as ff
from forcefeel.live import Console
from forcefeel.live.console.telemetry import FOUND_OVER_S, HEADER, Telemetry, channels, packed
from forcefeel.units import UnitSystem
from tests.live.console.conftest import Talk
from tests.live.console.stand_in import StandIn

SOON_S = 5.0
LAG = 20
"""Cycles."""


def until(holds):
    end = time.monotonic() + SOON_S
    while not holds():
        assert time.monotonic() < end
        time.sleep(0.01)


def test_a_frame_keeps_the_extremes_in_their_order():
    values = np.array([[0.0, 5.0, np.nan], [3.0, -1.0, np.nan], [1.0, 2.0, np.nan]])
    found = np.frombuffer(packed(values), "<f4").reshape(3, 3)
    assert found[0].tolist() == [0.0, 3.0, 1.0]
    assert found[1].tolist() == [5.0, -1.0, 2.0]
    assert np.isnan(found[2]).all()


def test_frames_arrive_at_60_hz_without_missing_rows(talk):
    talk.frame()
    frames = [talk.frame() for _ in range(60)]
    heads = [HEADER.unpack(frame[: HEADER.size]) for frame in frames]
    times, rows, numbers = zip(*heads, strict=True)
    assert np.median(np.diff(times)) == pytest.approx(1 / 60, rel=0.5)  # of a machine that others use too
    assert np.diff(numbers).tolist() == [1] * 59
    assert sum(rows[1:]) == round((times[-1] - times[0]) / 1e-3)


def test_frames_begin_when_history_lags_behind_loop(running):
    """As the real one does: its rows come to the history some milliseconds after the cycle is counted."""
    until(lambda: running.state.cycle > LAG)
    told = SimpleNamespace(
        columns=running.columns,
        period_s=running.period_s,
        state=SimpleNamespace(cycle=running.state.cycle + LAG),
        history=running.history,
    )
    frames = Telemetry(told, channels(told, running.loader), UnitSystem.US)
    assert HEADER.unpack(frames.frame()[: HEADER.size])[1:] == (1, 1)  # rows, number


def test_estimated_force_is_averaged_over_a_tenth_of_a_second(running):
    rng, cycles = np.random.default_rng(7), 600
    rows = np.zeros((cycles, len(running.columns)))
    rows[:, running.columns.index("cycle")] = np.arange(cycles)
    found = running.columns.index("feel_torque_n_m")
    rows[:, found] = rng.normal(size=cycles)
    loop = SimpleNamespace(columns=running.columns, period_s=running.period_s)
    shown = channels(loop, running.loader)
    frames = Telemetry(loop, shown, UnitSystem.SI)
    cycle, place = 0, [one.column for one in shown].index("feel_torque_n_m")
    while cycle < cycles:  # frames of rows as they come
        loop.history = lambda since, most, end=cycle + 1: rows[max(int(since) + 1, end - most) : end]
        last = np.frombuffer(frames.frame()[HEADER.size :], "<f4").reshape(-1, 3)[place, 2]
        cycle += int(rng.integers(5, 40))
    samples = round(FOUND_OVER_S / running.period_s)
    end = int(frames._seen) + 1
    mean = rows[end - samples : end, found].mean() / running.loader["column.grip_arm"]
    assert last == pytest.approx(mean, rel=1e-5)  # of single precision
    assert shown[place].label == "estimate of the law, mean of 0.1 s"


def test_hello_and_status_contain_all_page_fields(talk):
    hello = talk.notice("hello")
    assert (hello["loader"], hello["law"], hello["role"]) == ("elevator-2khz", "robust", "control")
    assert [one["unit"] for one in hello["channels"]][:1] == ["deg"]
    sliders = {one["key"]: one for one in hello["sliders"]}
    assert sliders["feel.stiffness"]["unit"] == "lb·in/rad"
    status = talk.status(state="active")
    for key, slider in sliders.items():
        assert slider["low"] <= status["feel"][key] <= slider["high"]
    curve = talk.notice("curve")["curve"]
    assert curve["tolerance"] == "10 % or 5 lb, whichever is larger"
    up, low, high = (np.array(curve[name], dtype=float) for name in ("up", "up_low", "up_high"))
    assert np.all((low < up) & (up < high))


def test_feel_trim_and_hand_reach_the_loop(talk, running):
    talk.send(do="feel", rows={"feel.stiffness": 700.0, "feel.breakout": 10.0})
    talk.send(do="around", trim_rad=0.05)
    talk.send(do="hand", force_n=40.0)
    until(lambda: running.hand_force_n == 40.0 and running.trim_rad == 0.05)
    until(lambda: running.loader["feel.stiffness"] == 700.0)
    assert talk.status(trim_rad=0.05)["feel"]["feel.breakout"] in (0.0, 10.0)
    talk.send(do="feel", rows={"feel.stiffness": -1.0})
    assert "feel.stiffness" in talk.notice("refused")["reason"]
    assert running.loader["feel.stiffness"] == 700.0


def test_one_client_holds_control_and_every_client_may_stop(console, running):
    with Talk(console) as first, Talk(console) as second, Talk(console, console.admission.watch) as looker:
        mine, its = (one.notice("hello")["you"] for one in (first, second))
        first.status(watchers=3, holder=mine)
        for other in (second, looker):
            other.send(do="hand", force_n=50.0)
            assert "control" in other.notice("refused")["reason"]
        assert running.hand_force_n == 0
        looker.send(do="stop")
        assert first.status(state="tripped")["trips"][0]["name"] == "stop"
        first.send(do="acknowledge")
        first.status(state="passive", trips=[])
        second.send(do="accept_host")
        assert "control" in second.notice("refused")["reason"]
        first.send(do="accept_host")
        until(lambda: "accept_host" in running.calls)
        first.send(do="give")
        second.status(holder=None)
        second.send(do="take")
        second.status(holder=its)
        looker.send(do="take")
        assert "for watching" in looker.notice("refused")["reason"]


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
def test_frame_error_ends_the_server(console, running, monkeypatch):
    def none(_):
        raise ZeroDivisionError

    with Talk(console) as mine:
        mine.send(do="hand", force_n=30.0)
        until(lambda: running.hand_force_n == 30.0)
        monkeypatch.setattr(Telemetry, "frame", none)
        until(lambda: not console.serves)
        assert running.hand_force_n == 0.0
        with pytest.raises(ConnectionClosed):
            mine.notice("never")


def test_hand_force_expires_and_ends_with_its_page(console, running):
    with Talk(console) as mine:
        mine.send(do="hand", force_n=30.0)
        until(lambda: running.hand_force_n == 30.0)
        until(lambda: running.hand_force_n == 0.0)
        mine.send(do="hand", angle_rad=0.1)
        until(lambda: running.hand_angle_rad == 0.1)
        gone = time.monotonic()
        mine.socket.socket.close()  # without a good-bye
    until(lambda: running.hand_angle_rad is None)
    assert time.monotonic() - gone < SOON_S
    with Talk(console) as other:
        you = other.notice("hello")["you"]
        assert other.status(watchers=1)["holder"] == you


def test_stalled_watcher_does_not_delay_other_clients(console):
    """It reads nothing at all, with all the room that its system gives; the other has every frame."""
    with socket.create_connection(("127.0.0.1", console.admission.port)) as stalled, Talk(console) as good:
        token, host = console.admission.watch, f"127.0.0.1:{console.admission.port}"
        stalled.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 2048)
        stalled.sendall(
            f"GET /live HTTP/1.1\r\nHost: {host}\r\nAuthorization: Bearer {token}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
            "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n".encode()
        )
        good.status(watchers=2)
        numbers = [HEADER.unpack(good.frame()[: HEADER.size])[2] for _ in range(120)]
        assert np.diff(numbers).tolist() == [1] * 119


def test_release_returns_a_verdict():
    with StandIn(speed=8.0) as running, Console(running, port=0) as console, Talk(console) as talk:
        running.on()
        talk.send(do="test", test="release", side="negative")
        assert talk.notice("status", lambda it: it["test"])["test"]["test"] == "release"
        talk.send(do="hand", force_n=1.0)
        assert "a test is running" in talk.notice("refused")["reason"]
        found = talk.notice("test")["judged"]
        assert found["title"] == "Release from 50 % of the throw, negative"
        assert found["passed"], found["sentence"]
        assert {len(found["plot"][key]) for key in ("x", "measured", "reference")} == {900}
        assert running.hand_force_n == 0


def test_stop_aborts_a_test(talk, running):
    talk.send(do="test", test="release")
    until(lambda: running.hand_force_n != 0)
    talk.send(do="stop")
    assert "aborted" in talk.notice("test")["reason"]
    assert running.hand_force_n == 0


@pytest.mark.slow
def test_sweep_returns_a_verdict():
    strong = ff.digital_elevator().replace({"safety.force_limit": "150 lb"})
    with StandIn(strong, speed=None) as fast, Console(fast, port=0) as console, Talk(console) as talk:
        fast.on()
        talk.send(do="test", test="sweep")
        found = talk.notice("test")
        assert "judged" in found, found.get("reason")
        assert found["judged"]["passed"], found["judged"]["sentence"]
        assert found["judged"]["plot"]["kind"] == "sweep"


def test_sweep_beyond_supervisor_limit_is_refused_with_remedy(running, talk):
    talk.send(do="test", test="sweep")
    reason = talk.notice("test")["reason"]
    assert "up to 104 lb" in reason
    assert "safety.force_limit of 75 lb" in reason
    assert running.hand_force_n == 0


def test_closing_console_releases_hand_and_loop_continues(running):
    with Console(running, port=0) as console, Talk(console) as talk:
        talk.send(do="hand", force_n=25.0)
        until(lambda: running.hand_force_n == 25.0)
    assert running.hand_force_n == 0.0
    assert running.state.name == "active"
