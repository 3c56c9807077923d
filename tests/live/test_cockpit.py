"""All axes of a project in one loop: the bits of a simulation, periods, trips, links, host, record."""

import re
import socket
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import forcefeel as ff
from forcefeel import _core
from forcefeel.errors import InputError

COCKPITS = Path(__file__).parents[2] / "examples" / "cockpit"

LINKED = [
    ("transport-column", "80 lb", "-70 lb"),
    ("uncoupling", "120 lb", "-110 lb"),
    ("linked-sticks", "8 lb", "-6 lb"),
]

FIRST_OFFICER = "stick-pitch-first-officer"

ACTIVE_CYCLES = 4000
"""Until a loader at 2 kHz is active."""

LARGEST_STEP_N = 0.1
"""Of the force of a link from sample to sample: what a hand does not feel."""

SAME = 0.02
"""Of an angle at rest, which the friction of the motor leaves open."""


def columns(session):
    return dict(zip(session.columns, session.history().T, strict=True))


def project_of(folder, text):
    path = folder / "cockpit.toml"
    path.write_text(text, encoding="utf-8")
    return ff.loader.read_project(path)


def in_virtual_time(project, **more):
    return ff.live.start_cockpit(project, "robust", real_time=False, **more)


def running(project, **more):
    """All axes active."""
    cockpit = in_virtual_time(project, **more)
    cockpit.on()
    cockpit.wait(ACTIVE_CYCLES)
    assert {session.state.name for session in cockpit.values()} == {"active"}
    return cockpit


def states(cockpit):
    return {axis: session.state.name for axis, session in cockpit.items()}


@pytest.mark.parametrize(("name", "force", "second"), LINKED)
def test_linked_axes_have_the_bits_of_their_simulation(name, force, second, tmp_path):
    """Shaft with play and override, shaft that uncouples, electronic link; the record replays to the same bits."""
    project = ff.loader.read_project(COCKPITS / f"{name}.toml")
    ((link, joint),) = project.links.items()
    scenario = ff.Scenario(ff.Step(force), duration_s=1.0, sample_s=0.0005)
    both = ff.linked.LinkedScenario(scenario, second_force=ff.Step(second))
    expected = ff.linked.simulate_linked(project, link, both, "robust")
    assert expected.measures.gave_way_at_s < 1.0
    ends = {axis: ff.live.Simulated(of) for axis, of in zip(joint.between, (both.first, both.second), strict=True)}
    record = tmp_path / "run.mcap"
    with in_virtual_time(project, endpoints=ends, supervised=False, record=record) as cockpit:
        cockpit.wait(10**6)
        for side, axis in zip(("first", "second"), joint.between, strict=True):
            # A row has the feel after its sample, a history the feel before it.
            feel = columns(cockpit[axis])["feel_angle_rad"]
            assert np.array_equal(feel, expected.history[f"{side}_feel_position_rad"].values[1:])
    for axis in joint.between:
        assert ff.live.replay(record, axis).same


def test_axes_of_different_periods_run_on_one_clock(tmp_path):
    slow = ff.loader.electric("aileron-wheel").replace({"controller.period": "1 ms"})
    (tmp_path / "wheel.toml").write_text(
        slow.to_toml().replace('name = "aileron-wheel"', 'name = "wheel"'), encoding="utf-8"
    )
    project = project_of(tmp_path, '[axes]\npitch = "elevator-2khz"\nroll = "wheel.toml"\n')
    with running(project) as cockpit:
        cockpit["roll"].hand_force_n = 20.0
        cockpit.wait(2000)
        rows = columns(cockpit["roll"])
        # They count on while they are read: the machine may pause the reader in between.
        before, roll, after = (cockpit[axis].state.cycle for axis in ("pitch", "roll", "pitch"))
        assert before - 2000 <= 2 * roll <= after + 2000
        assert rows["time_s"][-1] == pytest.approx(1e-3 * rows["cycle"][-1])
        assert rows["column_angle_rad"][-1] > 0.01


@pytest.mark.parametrize(
    ("trips", "stopped"),
    [
        ("", {"pitch", "pitch-first-officer"}),
        ("[trips]\npitch = []\n", {"pitch"}),
        ('[trips]\npitch = ["roll"]\n', {"pitch", "roll"}),
        ('[trips]\npitch = "all"\n', {"pitch", "pitch-first-officer", "roll"}),
    ],
)
def test_trip_stops_the_axes_that_the_project_names(tmp_path, trips, stopped):
    axes = '[axes]\npitch = "elevator-2khz"\npitch-first-officer = "elevator-2khz"\nroll = "aileron-wheel"\n'
    link = '[links.pitch]\nbetween = ["pitch", "pitch-first-officer"]\nstiffness = "8000 lb in/rad"\ndamping = "50 lb in s/rad"\n'
    with running(project_of(tmp_path, axes + link + trips)) as cockpit:
        cockpit["pitch"].inject_fault("no_samples")
        cockpit.wait(1000)
        assert {axis for axis, state in states(cockpit).items() if state == "tripped"} == stopped
        for axis in stopped - {"pitch"}:
            assert [trip.name for trip in cockpit[axis].trips] == ["another axis"]


