"""The console in a process of its own: stopped, killed, killed again; and a run told to end meanwhile. One after the other."""

import json
import os
import signal
import time
from pathlib import Path

import pytest
from websockets.exceptions import ConnectionClosed

import forcefeel as ff
from forcefeel.live.console import process
from forcefeel.live.console.listener import Listener
from forcefeel.live.console.session import HAND_LAPSES_S
from forcefeel.qualification.plan.run import QualificationSetup
from tests.live.console.conftest import Talk
from tests.live.run_command import run_command
from tests.live.unhurried import unhurried_elevator
from tests.parametrization import mostly_slow

PATIENCE_S = 60.0
STOPPED_S = 2.0
HAND_N = 40.0
STIFFNESS = 700.0
OF_OTHERS = 0.1
"""Share of the beats that a machine with others on it may miss; a loop that were stopped along would miss all of them."""


class Console:
    """The door of a console, and what was told of its servers."""

    def __init__(self, running):
        self.door, self.told = Listener.at(0, "127.0.0.1", token=True), []
        self.admission, self.address = self.door.admission, self.door.address
        self.process = process.ConsoleProcess({"": running}, self.door, QualificationSetup(), self.told.append)


def until(holds):
    end = time.monotonic() + PATIENCE_S
    while not holds():
        assert time.monotonic() < end
        time.sleep(0.01)


def is_stopped(process_id):
    """Each of its threads, which a busy machine may take a while for."""
    stats = [(task / "stat").read_text() for task in Path(f"/proc/{process_id}/task").iterdir()]
    return all(stat.rpartition(")")[2].split()[0] == "T" for stat in stats)


@pytest.fixture(scope="module")
def running():
    with ff.live.start(unhurried_elevator(), "robust") as loop:
        yield loop


@pytest.fixture(scope="module")
def console(running):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(process, "_SHORT_LIFE_S", STOPPED_S)
        found = Console(running)
        with found.process:
            yield found


def test_stopped_server_neither_delays_loop_nor_acts_late(running, console):
    with Talk(console, open_timeout=PATIENCE_S) as talk:
        talk.send(do="on")
        talk.status(state="active")
        talk.send(do="feel", rows={"feel.stiffness": STIFFNESS})
        until(lambda: running.loader["feel.stiffness"] == STIFFNESS)
        talk.send(do="hand", force_n=HAND_N)
        until(lambda: running.hand_force_n == HAND_N)
        server = console.process.process_id
        os.kill(server, signal.SIGSTOP)
        until(lambda: is_stopped(server))
        begin, state = time.monotonic(), running.state
        talk.send(do="around", trim_rad=0.1)
        talk.send(do="off")
        until(lambda: running.hand_force_n == 0.0)
        held_s = time.monotonic() - begin
        time.sleep(max(0.0, STOPPED_S - held_s))
        now = running.state
        os.kill(server, signal.SIGCONT)
        with pytest.raises(ConnectionClosed) as closed:
            talk.notice("never")
    assert closed.value.rcvd.code == 1012
    assert held_s < 2 * HAND_LAPSES_S
    assert now.name == "active"
    beats = STOPPED_S / running.period_s
    assert now.missed - state.missed < OF_OTHERS * beats
    assert now.cycle - state.cycle > (1 - 2 * OF_OTHERS) * beats
    with Talk(console, open_timeout=PATIENCE_S) as again:  # as a page does by itself
        status = again.notice("status")
        assert again.frame()
    assert (status["state"], status["trim_rad"]) == ("active", 0.0)
    assert status["feel"]["feel.stiffness"] == STIFFNESS
    assert console.process.process_id == server
    assert console.told == []


def test_a_server_that_is_killed_is_replaced_at_the_same_address(running, console):
    killed = console.process.process_id
    with Talk(console, open_timeout=PATIENCE_S) as talk:
        talk.send(do="hand", angle_rad=0.05)
        until(lambda: running.hand_angle_rad == 0.05)
        os.kill(killed, signal.SIGKILL)
        until(lambda: running.hand_angle_rad is None)
    with Talk(console, open_timeout=PATIENCE_S) as again:
        status = again.status(state="active")
        assert again.frame()
    assert status["feel"]["feel.stiffness"] == STIFFNESS
    assert console.process.process_id != killed
    assert len(console.told) == 1
    assert "by signal SIGKILL" in console.told[0]
    assert "same address" in console.told[0]


@pytest.mark.slow
def test_server_that_ends_at_once_is_not_restarted(running, console):
    running.on()
    until(lambda: running.state.name == "active")
    while (server := console.process.process_id) is not None:
        told = len(console.told)
        os.kill(server, signal.SIGKILL)
        until(lambda seen=told: len(console.told) > seen)
    assert "too soon" in console.told[-1]
    until(lambda: console.door.listening.fileno() < 0)
    with pytest.raises(ConnectionRefusedError), Talk(console, open_timeout=PATIENCE_S):
        pass
    assert running.state.name == "active"


def servers(process):
    return [
        int(child)
        for task in Path(f"/proc/{process.pid}/task").iterdir()
        for child in (task / "children").read_text().split()
    ]


@pytest.mark.parametrize("told", mostly_slow([signal.SIGINT, signal.SIGTERM]), ids=lambda told: told.name)
def test_run_with_stopped_server_ends_cleanly(told):
    with run_command("elevator-2khz", "--port", "0", "--json") as process:
        address, watch = process.stderr.readline(), process.stderr.readline()
        (server,) = servers(process)
        os.kill(server, signal.SIGSTOP)
        process.send_signal(told)
        out, err = process.communicate(timeout=PATIENCE_S)
    assert (process.returncode, err) == (0, "")
    assert address.startswith("console: http://127.0.0.1:")
    assert watch.startswith("to look on and stop: http://127.0.0.1:")
    assert json.loads(out)["trips"] == []
    assert not Path(f"/proc/{server}").exists()
