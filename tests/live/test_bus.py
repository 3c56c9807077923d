"""Drives on a bus, emulated: runs, faults of the wire and of the drive, bad input."""

import time
from contextlib import ExitStack, contextmanager
from dataclasses import replace

import numpy as np
import pytest

import forcefeel as ff
from tests.command_line import runs
from tests.live.bus_wire import NEEDS_ROOT, virtual_interfaces
from tests.parametrization import mostly_slow

run, emulate = runs("run"), runs("emulate")

QUIET = dict.fromkeys(
    [f"{sensor}.{of}" for sensor in ("load_cell", "potentiometer", "column_sensor") for of in ("noise", "resolution")]
)
SENSED = {"load_cell_n": 400.0, "column_gear": 1.0}
ETHERCAT = {
    "rated_torque_n_m": 2.0,
    "encoder_counts": 2.0**24,
    "column_counts": 2.0**24,
    "load_cell_object": "0x2100:1",
    "column_object": "0x60E4:1",
}
UNSENSED = dict.fromkeys(("load_cell_n", "column_gear"))


KINDS = ("moteus", "odrive", "odrive-0.5", pytest.param("ethercat", marks=NEEDS_ROOT))


def yoke(kind="moteus", *, quiet=False, port="pty", **bus):
    stated = SENSED | (ETHERCAT if kind == "ethercat" else {}) | bus
    loader = ff.loader.electric("desktop-yoke").replace(QUIET if quiet else {})
    return replace(loader, bus=ff.loader.Bus(kind, port, **stated))


RATED = 'kind = "ethercat"\nport = "a"\nrated_torque = "2 N m"'


def unhurried_yoke(kind="moteus"):
    """A yoke that a busy machine runs in real time."""
    slower = {"controller.period": "1 ms", "controller.delay": "1 ms"}
    return yoke(kind).replace(slower | {"safety.overrun_time": "1 s", "safety.silence_time": "200 ms"})


def activate(session):
    """Switch the law on; again where the machine was too busy to have it."""
    for _ in range(50):
        session.off()
        session.acknowledge()
        session.wait(100)
        session.on()
        until(lambda: session.state.name in ("active", "tripped"))
        if session.state.name == "active":
            return
    raise AssertionError(session.trips)


@contextmanager
def emulated(loader, *, real_time=False, power_s=0.0):
    """A loader on the bus of its emulated machine, and the machine."""
    with ExitStack() as wires:
        master = None
        if loader.bus.kind.startswith("ethercat"):
            master, port = wires.enter_context(virtual_interfaces())
            loader = replace(loader, bus=replace(loader.bus, port=port))
        emulator = wires.enter_context(ff.live.BusEmulator([loader], real_time=real_time, power_s=power_s))
        yield replace(loader, bus=replace(loader.bus, port=master or emulator.port)), emulator


@contextmanager
def running(loader, law="robust", *, real_time=False, power_s=0.0, **options):
    """A loop of a loader, and the machine at the other end of its bus."""
    with (
        emulated(loader, real_time=real_time, power_s=power_s) as (wired, emulator),
        ff.live.start(loader, law, endpoint=wired.bus, real_time=real_time, **options) as session,
    ):
        yield session, emulator


def until(holds, timeout_s=20.0):
    end = time.monotonic() + timeout_s
    while not holds():
        assert time.monotonic() < end
        time.sleep(0.002)


def column(session, name):
    return session.history()[:, session.columns.index(name)]


@pytest.mark.parametrize("kind", mostly_slow(KINDS))
@pytest.mark.parametrize(
    "wiring", mostly_slow([{}, {"gear": -2.5, "zero_rad": 1.0, "column_gear": -0.5, "column_zero_rad": 2.0}])
)
def test_run_over_bus_equals_run_in_process(kind, wiring):
    loader = yoke(kind, quiet=True, **wiring)
    with running(loader) as (session, emulator):
        session.on()
        session.wait(3000)
        emulator.push(8.0)
        session.wait(16_000)
        over_bus = [column(session, name)[-1000:] for name in ("column_angle_rad", "command", "feel_angle_rad")]
        overshoots = [column(session, "column_angle_rad").max()]
        assert session.state.name == "active"
    with ff.live.start(loader, "robust", real_time=False) as session:
        session.on()
        session.wait(3000)
        session.hand_force_n = 8.0
        session.wait(16_000)
        overshoots.append(column(session, "column_angle_rad").max())
        in_process = [column(session, name)[-1000:] for name in ("column_angle_rad", "command", "feel_angle_rad")]
    # A push comes anywhere within a period, and rises over 0.05 s.
    assert overshoots[0] == pytest.approx(overshoots[1], rel=1e-3)
    for there, here in zip(over_bus, in_process, strict=True):
        # At rest under the force; a drive states 32 bits of a turn, 6e-8, and 16 of a force, which the law's rates make noise of;
        # on EtherCAT 24 bits of a turn.
        assert there.mean() == pytest.approx(here.mean(), rel=1e-3)
        assert np.abs(there - here).max() < (0.3 if kind == "ethercat" else 0.1) * np.abs(here).max()


