"""A valve and its sensors at analog terminals on EtherCAT: runs, foreign master, faults, bad input."""

import re
import struct
import subprocess
import sys
import time
import tomllib
from dataclasses import replace

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.bus import bench_record
from forcefeel.live.bus import check_bus
from tests.command_line import runs
from tests.live.bus_wire import NEEDS_ROOT, before_others, run_that_kept_time, virtual_interfaces
from tests.live.test_bus import QUIET, activate, column, running, until

run = runs("run")
bus_command = runs("bus")

VALVE = ff.digital_elevator()
WIRED = {
    "input_node": 2,
    "output_v": 10.0,
    "output_object": "0x7000:1",
    "load_cell_n": 11_000.0,
    "load_cell_object": "0x6000:17",
    "position_m": 0.3,
    "position_object": "0x6010:17",
    "column_range_rad": 0.7,
    "column_object": "0x6020:17",
}
END = 32767
"""Number at the end of a range."""

OF_A_STEP = 0.01
"""Share by which an overshoot and a speed may be off their closed forms: steps of 16 bits, a push that rises within 50 ms."""

OF_TWO = 0.05
"""Of two parameters that are identified alone, of steps of 16 bits. Measured: 0.035."""

NUMBERS = {
    "load_cell.resolution": WIRED["load_cell_n"] / END,
    "potentiometer.resolution": WIRED["position_m"] / END,
    "column_sensor.resolution": WIRED["column_range_rad"] / END,
}
"""Steps of the terminals' inputs."""


def valve(port="pty", loader=VALVE, **bus):
    return replace(loader.replace(NUMBERS, si=True), bus=ff.loader.Bus("ethercat-analog", port, **WIRED | bus))


@NEEDS_ROOT
@pytest.mark.parametrize("wiring", [{"position_zero_m": -0.05, "column_zero_rad": 0.1, "output_v": -8.0}])
def test_valve_at_terminals_follows_its_feel_as_in_process(wiring):
    loader = valve(loader=VALVE.replace(QUIET), **wiring | {"position_m": -0.3, "column_range_rad": -0.7})
    push_n, angles = 60.0, []
    with running(loader) as (session, emulator):
        session.on()
        session.wait(3000)
        emulator.push(push_n)
        session.wait(9000)
        angles.append(column(session, "column_angle_rad"))
        assert session.state.name == "active"
        assert not session.state.drive_fault
    with ff.live.start(replace(loader, bus=None), "robust", real_time=False) as session:
        session.on()
        session.wait(3000)
        session.hand_force_n = push_n
        session.wait(9000)
        angles.append(column(session, "column_angle_rad"))
    rest = push_n * loader["column.grip_arm"] / loader["feel.stiffness"]
    # The push comes anywhere within a period: the curves are laid over each other where they cross half of it.
    over, inside = (it[np.argmax(it > 0.5 * rest) - 200 :][:8000] for it in angles)
    assert np.abs(over - inside).max() < 0.03 * rest
    # The feel's own step: rest, and exp(-pi zeta / sqrt(1 - zeta^2)) beyond it.
    assert over[-500:].mean() == pytest.approx(rest, rel=0.005)
    assert over.max() == pytest.approx(1.527 * rest, rel=OF_A_STEP)


@NEEDS_ROOT
def test_soem_moves_the_valve_by_the_closed_form():
    pysoem = pytest.importorskip("pysoem")
    loader = VALVE.replace(QUIET | {"valve.orifice": False})
    volts, cycles = 0.5, 600
    with virtual_interfaces() as ends, ff.live.BusEmulator([valve(ends[1], loader)], real_time=False):
        master = pysoem.Master()
        master.open(ends[0])
        try:
            until(lambda: master.config_init() == 2)
            master.config_map()
            outputs, inputs = master.slaves
            # Four channels of 16 bits; four of a status and a number.
            assert [len(outputs.output), len(inputs.input)] == [8, 16]
            assert struct.unpack("<H", outputs.sdo_read(0x1C12, 2)) == (0x1601,)
            assert struct.unpack("<I", inputs.sdo_read(0x1A02, 11)) == (0x60101110,)
            assert master.state_check(pysoem.SAFEOP_STATE, 5_000_000) == pysoem.SAFEOP_STATE
            outputs.output = bytes(8)
            master.send_processdata()
            master.receive_processdata(1_000_000)
            master.state = pysoem.OP_STATE
            master.write_state()
            positions = []
            for _ in range(cycles):
                outputs.output = struct.pack("<4h", round(volts / 10 * END), 0, 0, 0)
                master.send_processdata()
                assert master.receive_processdata(1_000_000) == master.expected_wkc
                positions.append(struct.unpack("<8h", inputs.input)[3] / END * WIRED["position_m"])
            master.read_state()
            assert [slave.state for slave in master.slaves] == [pysoem.OP_STATE] * 2
            master.state = pysoem.INIT_STATE
            master.write_state()
        finally:
            master.close()
    # Once it runs evenly no pressure is needed: A x' = K_2 C_i e, eqs. (2), (5), (9).
    speed = (positions[-1] - positions[-201]) / (200 * loader["controller.period"])
    flow = loader["valve.current_gain"] * loader["amplifier.admittance"] * volts
    assert speed == pytest.approx(flow / loader["actuator.area"], rel=OF_A_STEP)