def test_emergency_stop_of_one_axis_stops_all_and_all_restart(tmp_path):
    project = project_of(tmp_path, '[axes]\npitch = "elevator-2khz"\nroll = "aileron-wheel"\nyaw = "rudder-pedals"\n')
    record = tmp_path / "run.mcap"
    with running(project, record=record) as cockpit:
        cockpit["roll"].stop()
        cockpit.wait(1000)
        assert set(states(cockpit).values()) == {"tripped"}
        cockpit.acknowledge()
        cockpit.off()
        cockpit.wait(10)
        assert set(states(cockpit).values()) == {"off"}
        cockpit.on()
        cockpit.wait(ACTIVE_CYCLES)
        assert set(states(cockpit).values()) == {"active"}
    assert all(ff.live.replay(record, axis).same for axis in project.loaders)


def test_electronic_link_comes_and_goes_without_a_step():
    """Apart while it is open, then connected: its force goes to its new value over the fade time. The trip of one side opens it."""
    project = ff.loader.read_project(COCKPITS / "linked-sticks.toml")
    with running(project) as cockpit:
        first, second = cockpit.values()
        cockpit.disconnect("stick-pitch")
        cockpit.wait(2000)
        first.hand_force_n = 10.0
        cockpit.wait(3000)
        assert abs(columns(second)["column_angle_rad"][-1]) < 2e-3
        cockpit.connect("stick-pitch")
        cockpit.wait(3000)
        second.inject_fault("no_samples")
        cockpit.wait(3000)
        assert states(cockpit) == {"stick-pitch": "active", "stick-pitch-first-officer": "tripped"}
        torque = columns(first)["link_torque_n_m"]
        force = torque / first.loader["column.grip_arm"]
        assert np.abs(force).max() > 3
        assert np.abs(np.diff(force)).max() < LARGEST_STEP_N
        assert force[-1] == 0


@pytest.mark.slow
def test_priority_leaves_a_side_its_own_feel_and_the_other_follows(tmp_path):
    """By the button, then by force: the link gives nothing to who has priority, and all to the other."""
    text = (COCKPITS / "linked-sticks.toml").read_text(encoding="utf-8")
    text = re.sub(r"\n(priority|dual_input)_force.*", "", text)
    with running(project_of(tmp_path, text + 'priority_force = "3 lb"\n')) as cockpit:
        first, second = cockpit.values()
        second.hand_force_n = 8.0
        cockpit.wait(2000)
        shared = columns(second)["column_angle_rad"][-1]
        cockpit.disconnect("stick-pitch")
        cockpit.wait(3000)
        alone = columns(second)["column_angle_rad"][-1]
        cockpit.connect("stick-pitch")
        second.priority = True
        cockpit.wait(3000)
        rows = columns(second)
        assert rows["link_torque_n_m"][-1] == 0
        assert rows["column_angle_rad"][-1] == pytest.approx(alone, rel=SAME)
        assert rows["column_angle_rad"][-1] > 1.3 * shared
        assert columns(first)["column_angle_rad"][-1] > 0.3 * rows["column_angle_rad"][-1]
        second.priority = False
        cockpit.wait(3000)
        assert columns(second)["link_torque_n_m"][-1] != 0
        second.hand_force_n = 20.0
        cockpit.wait(3000)
        assert columns(second)["link_torque_n_m"][-1] == 0
    with (
        in_virtual_time(ff.loader.read_project(COCKPITS / "transport-column.toml")) as shaft,
        pytest.raises(InputError, match="priority: is of an electronic link"),
    ):
        shaft["pitch"].priority = True


def test_shaft_between_simulated_machines_is_opened_and_closed():
    project = ff.loader.read_project(COCKPITS / "transport-column.toml")
    with running(project) as cockpit:
        cockpit.disconnect("pitch")
        cockpit["pitch"].hand_force_n = 100.0
        cockpit.wait(4000)
        apart = [columns(session)["column_angle_rad"][-1] for session in cockpit.values()]
        cockpit.connect("pitch")
        cockpit.wait(6000)
        together = [columns(session)["column_angle_rad"][-1] for session in cockpit.values()]
    assert apart[0] > 0.05 > 10 * abs(apart[1])
    # Shaft and feels of both: the first goes back, the second follows within the twist of the shaft.
    assert apart[0] > together[0] > together[1] > 0.4 * together[0]