@pytest.mark.parametrize("kind", mostly_slow(KINDS))
def test_torque_mode_runs_with_drive_encoder_alone(kind):
    loader = yoke(kind, **UNSENSED)
    with running(loader, "torque-mode") as (session, emulator):
        session.on()
        session.wait(3000)
        emulator.push(8.0)
        session.wait(6000)
        assert session.state.name == "active"
        torque = 8.0 * loader["column.grip_arm"]
        # The feel's spring holds the hand, less what the link's stretch leaves.
        assert emulator.angles_rad[0] == pytest.approx(torque / loader["feel.stiffness"], rel=0.02)
    with pytest.raises(ff.InputError, match="load_cell"), running(loader):
        pass


HELD_RAD = 0.05


def feel_comes(kind, power_s, record):
    """States, and forces of a hand that holds the column, from the first sample with power on."""
    loader = yoke(kind, quiet=True)
    with running(loader, power_s=power_s, record=record) as (session, emulator):
        emulator.hold(HELD_RAD)
        session.wait(4000)
        session.on()
        until(lambda: session.state.name == "active")
        session.wait(2000)
        powered = np.argmax(column(session, "enable"))
        return [column(session, name)[powered:] for name in ("state", "load_cell_force_n", "command")]


@pytest.mark.parametrize("kind", mostly_slow(KINDS))
def test_feel_comes_from_a_slow_drive_as_from_one_that_acts_at_once(kind, tmp_path):
    loader = yoke(kind)
    period, fade = loader["controller.period"], loader["safety.fade_time"]
    fading = ff.live.STATES.index("fading")
    curves, waits = [], []
    for power_s in (0.0, 0.8):
        record = tmp_path / f"{power_s}.mcap"
        states, forces, commands = feel_comes(kind, power_s, record)
        assert ff.live.replay(record).same
        begins = int(np.argmax(states == fading))
        assert (commands[:begins] == 0.0).all()
        waits.append(begins * period)
        curves.append(forces[begins - 1 : begins + 1500])
    # An ODrive tells that it acts by its heartbeat, each 0.1 s.
    assert waits[1] - waits[0] == pytest.approx(0.8, abs=0.11 if kind.startswith("odrive") else 0.002)
    lever = loader["linkage.ratio"] * loader["column.base_arm"]
    whole = loader["feel.stiffness"] * HELD_RAD / lever
    assert np.abs(curves[1]).max() == pytest.approx(whole, rel=0.02)  # the hand gives a little
    ramp = whole * period / fade
    # The hand is a spring with a damper, and the link swings; all of it at once would be a hundred times the ramp and more.
    assert np.abs(np.diff(curves[1], prepend=0.0)).max() < 10 * ramp
    assert np.abs(curves[1] - curves[0]).max() < 0.01 * whole


def test_a_drive_that_never_acts_is_named_and_nothing_moves(emulate):
    loader = yoke().replace({"safety.power_time": "300 ms"})
    with running(loader, power_s=10.0) as (session, emulator):
        emulator.hold(HELD_RAD)
        session.wait(2000)
        session.on()
        until(lambda: session.state.name == "tripped")
        assert session.state.trips == ("drive not ready",)
        assert (column(session, "command") == 0.0).all()
        session.wait(100)
        assert emulator.commands == [0.0]
        with ff.live.BusEmulator([loader], power_s=10.0) as slow:
            found = ff.bus.check_bus(replace(loader, bus=replace(loader.bus, port=slow.port)), move=True)
        assert (found.watchdog.ok, found.directions) == (False, ())
        assert "did not act within 300ms" in found.watchdog.stated
    with pytest.raises(ff.InputError, match="power_s: expected a time of 0 s or more"):
        ff.live.BusEmulator([loader], power_s=-1.0)
    status, _, err = emulate("desktop-yoke", "--bus", "moteus", "--power-time", "-1")
    assert (status, "--power-time: expected a time of 0 s or more, got -1" in err) == (2, True)


BAD_ANSWERS = [("lost", 7), ("corrupt", 7), ("repeated", 3), ("late", 5)]


