"""What is asked of a running loop and seen of it, in virtual time."""

import os
from pathlib import Path

import numpy as np
import pytest

import forcefeel as ff
from tests.live.planned import planned


@pytest.fixture(scope="module")
def loader():
    return ff.digital_elevator()


def active(running):
    """Switches on and waits until the feel is there."""
    running.on()
    for _ in range(100):
        running.wait(500)
        if running.state.name == "active":
            return
    raise AssertionError(running.state)


def column(running, name, since=-1):
    return running.history(since)[:, running.columns.index(name)]


@pytest.fixture
def running(loader):
    with ff.live.start(loader, "robust", real_time=False) as running:
        active(running)
        yield running


def settled(running, cycles=6000):
    running.wait(cycles)
    return dict(zip(running.columns, running.history(most=1)[0], strict=True))


STEADY_RAD = 3e-3
"""Resolution of the sensors and what is left of a transient."""


def test_live_angle_matches_programmed_feel(running, loader):
    running.hand_force_n = 100.0
    expected = 100.0 * loader["column.grip_arm"] / loader["feel.stiffness"]
    assert settled(running)["column_angle_rad"] == pytest.approx(expected, abs=STEADY_RAD)
    running.feel = {"feel.stiffness": 2 * loader["feel.stiffness"]}
    assert settled(running)["column_angle_rad"] == pytest.approx(expected / 2, abs=STEADY_RAD)
    assert running.feel["feel.stiffness"] == 2 * loader["feel.stiffness"]
    running.stiffness_factor = 2.0
    assert settled(running)["column_angle_rad"] == pytest.approx(expected / 4, abs=STEADY_RAD)


def test_feel_change_is_bumpless(running, loader):
    running.hand_force_n = 50.0
    settled(running)
    before = running.history(most=4000)
    running.feel = {
        "feel.stiffness": 1.5 * loader["feel.stiffness"],
        "feel.damping": 2 * loader["feel.damping"],
        "feel.inertia": 1.5 * loader["feel.inertia"],
        "feel.breakout": "2 lb",
    }
    running.wait(1500)
    # As many samples as before: the maximum of noise grows with their number.
    after = running.history(since=before[-1, running.columns.index("cycle")])[: len(before)]
    command = running.columns.index("command")
    noise = np.abs(np.diff(before[:, command])).max()
    # A sample's change of the command stays what noise makes of it; a jump of the feel would be a hundred times that.
    assert np.abs(np.diff(after[:, command])).max() < 2 * noise + 1e-3  # V, a step of the converter


def test_trim_moves_at_its_rate(running):
    running.trim_rad = 0.05
    running.wait(2000)
    steps = np.diff(column(running, "neutral_rad"))
    assert steps.max() == pytest.approx(0.1 * running.period_s, rel=1e-6)  # differences of angles
    assert settled(running)["column_angle_rad"] == pytest.approx(0.05, abs=STEADY_RAD)


def test_hand_holds_and_releases_angle(running):
    running.hand_angle_rad = 0.1
    assert settled(running)["column_angle_rad"] == pytest.approx(0.1, abs=STEADY_RAD)
    assert settled(running)["pilot_force_n"] > 50
    running.hand_angle_rad = None
    assert settled(running)["column_angle_rad"] == pytest.approx(0.0, abs=STEADY_RAD)


def test_a_hand_that_turns_from_full_pull_to_full_push_does_not_stop_the_loader(loader):
    """Each force has its cycles: a loop that ran ahead of a busy test would rightly trip on a force held for seconds."""
    turns = [(6000, 0), (6100, 400), (7000, 400), (7200, -400), (8000, -400), (8200, 400), (9000, 400), (9001, 0)]
    force = np.interp(np.arange(10_000), *zip(*turns, strict=True))  # 400 N in 0.05 s, as the simulated hand
    history = planned(loader, force, [(0, "on", [])])
    assert not history["trips"].any()
    assert (history["state"][6000:] == ff.live.STATES.index("active")).all()


@pytest.mark.parametrize(
    ("fault", "trip"),
    [
        (("not_a_number", "column"), "not a number"),
        (("no_samples",), "sensors silent"),
        (("jump", "drive", 0.05), "drive position implausible"),
    ],
)
def test_a_fault_stops_the_loader(running, fault, trip):
    running.inject_fault(*fault)
    running.wait(2000)
    assert running.state.name == "tripped"
    assert trip in running.state.trips
    assert running.trips[0].sentence
    last = settled(running, 10)
    assert (last["command"], last["enable"]) == (0.0, 0.0)
    running.clear_faults()
    running.wait(200)  # a sensor that comes back jumps once more
    running.acknowledge()
    running.wait(100)
    assert running.state.trips == ()
    # Nothing starts by itself; off and on in the same cycle is as good as one after the other.
    running.wait(2000)
    assert running.state.name == "off"
    running.off()
    active(running)


def test_stop_cuts_the_drive_in_a_cycle(running):
    running.stop()
    running.wait(200)
    history = dict(zip(running.columns, running.history().T, strict=True))
    stopped = history["state"] == ff.live.STATES.index("tripped")
    assert stopped.any()
    assert not history["enable"][stopped].any()
    assert running.state.trips == ("emergency stop",)


def test_history_continues_after_last_cycle(running):
    first = running.history(most=10)
    assert first.shape == (10, len(running.columns))
    cycle = running.columns.index("cycle")
    running.wait(50)
    then = running.history(since=first[-1, cycle])
    assert then[0, cycle] == first[-1, cycle] + 1
    assert np.all(np.diff(then[:, cycle]) == 1)
    assert running.timing.work.total >= len(then)


@pytest.mark.parametrize(
    ("ask", "part"),
    [
        (lambda r: setattr(r, "feel", {"column.inertia": 1.0}), "rows of the feel"),
        (lambda r: setattr(r, "trim_rad", 7.0), "trim_rad"),
        (lambda r: setattr(r, "shaker", 2.0), "shaker"),
        (lambda r: setattr(r, "hand_force_n", 1e6), "hand_force_n"),
        (lambda r: r.inject_fault("magic"), "fault"),
        (lambda r: r.inject_fault("stuck"), "sensor"),
    ],
)
def test_invalid_live_request_raises_input_error(loader, ask, part):
    with ff.live.start(loader, "robust", real_time=False) as running, pytest.raises(ff.InputError, match=part):
        ask(running)


def test_a_loader_without_a_digital_controller_is_refused():
    with pytest.raises(ff.InputError, match=r"controller\.period"):
        ff.live.start(ff.elevator())


def test_a_real_time_loop_keeps_its_period(loader):
    with ff.live.start(loader, "robust") as running:
        running.on()
        running.wait(400)
        *_, pinned = running.realtime_status
        assert len(running.realtime_status) == 4
        tasks = Path("/proc/self/task")
        if tasks.is_dir():
            (loop,) = (it.name for it in tasks.iterdir() if (it / "comm").read_text().strip() == "forcefeel-loop")
            assert (len(os.sched_getaffinity(int(loop))) == 1) == (pinned == "stays on an isolated processor")
        state = running.state
    # Beats that went by are counted, whether the machine was quick enough or not.
    time_s = column(running, "time_s")
    assert state.time_s == pytest.approx((state.cycle + state.missed) * 5e-4, rel=0.1)  # a clock that others share
    steps = np.diff(time_s) / 5e-4
    missed = column(running, "missed")[1:]
    assert np.allclose(steps, 1 + missed)
