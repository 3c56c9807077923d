"""EtherCAT on a pair of virtual interfaces: foreign master and slave, runs, faults, bad input."""

import json
import os
import re
import struct
import subprocess
import sys
import time
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import forcefeel as ff
from forcefeel import _core
from forcefeel.live.setup import live_law, made_of
from tests.command_line import runs
from tests.live.bus_wire import NEEDS_ROOT, before_others, run_that_kept_time, virtual_interfaces
from tests.live.test_bus import ETHERCAT, UNSENSED, cockpit_on_bus, column, running, until, yoke

run = runs("run")
bus_command = runs("bus")

pytestmark = NEEDS_ROOT

RATED_N_M, COUNTS = ETHERCAT["rated_torque_n_m"], ETHERCAT["encoder_counts"]
CLOSED_FORM = 0.01
"""Share by which a foreign witness may be off the closed form."""
MAPS = {
    0x1600: (0x1C12, [0x60400010, 0x60710010, 0x60600008]),
    0x1A00: (0x1C13, [0x60410010, 0x60640020, 0x606C0020, 0x60770010, 0x60610008, 0x60E40120]),
}


@pytest.fixture
def wire():
    with virtual_interfaces() as ends:
        yield ends


@contextmanager
def soem(port, slaves=1):
    """SOEM with slaves in SAFE-OP, of which the first gets the maps of the torque."""
    pysoem = pytest.importorskip("pysoem")
    master = pysoem.Master()
    master.open(port)
    try:
        # SOEM gives a frame 2 to 20 ms, which a busy machine may take: it is asked again.
        until(lambda: master.config_init() == slaves)
        slave = master.slaves[0]

        def map_torque(_):
            for index, (assigned, entries) in MAPS.items():
                slave.sdo_write(assigned, 0, b"\0")
                slave.sdo_write(index, 0, b"\0")
                for place, entry in enumerate(entries, 1):
                    slave.sdo_write(index, place, struct.pack("<I", entry))
                slave.sdo_write(index, 0, bytes([len(entries)]))
                slave.sdo_write(assigned, 1, struct.pack("<H", index))
                slave.sdo_write(assigned, 0, b"\1")

        slave.config_func = map_torque
        master.config_map()
        assert master.config_dc()
        assert master.state_check(pysoem.SAFEOP_STATE, 5_000_000) == pysoem.SAFEOP_STATE
        yield pysoem, master, slave
        master.state = pysoem.INIT_STATE
        master.write_state()
    finally:
        master.close()


def exchange(master, slave, control, torque):
    """Status word, motor and column in counts, mode, after all commands before this one."""
    slave.output = struct.pack("<HhB", control, torque, 10)
    master.send_processdata()
    assert master.receive_processdata(1_000_000) == master.expected_wkc
    status, motor, _, _, mode, turned = struct.unpack("<HiihBi", slave.input)
    return status, motor, turned, mode


def operational(pysoem, master, slave):
    """OP, and each status word on the way to a powered drive."""
    slave.state = pysoem.OP_STATE
    slave.write_state()
    for _ in range(100):
        exchange(master, slave, 0, 0)
        if slave.state_check(pysoem.OP_STATE, 1000) == pysoem.OP_STATE:
            break
    assert slave.state == pysoem.OP_STATE
    return [exchange(master, slave, control, 0) for control in (6, 7, 15, 15)]


def test_soem_moves_the_emulated_drive_by_the_closed_form(wire):
    loader = yoke("ethercat", port=wire[1], quiet=True)
    cycles, torque = 200, 100
    with ff.live.BusEmulator([loader], real_time=False), soem(wire[0]) as (pysoem, master, slave):
        assert slave.sdo_read(0x1008, 0).decode().startswith("forcefeel")
        states = operational(pysoem, master, slave)
        # An answer shows the state before its own command.
        assert [status for status, *_ in states] == [0x50, 0x31, 0x33, 0x37]
        assert states[-1][-1] == 10
        start = np.array(states[-1][1:3])
        for _ in range(cycles):
            exchange(master, slave, 15, torque)
        moved = (np.array(exchange(master, slave, 15, 0)[1:3]) - start) * 2 * np.pi / COUNTS
    # Whatever the link's spring and damper do, J_m th_m'' + r / R_b J th_c'' = T.
    inertia = np.array(
        [loader["motor.inertia"], loader["column.inertia"] * loader["transmission.travel"] / loader["column.base_arm"]]
    )
    # The current loop is a lag of the first order: the integral of T (1 - exp(-t / tau)), twice.
    time_s, tau = cycles * loader["controller.period"], 1 / loader["current_loop.bandwidth"]
    twice = 0.5 * time_s**2 - tau * time_s + tau**2 * -np.expm1(-time_s / tau)
    assert inertia @ moved == pytest.approx(
        torque / 1000 * RATED_N_M * twice, rel=1e-4
    )  # counts, of which it moves 1e5 and more
    assert (moved > 0).all()