@pytest.mark.parametrize(
    ("kind", "fault", "every"),
    [
        *(("moteus", *fault) for fault in BAD_ANSWERS),
        *(pytest.param("ethercat", *fault, marks=NEEDS_ROOT) for fault in (*BAD_ANSWERS, ("miscounted", 7))),
    ],
)
def test_a_bad_answer_now_and_then_leaves_the_loader_active(kind, fault, every):
    with running(yoke(kind)) as (session, emulator):
        session.on()
        session.wait(3000)
        emulator.break_wire(fault, every)
        session.wait(70)
        emulator.break_wire(None)
        session.wait(100)
        assert session.state.name == "active", session.trips
        lost = 1 - column(session, "sampled")
        # The next answer overtakes a late one. A machine that is busy may lose some more.
        # On a network a check sum of the interface, which is not emulated, finds what is corrupt.
        assert (lost.sum() > 2) == (fault != "repeated" and (kind, fault) != ("ethercat", "corrupt"))


def test_answers_that_are_all_late_show_their_delay():
    with running(unhurried_yoke(), real_time=True) as (session, emulator):
        emulator.break_wire("late")
        session.wait(1000)
        assert np.nanmedian(column(session, "delay")[-500:]) == 1


@pytest.mark.parametrize(
    ("kind", "fault", "name"),
    [
        ("moteus", "lost", "node silent"),
        ("moteus", "gone", "node silent"),
        ("moteus", "bus_off", "bus error"),
        pytest.param("ethercat", "lost", "node silent", marks=NEEDS_ROOT),
        pytest.param("ethercat", "gone", "node silent", marks=NEEDS_ROOT),
        pytest.param("ethercat", "miscounted", "wrong working counter", marks=NEEDS_ROOT),
    ],
)
def test_silence_damps_the_column_and_nothing_re_engages_by_itself(kind, fault, name):
    loader = unhurried_yoke(kind)
    # A law that does not hear late samples: the drive holds its last command until its watchdog ends it.
    with running(loader, "torque-mode", real_time=True) as (session, emulator):
        for _ in range(20):
            activate(session)
            emulator.push(8.0)
            session.wait(100)
            emulator.break_wire(fault)
            until(lambda: "sensors silent" in session.state.trips)
            if session.state.trips == ("sensors silent",):
                break
            # A busy machine had tripped it before.
            emulator.break_wire(None)
            emulator.push(0.0)
            session.wait(400)
        emulator.push(0.0)  # a yoke without stops would be beyond its travel on a busy machine
        assert session.state.name == "tripped"
        until(lambda: session.state.drive_fault.startswith(name))
        if fault != "lost":  # the node hears nothing either: its own watchdog damps
            time.sleep(2 * loader.bus.watchdog_s)
            emulator.push(-0.5)
            until(lambda: emulator.commands[0] > 0.01)  # against the motion, to negative angles
        emulator.push(0.0)
        emulator.break_wire(None)
        session.wait(400)
        assert session.state.name == "tripped"
        until(lambda: emulator.commands[0] == 0.0)
        # Acknowledged it is off, though on was requested before.
        until(lambda: session.acknowledge() or session.wait(50) or session.state.name == "off")
        session.wait(100)
        assert session.state.name in ("off", "tripped")
        assert emulator.commands[0] == 0.0
        until(lambda: session.state.drive_fault == "")  # a busy machine misses an answer now and then


@pytest.mark.parametrize(
    ("kind", "code", "name"),
    [
        ("moteus", 40, "moteus: under voltage"),
        ("moteus", 33, "moteus: motor driver fault"),
        ("moteus", None, "drive stopped by itself"),
        ("odrive", 9, "ODrive: DC bus under voltage"),
        ("odrive", None, "drive stopped by itself"),
        ("odrive", 24, "drive watchdog"),
        ("odrive-0.5", 6, "ODrive: motor failed"),
        ("odrive-0.5", 11, "drive watchdog"),
        pytest.param("ethercat", 0x3220, "CiA 402: DC link under voltage", marks=NEEDS_ROOT),
        pytest.param("ethercat", 0xFF01, "CiA 402: fault of the maker's own", marks=NEEDS_ROOT),
        pytest.param("ethercat", None, "wrong working counter", marks=NEEDS_ROOT),
    ],
)
def test_drive_fault_trips_by_name_and_in_the_record(kind, code, name, tmp_path):
    loader = yoke(kind)
    record = tmp_path / "run.mcap"
    with running(loader, record=record) as (session, emulator):
        session.on()
        session.wait(3000)
        emulator.restart() if code is None else emulator.fail(code)
        until(lambda: session.state.name == "tripped")
        until(lambda: session.state.drive_fault.startswith(name))
        if (kind, code) != ("ethercat", None):  # a slave in INIT takes no command, and time stands still without one
            assert "drive fault" in session.state.trips
            until(lambda: emulator.commands[0] == 0.0)
    assert ff.live.replay(record).same
    assert ff.live.read_live_record(record).about["machine"].startswith(f"{kind} 1 at ")