@pytest.mark.slow
def test_host_sends_one_datagram_for_all_axes(tmp_path):
    project = project_of(
        tmp_path, '[axes]\npitch = "elevator-2khz"\nroll = "aileron-wheel"\n[flap_trim]\npitch = -0.1\n'
    )
    with (
        ff.live.start_cockpit(project, "robust", host=0) as cockpit,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as host,
    ):
        host.settimeout(0.5)
        address, port = cockpit["pitch"].host.listens.split(":")
        trims = {"pitch": 0.02, "roll": 0.1}

        def send(sequence, axes):
            packets = [_core.host_packet(sequence, 1, {"trim": trims[axis], "flap": 0.5}) for axis in axes]
            host.sendto(b"".join(packets), (address, int(port)))

        cockpit.on()
        answers = []
        for sequence in range(1, 200):
            send(sequence, trims)
            with suppress(TimeoutError):  # a loop that is late gives none, and a host sends on
                answers.append(host.recv(2048))
        assert len(answers) > 190
        answer = answers[-1]
        assert len(answer) % 2 == 0
        parts = [answer[: len(answer) // 2], answer[len(answer) // 2 :]]
        assert all(_core.host_answer(part) is not None for part in parts)
        send(500, ["pitch"])  # one axis is missing
        cockpit.wait(200)
        assert cockpit["roll"].host.refused == 1
        neutral = {axis: columns(session)["neutral_rad"][-1] for axis, session in cockpit.items()}
        # The flaps move the neutral of pitch by -0.05 rad.
        assert neutral["pitch"] < 0 < neutral["roll"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('[axes]\npitch = "elevator-2khz"\n[trips]\nroll = []\n', "trips.roll: expected an axis of \\[axes\\]"),
        (
            '[axes]\npitch = "elevator-2khz"\n[trips]\npitch = "some"\n',
            'trips.pitch: expected "all", or a list of axes',
        ),
        (
            '[axes]\npitch = "elevator-2khz"\n[trips]\npitch = ["roll"]\n',
            'trips.pitch: expected "all", or a list of axes',
        ),
    ],
)
def test_bad_table_of_trips_is_refused(tmp_path, text, message):
    with pytest.raises(InputError, match=message):
        project_of(tmp_path, text)


def test_what_does_not_fit_is_refused_with_its_axis(tmp_path):
    analog = project_of(tmp_path, '[axes]\npitch = "elevator-1974"\nroll = "aileron-wheel"\n')
    with pytest.raises(InputError, match=r"axes.pitch: controller.period"):
        in_virtual_time(analog)
    one_real = {"pitch": ff.live.Udp("127.0.0.1:5999")}
    with pytest.raises(InputError, match=r"links.pitch: is a shaft .* got one of each"):
        in_virtual_time(ff.loader.read_project(COCKPITS / "transport-column.toml"), endpoints=one_real)
    sticks = ff.loader.read_project(COCKPITS / "linked-sticks.toml")
    slow = {FIRST_OFFICER: sticks.loaders[FIRST_OFFICER].replace({"controller.period": "1 ms"})}
    real = {axis: ff.live.Udp("127.0.0.1:5999") for axis in sticks.loaders}
    with pytest.raises(InputError, match=r"controller.period: expected one period for"):
        in_virtual_time(replace(sticks, loaders={**sticks.loaders, **slow}), endpoints=real)
    with pytest.raises(InputError, match="endpoints: expected axes of the project"):
        in_virtual_time(sticks, endpoints={"roll": ff.live.Simulated()})
    with in_virtual_time(sticks) as cockpit, pytest.raises(InputError, match="link: expected one of stick-pitch"):
        cockpit.disconnect("stick")
    with ff.live.start(ff.digital_elevator(), real_time=False) as alone, pytest.raises(InputError, match="has none"):
        alone.disconnect()


def test_record_of_a_cockpit_names_its_axes(tmp_path):
    record = tmp_path / "run.mcap"
    with in_virtual_time(ff.loader.read_project(COCKPITS / "cockpit.toml"), record=record) as cockpit:
        cockpit.wait(100)
    assert ff.live.read_live_record(record, "roll").about["loader"] == "aileron-wheel"
    with pytest.raises(InputError, match=r"has the axes pitch, roll, yaw: choose one"):
        ff.live.read_live_record(record)
    with pytest.raises(InputError, match="choose one"):
        ff.live.replay(record, "stick-roll")


def test_bench_data_are_read_from_an_axis_of_a_record(tmp_path):
    record = tmp_path / "run.mcap"
    project = ff.loader.read_project(COCKPITS / "cockpit.toml")
    with running(project, record=record) as cockpit:
        cockpit["roll"].hand_force_n = 20.0
        cockpit.wait(500)
    assert ff.read_bench_data(record / "roll").run["loader"] == "aileron-wheel"
    with pytest.raises(InputError, match=r"has the axes pitch, roll, yaw: choose one, such as run.mcap/pitch"):
        ff.read_bench_data(record)