def test_soem_finds_the_slave_in_safe_op_once_it_was_silent(wire):
    loader = yoke("ethercat", port=wire[1])
    with ff.live.BusEmulator([loader]) as emulator, soem(wire[0]) as (pysoem, master, slave):
        # SOEM leaves the watchdog at the slave's own, 100 ms.
        operational(pysoem, master, slave)
        for _ in range(20):
            exchange(master, slave, 15, 100)
            time.sleep(0.001)
        assert emulator.commands[0] == pytest.approx(0.1 * RATED_N_M / loader["motor.torque_constant"])
        time.sleep(0.3)
        emulator.push(-1.0)
        until(lambda: emulator.commands[0] > 0.01)  # braked: against the motion, to negative angles
        master.read_state()
        assert (slave.state, slave.al_status) == (pysoem.SAFEOP_STATE | pysoem.STATE_ERROR, 0x1B)


def test_soem_brings_three_slaves_of_a_line_to_op(wire):
    loaders = [yoke("ethercat", port=wire[1], node=node) for node in (1, 2, 200)]
    with ff.live.BusEmulator(loaders), soem(wire[0], 3) as (pysoem, master, _):
        serials = [int.from_bytes(slave.sdo_read(0x1018, 4), "little") for slave in master.slaves]
        assert serials == [1001, 1002, 1200]
        master.state = pysoem.OP_STATE
        master.write_state()
        for _ in range(100):
            master.send_processdata()
            counted = master.receive_processdata(1_000_000)
            if master.state_check(pysoem.OP_STATE, 1000) == pysoem.OP_STATE:
                break
        assert master.state_check(pysoem.OP_STATE, 1000) == pysoem.OP_STATE
        assert counted == master.expected_wkc == 9


FOREIGN = os.environ.get("FORCEFEEL_ETHERCAT_SLAVE", "")


@pytest.mark.skipif(
    not FOREIGN, reason="FORCEFEEL_ETHERCAT_SLAVE: no folder with a foreign slave, network_simulator of KickCAT"
)
def test_our_master_moves_a_foreign_slave_by_the_closed_form(wire):
    loader = yoke("ethercat", port=wire[0], rated_torque_n_m=1.0, encoder_counts=1e6, **UNSENSED)
    setup, _ = made_of(loader, live_law(None, loader), supervised=False)
    arguments = [str(Path(FOREIGN) / "network_simulator"), "-i", wire[1], "-s", "ecat402-drive.json"]
    foreign = subprocess.Popen(arguments, cwd=FOREIGN, stdout=subprocess.DEVNULL)
    try:
        time.sleep(1.0)
        drive = _core.BusDrive(setup, loader.bus.engine, by_clock=False)
        torque = 1000  # its own unit; the plant is linear
        rows, ended = drive.play([1e-3 * torque / loader["motor.torque_constant"]] * 250, np.inf)
    finally:
        foreign.terminate()
        foreign.wait()
    assert ended is None
    counts = np.array(rows)[:, 1] / loader["transmission.travel"] / (2 * np.pi) * 1e6
    moving = counts[np.flatnonzero(counts)[0] - 1 :]
    step_s, cycles = 1e-3, 200
    speed = (moving[cycles] - moving[cycles - 1]) / step_s / torque
    # J v' = T - b v with J = 5e-5, b = 1e-3: v = T / b (1 - exp(-b t / J)), 981.7 after 0.2 s of torque 1.
    assert 1e3 * (1 - np.exp(-1e-3 * cycles * step_s / 5e-5)) == pytest.approx(981.7, abs=0.05)
    assert speed == pytest.approx(981.7, rel=CLOSED_FORM)


@pytest.mark.slow
def test_three_axes_of_one_interface_run_in_one_loop(wire, tmp_path):
    axes = {"roll": 1, "pitch": 2, "yaw": 200}
    wired = {axis: yoke("ethercat", port=wire[1], node=node) for axis, node in axes.items()}
    with cockpit_on_bus(tmp_path, wired, wire[0]) as (cockpit, emulator):
        angles = [column(session, "column_angle_rad")[-1] for session in cockpit.values()]
        # A cycle apart; the sensors' noise moves each by 5e-5 rad rms.
        assert angles == pytest.approx(emulator.angles_rad, abs=5e-4)
        assert max(map(abs, angles[:2])) < 1e-3 < angles[2]