@contextmanager
def cockpit_on_bus(folder, wired, port=None):
    """A running cockpit whose axes are all on one emulated bus, the last one pushed; the loop's end of the bus is at ``port``."""
    (folder / "cockpit.toml").write_text("[axes]\n" + "".join(f'{axis} = "{axis}.toml"\n' for axis in wired))
    with ff.live.BusEmulator(list(wired.values()), real_time=False) as emulator:
        for axis, loader in wired.items():
            named = replace(loader, name=f"my-{axis}", bus=replace(loader.bus, port=port or emulator.port))
            (folder / f"{axis}.toml").write_text(named.to_toml(), encoding="utf-8")
        project = ff.loader.read_project(folder / "cockpit.toml")
        ends = {axis: loader.bus for axis, loader in project.loaders.items()}
        with ff.live.start_cockpit(project, "robust", endpoints=ends, real_time=False) as cockpit:
            cockpit.on()
            cockpit.wait(3000)
            emulator.push(6.0, len(wired) - 1)
            cockpit.wait(8000)
            assert {session.state.name for session in cockpit.values()} == {"active"}
            yield cockpit, emulator


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["moteus", "odrive"])
def test_axes_of_one_bus_run_in_one_loop(tmp_path, kind):
    wired = {axis: yoke(kind, node=node) for node, axis in enumerate(("roll", "pitch"), 2)}
    with cockpit_on_bus(tmp_path, wired) as (cockpit, emulator):
        roll, pitch = (column(session, "column_angle_rad")[-1] for session in cockpit.values())
        assert [roll, pitch] == pytest.approx(emulator.angles_rad, abs=1e-4)  # a cycle apart
        assert abs(roll) < 1e-3 < pitch
        # What stops a loader by hand stops the other too.
        cockpit["pitch"].stop()
        cockpit.wait(500)
        assert {session.state.name for session in cockpit.values()} == {"tripped"}


@pytest.mark.parametrize(("there", "asked"), [("odrive", "odrive-0.5"), ("odrive-0.5", "odrive")])
def test_other_firmware_is_refused_by_name(there, asked):
    with ff.live.BusEmulator([yoke(there)]) as emulator:
        bus = replace(yoke(asked).bus, port=emulator.port)
        with pytest.raises(
            ff.InputError, match=rf'expected firmware 0\.{6 if asked == "odrive" else 5}.*say kind = "{there}"'
        ):
            ff.live.start(yoke(asked), endpoint=bus)


def test_bad_node_is_refused_by_name():
    loader = yoke(node=3)
    with ff.live.BusEmulator([loader]) as emulator:
        for change, part in (
            ({"node": 4}, "expected node 4, got no answer from it and node 3"),
            ({"port": "/dev/null"}, "serial"),
        ):
            bus = replace(loader.bus, **({"port": emulator.port} | change))
            with pytest.raises(ff.InputError, match=part):
                ff.live.start(loader, endpoint=bus)
        bus = replace(loader.bus, port=emulator.port)
        with ff.live.start(loader, endpoint=bus), pytest.raises(ff.InputError, match="another program has it open"):
            ff.live.start(loader, endpoint=bus)
    with pytest.raises(ff.InputError, match=r"controller\.delay"):
        ff.live.start(loader.replace({"controller.delay": "0 ms"}), endpoint=bus)
    with pytest.raises(ff.InputError, match="add the table"):
        ff.live.BusEmulator([ff.loader.electric("desktop-yoke")])


@pytest.mark.parametrize(
    ("kind", "states"),
    [
        ("moteus", "with the serial numbers 000003ec.* and 000007d4"),
        ("odrive", "with the serial numbers 000003ec.* and 000007d4"),
        ("odrive-0.5", "which state no serial number"),
    ],
)
def test_two_drives_of_one_number_are_refused_by_name_and_nothing_moves(kind, states):
    loader = yoke(kind, node=4)
    with ff.live.BusEmulator([loader]) as emulator:
        emulator.add_twin()
        wired = replace(loader, bus=replace(loader.bus, port=emulator.port))
        for start in (lambda: ff.live.start(loader, endpoint=wired.bus), lambda: ff.bus.check_bus(wired, move=True)):
            with pytest.raises(ff.InputError, match=f"expected one node 4, got 2, {states}"):
                start()
        assert emulator.commands == [0.0]
        assert emulator.angles_rad[0] == pytest.approx(0.0, abs=1e-9)  # rad; at rest