@NEEDS_ROOT
@pytest.mark.parametrize(
    ("fault", "name"),
    [("gone", "node silent"), ("miscounted", "wrong working counter"), (None, "EtherCAT: no valid inputs")],
)
def test_silent_or_failed_terminal_gives_no_command_and_nothing_re_engages_by_itself(fault, name):
    slower = {"controller.period": "1 ms", "controller.delay": "1 ms", "safety.overrun_time": "1 s"}
    loader = valve(loader=VALVE.replace(slower))
    with running(loader, real_time=True) as (session, emulator):
        activate(session)
        emulator.push(50.0)
        session.wait(100)
        if fault is None:
            emulator.fail(0x18)
        else:
            emulator.break_wire(fault)
        until(lambda: session.state.name == "tripped" and session.state.drive_fault.startswith(name))
        time.sleep(2 * loader.bus.watchdog_s)
        assert emulator.commands == [0.0]
        emulator.break_wire(None)
        session.wait(400)
        assert session.state.name == "tripped"
        assert emulator.commands == [0.0]


@NEEDS_ROOT
@pytest.mark.parametrize(
    ("wiring", "says"),
    [
        ({"output_object": "0x7040:1"}, "mapped, which are 0x7000:1, 0x7010:1, 0x7020:1, 0x7030:1; change [bus]"),
        ({"column_object": "0x6020:16"}, "0x6020:16: expected an object of 16 bits"),
        ({"input_node": 3}, "expected a slave at position 3, got 2 on the wire; check power and [bus] input_node"),
    ],
)
def test_terminal_that_lacks_what_the_file_names_is_refused(wiring, says):
    with virtual_interfaces() as ends, ff.live.BusEmulator([valve(ends[1])], real_time=False):
        loader = valve(ends[0], **wiring)
        with pytest.raises(ff.InputError) as refused:
            ff.live.start(loader, "robust", endpoint=loader.bus, real_time=False)
    assert says in str(refused.value)


@pytest.mark.parametrize(
    ("wiring", "says"),
    [
        ({"input_node": None}, "input_node: missing value; add input_node = 2"),
        ({"column_object": None}, 'column_object: missing value; add column_object = "0x6020:17"'),
        ({"gear": 2.0}, "gear: not with kind"),
        ({"rated_torque_n_m": 2.0}, 'rated_torque: expected it with kind = "ethercat" only'),
        ({"output_v": 0.0}, "output_v: expected a number other than zero"),
    ],
)
def test_bad_table_of_terminals_is_refused(wiring, says):
    with pytest.raises(ff.InputError) as refused:
        valve(**wiring)
    assert says in str(refused.value)


@NEEDS_ROOT
def test_file_that_states_finer_sensors_than_the_terminals_have_is_refused():
    # A law takes the coarser numbers for contact, and damps a feel of 0.2 like one of 0.7.
    loader = valve().replace({"column_sensor.resolution": "1e-5 deg"})
    with pytest.raises(ff.InputError, match=r"set column_sensor\.resolution = 2\.136e-5 rad"):
        ff.live.start(loader, "robust", endpoint=loader.bus, real_time=False)


def test_grip_sensor_that_the_loader_does_not_have_needs_no_resolution():
    loader = valve(grip_sensor_n=500.0, grip_object="0x6030:17")
    check_bus(loader.bus, loader, ff.Law.of("robust", loader))
    trusted = loader.replace({"grip_sensor.gain": 1.0, "grip_sensor.resolution": "0.001 N"})
    with pytest.raises(ff.InputError, match="set grip_sensor"):
        check_bus(trusted.bus, trusted, ff.Law.of("robust", trusted))


def test_terminals_are_for_valves_and_drives_for_motors():
    yoke = ff.loader.electric("desktop-yoke")
    with pytest.raises(ff.InputError, match="expected a kind for electric drives"):
        valve(loader=yoke)
    with pytest.raises(ff.InputError, match="ethercat-analog or udp"):
        replace(VALVE, bus=ff.loader.Bus("moteus", "/dev/ttyACM0"))


def test_table_of_terminals_round_trips_through_the_file(tmp_path):
    stated = valve("eth0", position_zero_m=0.01, grip_sensor_n=500.0, grip_object="0x6030:17")
    path = tmp_path / "valve.toml"
    path.write_text(stated.to_toml(), encoding="utf-8")
    again = ff.load(path)
    assert again.to_toml() == stated.to_toml()
    assert again.bus.resolution == pytest.approx(stated.bus.resolution)