def test_force_sensors_at_a_terminal_serve_a_drive():
    wired = {"input_node": 2, "load_cell_object": "0x6000:17", "grip_sensor_n": 100.0, "grip_object": "0x6030:17"}
    loader = yoke("ethercat", quiet=True, **wired)
    with pytest.raises(
        ff.InputError, match=r"coarser than the loader's sensors.*set load_cell\.resolution = 0\.01221 N"
    ):
        ff.live.start(loader, endpoint=loader.bus)
    sensed = {"gain": 1.0, "noise": "0.01 N", "resolution": "0.0031 N"}
    stated = {f"grip_sensor.{key}": value for key, value in sensed.items()}
    loader = loader.replace({"load_cell.resolution": "0.0123 N"} | stated)
    with running(loader) as (session, emulator):
        session.on()
        session.wait(3000)
        emulator.push(8.0)
        session.wait(9000)
        assert session.state.name == "active"
        angle, grip = (column(session, name)[-500:].mean() for name in ("column_angle_rad", "grip_force_n"))
    # At rest under the force the feel's spring alone holds.
    assert angle == pytest.approx(8.0 * loader["column.grip_arm"] / loader["feel.stiffness"], rel=5e-3)
    assert grip == pytest.approx(8.0, abs=0.05)  # of 0.01 N of noise, and the last of the swing


def refusal(loader, bus):
    """Why a bus is refused; asked again where a busy machine had no answer in time."""
    for _ in range(10):
        with pytest.raises(ff.InputError) as refused:
            ff.live.start(loader, endpoint=bus)
        if "got no answer" not in str(refused.value):
            break
    return str(refused.value)


def test_bad_slave_is_refused_by_name_and_nothing_moves(wire):
    loader = yoke("ethercat", port=wire[1])
    with ff.live.BusEmulator([loader]) as emulator:
        for change, part in (
            ({"node": 2}, "expected a slave at position 2, got 1 on the wire"),
            ({"node": 200}, r"expected a slave with alias 200, got aliases \[0\]"),
            ({"port": "no-such0"}, "expected a network interface"),
            ({"port": "lo"}, "expected slaves, got no answer|raw sockets"),
            ({"rated_torque_n_m": 3.0}, "rated_torque: expected the drive's own, 0x6076, 2 N m, got 3 N m"),
            ({"load_cell_object": "0x2200:7"}, "0x2200:7: expected a sensor's object"),
        ):
            bus = replace(loader.bus, **({"port": wire[0]} | change))
            assert re.search(part, refusal(loader, bus))
            assert emulator.commands == [0.0]
        bus = replace(loader.bus, port=wire[0])
        with ff.live.start(loader, endpoint=bus), pytest.raises(ff.InputError, match="another program has it open"):
            ff.live.start(loader, endpoint=bus)
    with pytest.raises(ff.InputError, match="expected slaves, got no answer"):
        ff.live.start(loader, endpoint=bus)


def test_without_permission_for_raw_sockets_it_says_so(wire):
    code = (
        "import os, sys, forcefeel as ff; from dataclasses import replace; yoke = ff.loader.electric('desktop-yoke'); "
        "bus = ff.loader.Bus('ethercat', sys.argv[1], rated_torque_n_m=2.0, encoder_counts=1e6); "
        "ff.live.start; law = 'torque-mode'; ff.live.BusEmulator; os.setgid(65534); os.setuid(65534)\n"
        "try: ff.live.start(replace(yoke, bus=bus), law, endpoint=bus)\n"
        "except ff.InputError as error: print(error)"
    )
    done = subprocess.run(
        [sys.executable, "-P", "-c", code, wire[0]], capture_output=True, text=True, timeout=120, check=False
    )
    assert "raw sockets are not permitted; run as root, or give the program CAP_NET_RAW" in done.stdout, done.stderr


def test_commands_emulate_check_and_run(wire, run, bus_command, tmp_path):
    path = tmp_path / "yoke.toml"
    loader = yoke("ethercat", port=wire[0]).replace(
        {"controller.period": "1 ms", "controller.delay": "1 ms", "safety.overrun_time": "1 s"}
    )
    path.write_text(loader.to_toml(), encoding="utf-8")
    command = "from forcefeel.cli import main; main()"
    words = [sys.executable, "-P", "-c", command, "emulate", str(path), "--port", wire[1], "--json"]
    words += ["--power-time", "200 ms"]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as emulator:
        before_others(emulator)
        try:
            assert json.loads(emulator.stdout.readline())["port"] == wire[1]
            status, out, _ = bus_command(str(path), "--move", "--yes")
            assert "stopped by itself within 0.2 s" in out
            assert status == 0
            words = ["--machine", "bus", "--law", "robust", "--out", str(tmp_path / "run"), "--replace"]
            run_that_kept_time(run, str(path), *words)
        finally:
            emulator.terminate()
    record = ff.live.read_live_record(tmp_path / "run" / "record.mcap")
    enabled, acts = (np.argmax(record.column(name) > 0) for name in ("enable", "drive_acts"))
    missed = record.column("missed")[enabled : acts + 1].sum()
    assert acts - enabled + missed >= 200  # ms
    status, out, err = run(str(path), "--machine", "bus", "--headless")
    assert (status, out) == (2, "")
    assert "expected slaves, got no answer" in err