@NEEDS_ROOT
def test_twin_on_ethercat_is_refused():
    with emulated(yoke("ethercat")) as (_, emulator), pytest.raises(ff.InputError, match="is for drives on CAN"):
        emulator.add_twin()


@pytest.mark.parametrize(
    ("lines", "part"),
    [
        ('kind = "odrive2"\nport = "a"', "kind: expected"),
        ('kind = "moteus"', "port: missing value"),
        ('kind = "moteus"\nport = "a"\nnode = 200', "node: expected 1 to 95"),
        ('kind = "moteus"\nport = "a"\nload_cell = "3 m"', "load_cell: expected"),
        ('kind = "moteus"\nport = "a"\nwatchdog = "2 s"', "watchdog: expected up to"),
        ('kind = "moteus"\nport = "a"\ngear = 0', "gear: expected"),
        ('kind = "moteus"\nport = "a"\nspeed = 1', "speed: unknown key"),
        ('kind = "moteus"\nport = "a"\nencoder_counts = 10', "encoder_counts: expected it with kind"),
        (f"{RATED}", "encoder_counts: missing value"),
        (f"{RATED}\nencoder_counts = -1", "encoder_counts: expected a positive number"),
        (f'{RATED}\nencoder_counts = 1000\nload_cell = "400 N"', "load_cell_object: missing value"),
        (f'{RATED}\nencoder_counts = 1000\nload_cell_object = "2100"', "load_cell_object: expected an object"),
        (f"{RATED}\nencoder_counts = 1000\nnode = 0", "node: expected 1 to 255"),
        (f"{RATED}\nencoder_counts = 1000\ninput_node = 2", "input_node: expected load_cell or grip_sensor"),
        (
            f'{RATED}\nencoder_counts = 1000\ninput_node = 1\nload_cell = "400 N"\nload_cell_object = "0x6000:17"',
            "input_node: expected another slave than the drive, 1",
        ),
    ],
)
def test_bad_bus_of_a_file_exits_with_status_2(run, tmp_path, lines, part):
    path = tmp_path / "yoke.toml"
    path.write_text(f"{ff.loader.electric('desktop-yoke').to_toml()}\n[bus]\n{lines}\n", encoding="utf-8")
    status, out, err = run(str(path), "--machine", "bus", "--headless")
    assert (status, out) == (2, "")
    assert f"bus: {part}" in err


@pytest.mark.parametrize(("kind", "more"), [("moteus", {}), ("ethercat", ETHERCAT | {"grip_object": "0x2100:2"})])
def test_bus_of_a_file_comes_back_and_a_valve_has_another(run, tmp_path, kind, more):
    loader = yoke(kind, gear=-2.0, zero_rad=0.1, watchdog_s=0.05, grip_sensor_n=50.0, **more)
    path = tmp_path / "yoke.toml"
    path.write_text(loader.to_toml(), encoding="utf-8")
    bus = ff.load(path).bus
    for name in ("gear", "zero_rad", "watchdog_s", "load_cell_n", "column_gear", "grip_sensor_n"):
        assert getattr(bus, name) == pytest.approx(getattr(loader.bus, name), rel=1e-11)  # written with 12 digits
    for name, value in more.items():
        assert getattr(bus, name) == (
            pytest.approx(value, rel=1e-11) if isinstance(value, float) else value
        )  # 12 digits
    assert ff.load(path).replace({"feel.stiffness": "5 N m/rad"}).bus == bus
    with pytest.raises(ff.InputError, match="expected a kind for hydraulic drives"):
        replace(ff.digital_elevator(), bus=ff.loader.Bus("moteus", "a"))
    status, _, err = run("desktop-yoke", "--machine", "bus", "--headless")
    assert status == 2
    assert "[bus]" in err


def test_missing_can_interface_is_refused_by_name():
    with pytest.raises(
        ff.InputError, match=r"can9: expected a CAN interface, or a path of a serial port such as \./can9: "
    ):
        ff.live.start(yoke(), endpoint=replace(yoke().bus, port="can9"))


def test_object_of_a_sensor_that_is_not_wired_is_left_out():
    wired, bare = (
        sum(frame.bytes for frame in ff.bus.bus_load(yoke("ethercat", **of)).frames) for of in ({}, UNSENSED)
    )
    # The load cell's 16 bits and the encoder's 32, within the least frame.
    assert wired - bare == 6