@NEEDS_ROOT
def test_record_of_a_valve_over_the_terminals_lies_on_the_simulation():
    channels = ("column_angle", "piston_position", "load_cell_force")
    with virtual_interfaces() as ends, ff.live.BusEmulator([valve(ends[1], VALVE.replace(QUIET))], real_time=False):
        loader = valve(ends[0], VALVE.replace(QUIET))
        plan = ff.bench.ExcitationPlan(time_s=2.0, rate_hz=2000.0, measured=channels)
        signal = ff.bench.excite(loader, "J,k", "loader command_signal", plan)
        record = ff.bus.play(signal, real_time=False)
    scenario = ff.Scenario(
        command_signal_v=ff.Recorded(signal.time_s, signal.signal), duration_s=1.9, step_s=5e-4, sample_s=5e-4
    )
    expected = ff.simulate(loader, scenario, "robust").history["column_angle_rad"].to_numpy()
    off = record.channels["column_angle"][: len(expected)] - expected
    # A recording is a straight line from sample to sample, and the law holds each for a period.
    assert np.std(off) < 0.03 * np.std(expected)


@NEEDS_ROOT
@pytest.mark.slow
def test_valve_that_is_not_identified_is_recorded(monkeypatch):
    """The whole signal, designed for the file, throws a column of 10 % more inertia beyond the largest force."""
    play = bench_record.play
    monkeypatch.setattr(bench_record, "play", lambda signal: play(signal, real_time=False))
    hidden = {"column.inertia": 1.1, "linkage.stiffness": 0.9}
    machine = VALVE.replace({key: share * VALVE[key] for key, share in hidden.items()}, si=True)
    with virtual_interfaces() as ends, ff.live.BusEmulator([valve(ends[1], machine)], real_time=False):
        loader = valve(ends[0])
        record = ff.bus.record(loader, 10.0)
    assert record.run == {"law": "robust"}
    found = ff.identify(loader, [record], "J,k", starts=1)
    for key, share in hidden.items():
        assert found.loader[key] == pytest.approx(share * VALVE[key], rel=OF_TWO), key


def pasted(file, printed):
    """A loader file with the rows that an emulator printed, each in place of its own, and the table."""
    rows, bus = printed.split("[bus]")
    for part, stated in tomllib.loads(rows).items():
        above, table = file.split(f"[{part}]\n")
        for key, value in stated.items():
            table, replaced = re.subn(rf"^{key} = .*", f'{key} = "{value}"', table, count=1, flags=re.MULTILINE)
            assert replaced
        file = f"{above}[{part}]\n{table}"
    return f"{file}\n[bus]{bus}"


@NEEDS_ROOT
def test_commands_emulate_check_and_run_a_valve(run, bus_command, tmp_path):
    with virtual_interfaces() as ends:
        command = "from forcefeel.cli import main; main()"
        slower = ["--set", "controller.period=1 ms", "--set", "controller.delay=1 ms"]
        words = ["emulate", "elevator-2khz", "--bus", "ethercat-analog", "--port", ends[1], *slower]
        with subprocess.Popen(
            [sys.executable, "-P", "-c", command, *words], stdout=subprocess.PIPE, text=True
        ) as emulator:
            before_others(emulator)
            try:
                lines = [emulator.stdout.readline()]
                while not lines[-1].startswith("column_range"):
                    lines.append(emulator.stdout.readline())
                times = {"controller.period": "1 ms", "controller.delay": "1 ms", "safety.overrun_time": "1 s"}
                text = pasted(VALVE.replace(times).to_toml(), "".join(lines[1:]).replace(ends[1], ends[0]))
                path = tmp_path / "valve.toml"
                path.write_text(text, encoding="utf-8")
                status, out, err = bus_command(str(path), "--move", "--yes")
                assert (status, err) == (0, ""), out
                run_that_kept_time(run, str(path), "--machine", "bus", "--law", "robust")
            finally:
                emulator.terminate()


@NEEDS_ROOT
def test_input_terminal_of_another_axis_is_refused_with_its_reason(tmp_path):
    with virtual_interfaces() as ends:
        wired = [replace(valve(ends[1], node=node, input_node=node + 1), name=f"valve-{node}") for node in (1, 3)]
        with ff.live.BusEmulator(wired, real_time=False):
            for axis, loader in zip(("pitch", "roll"), wired, strict=True):
                shared = replace(loader, bus=replace(loader.bus, port=ends[0], input_node=2))
                (tmp_path / f"{axis}.toml").write_text(shared.to_toml(), encoding="utf-8")
            (tmp_path / "cockpit.toml").write_text('[axes]\npitch = "pitch.toml"\nroll = "roll.toml"\n')
            project = ff.loader.read_project(tmp_path / "cockpit.toml")
            buses = {axis: loader.bus for axis, loader in project.loaders.items()}
            says = r"axes\.roll: .*input_node: terminal 2 has the inputs of another axis, even if"
            with pytest.raises(ff.InputError, match=says):
                ff.live.start_cockpit(project, "robust", endpoints=buses, real_time=False)
            with pytest.raises(ff.InputError, match=r"got 2, which pitch has; change \[bus\] input_node"):
                ff.bus.check_cockpit(project)
