"""``forcefeel bus``: nodes, delay, watchdog, directions, host."""

import io
import json
from dataclasses import replace
from pathlib import Path

import pytest

import forcefeel as ff
from forcefeel.bus import check, cockpit, host
from tests.command_line import runs
from tests.live.test_bus import KINDS, UNSENSED, emulated, until, yoke
from tests.live.test_ethercat_analog import valve
from tests.parametrization import mostly_slow

run = runs("bus")

WRONG = {
    "column encoder": {"column_gear": -1.0},
    "load cell": {"load_cell_n": -400.0},
}


@pytest.mark.parametrize("kind", mostly_slow(KINDS))
@pytest.mark.parametrize("wrong", ["", *WRONG])
def test_check_finds_node_watchdog_and_directions(kind, wrong):
    node = 1 if kind == "ethercat" else 4
    loader = yoke(kind, node=node)
    with emulated(loader, real_time=True) as (wired, emulator):
        bus = replace(wired.bus, **WRONG.get(wrong, {}))
        found = ff.bus.check_bus(replace(wired, bus=bus), move=True)
        until(lambda: emulator.commands[0] == 0.0)
    assert [node.node for node in found.nodes] == [node]
    assert found.watchdog.ok, found.watchdog
    assert [finding.name for finding in found.directions] == ["motor", "column encoder", "load cell"]
    assert [finding.name for finding in found.directions if not finding.ok] == ([wrong] if wrong else [])
    # On a busy machine the drive may answer too late; what is said then is tested with planned times.
    assert found.ok == (found.delay.ok and not wrong)
    assert found.delay.answers > 0.9 * found.delay.commands
    assert 0 < found.delay.median_s <= found.delay.p99_s <= found.delay.worst_s
    periods = found.delay.delay_s / loader["controller.period"]
    assert periods == round(periods) >= 1


class Person(io.StringIO):
    """Somebody at the terminal."""

    def isatty(self):
        return True


@pytest.mark.parametrize(
    ("answers", "moves", "stated"),
    [
        ("y\ny\n", True, ""),
        ("n\n", False, "motor: not moved: the travel is not confirmed as free"),
        ("", False, "motor: not moved"),
        ("y\nn\n", True, "in the negative direction: negate gear, column_gear, load_cell in [bus]"),
    ],
)
def test_person_confirms_before_and_after_the_column_moves(
    run, tmp_path, monkeypatch, answers_within, answers, moves, stated
):
    answers_within(0.2e-3)
    loader = yoke()
    with ff.live.BusEmulator([loader]) as emulator:
        wired = replace(loader, bus=replace(loader.bus, port=emulator.port))
        (tmp_path / "yoke.toml").write_text(wired.to_toml(), encoding="utf-8")
        status, out, err = run("yoke.toml", "--move")
        assert (status, out) == (2, "")
        assert "expected a person at the terminal" in err
        monkeypatch.setattr("sys.stdin", Person(answers))
        status, out, err = run("yoke.toml", "--move")
        assert (max(map(abs, emulator.angles_rad)) > 0.01) == moves
    assert "up to 2.5 A will move the column by about 1 deg. Is the travel free?" in err
    assert ("Was that its positive direction?" in err) == moves
    assert status == (1 if stated else 0)
    assert stated in " ".join(out.split())


@pytest.fixture
def answers_within(monkeypatch):
    """A drive that answers each command within a time, and stops by itself: a busy machine takes as long as it likes."""
    as_measured = check._delay

    def plan(time_s):
        monkeypatch.setattr(check, "_delay", lambda _, loader: as_measured([time_s] * check.COMMANDS, loader))
        well = ff.bus.Finding("drive watchdog", True, "stopped by itself", "")
        monkeypatch.setattr(check, "_watchdog", lambda *_: well)

    return plan


def test_command_writes_measured_delay(run, tmp_path, answers_within):
    answers_within(0.7e-3)
    loader = yoke()
    with ff.live.BusEmulator([loader]) as emulator:
        wired = replace(loader, bus=replace(loader.bus, port=emulator.port))
        (tmp_path / "yoke.toml").write_text(wired.to_toml(), encoding="utf-8")
        status, out, err = run("yoke.toml", "--out", "measured.toml", "--json")
        assert (status, err) == (0, "")
        found = json.loads(out)
        assert found["watchdog"]["ok"]
        assert found["directions"] == []
        assert found["delay"]["delay_s"] == pytest.approx(1e-3)  # two periods of 0.5 ms
        measured = ff.load(tmp_path / "measured.toml")
        assert measured["controller.delay"] == pytest.approx(found["delay"]["delay_s"], rel=1e-9)  # written with digits
        assert (measured.bus.port, measured.bus.node) == (wired.bus.port, wired.bus.node)
        status, out, _ = run("yoke.toml", "--move", "--yes")
        assert status == 0
        for part in ("Nodes", "controller.delay", "drive watchdog", "column encoder", "real-time kernel"):
            assert part in out
        status, _, err = run("yoke.toml", "--out", "measured.toml")
        assert status == 2
        assert "--replace" in err


def test_drive_that_answers_too_late_is_found_and_no_file_is_written(run, tmp_path, answers_within):
    answers_within(3.6e-3)
    loader = yoke()
    with ff.live.BusEmulator([loader]) as emulator:
        (tmp_path / "yoke.toml").write_text(
            replace(loader, bus=replace(loader.bus, port=emulator.port)).to_toml(), encoding="utf-8"
        )
        status, out, err = run("yoke.toml", "--out", "measured.toml")
    assert (status, err) == (1, "")
    assert "controller.delay: 4 ms, expected at most 3.5 ms: set a longer controller.period" in " ".join(out.split())
    assert not (tmp_path / "measured.toml").exists()


def test_loader_without_bus_and_missing_port_exit_with_status_2(run, tmp_path):
    status, _, err = run("desktop-yoke")
    assert status == 2
    assert "[bus]" in err
    (tmp_path / "yoke.toml").write_text(yoke().to_toml().replace('"pty"', '"./nowhere"'), encoding="utf-8")
    status, _, err = run("yoke.toml")
    assert status == 2
    assert "./nowhere" in err


@pytest.mark.parametrize(
    ("fault", "part"), [(0, "still powered"), (140, "under voltage"), (None, "no answer"), (4, "stopped by itself")]
)
def test_watchdog_that_does_not_act_is_found(fault, part, monkeypatch):
    monkeypatch.setattr(check.time, "sleep", lambda _: None)

    class Drive:
        asked = 0

        def power_up(self):
            self.asked += 2

        def exchange(self, command, enable):
            self.asked += enable
            assert command == 0.0
            return None if fault is None else ([0.0] * 4, fault if enable and self.asked > 3 else 0)

    finding = check._watchdog(Drive(), yoke().bus)
    assert finding.ok == (fault == 4)
    assert part in finding.stated
    assert bool(finding.remedy) == (not finding.ok)


def test_host_findings_have_a_remedy_unless_they_are_well(monkeypatch):
    for finding in ff.bus.check_host():
        assert finding.stated
        assert bool(finding.remedy) == (not finding.ok), finding
    monkeypatch.setattr(host.os, "geteuid", lambda: 1000)
    monkeypatch.setattr(host.resource, "getrlimit", lambda _: (0, 0))
    monkeypatch.setattr(host, "_read", lambda _: "")
    bad = {finding.name: finding.remedy for finding in ff.bus.check_host() if not finding.ok}
    assert {"isolated processor", "memory lock", "real-time priority"} <= set(bad)
    assert "memlock" in bad["memory lock"]


def project_of(folder, **buses):
    for axis, loader in buses.items():
        (folder / f"{axis}.toml").write_text(replace(loader, name=f"rig-{axis}").to_toml(), encoding="utf-8")
    path = folder / "cockpit.toml"
    path.write_text("[axes]\n" + "".join(f'{axis} = "{axis}.toml"\n' for axis in buses), encoding="utf-8")
    return path


@pytest.mark.slow
@pytest.mark.parametrize("kind", mostly_slow(["moteus", "odrive"]))
def test_project_checks_its_axes_in_turn_and_writes_the_delay_of_all(run, tmp_path, kind, answers_within):
    answers_within(0.7e-3)
    slower = {"controller.period": "1 ms", "controller.delay": "1 ms"}
    loaders = {"pitch": yoke(kind, node=2).replace(slower), "roll": yoke(kind, node=7).replace(slower)}
    with ff.live.BusEmulator([*loaders.values(), yoke(kind, node=9)]) as emulator:
        wired = {axis: replace(it, bus=replace(it.bus, port=emulator.port)) for axis, it in loaders.items()}
        path = project_of(tmp_path, **wired)
        status, out, err = run(path.name, "--out", "measured.toml", "--json")
        assert (status, err) == (0, "")
        axes = json.loads(out)["axes"]
        assert list(axes) == ["pitch", "roll"]
        for axis, node in (("pitch", 2), ("roll", 7)):
            delay = axes[axis]["delay"]["delay_s"]
            assert delay == pytest.approx(2e-3)  # 1.4 ms for both
            assert axes[axis]["load"]["period_s"] == pytest.approx(1e-3)
            measured = ff.load(tmp_path / f"measured-{axis}.toml")
            assert measured["controller.delay"] == pytest.approx(delay, rel=1e-9)  # written with digits
            assert measured.bus.node == node
        status, out, _ = run(path.name, "--move", "--yes")
        assert status == 0
        for part in ("pitch: drive watchdog", "roll: column encoder", "node 9 belongs to no axis", "This computer:"):
            assert part in out
        assert out.count("real-time kernel") == 1
        assert run(path.name, "--out", "measured.toml")[0] == 2


def test_cycle_that_the_bus_cannot_carry_is_found_and_no_file_is_written(run, tmp_path, answers_within):
    answers_within(0.2e-3)
    loaders = {"pitch": yoke(node=2), "roll": yoke(node=7)}
    with ff.live.BusEmulator(list(loaders.values())) as emulator:
        wired = {axis: replace(it, bus=replace(it.bus, port=emulator.port)) for axis, it in loaders.items()}
        status, out, err = run(project_of(tmp_path, **wired).name, "--out", "measured.toml")
    assert (status, err) == (1, "")
    assert (
        "roll: bus load: 661 us of 500 us a period, expected at most the period: set controller.period to"
        in " ".join(out.split())
    )
    assert not list(tmp_path.glob("measured*"))


# Bits before the data, of the check sum and behind it; the most that stuffing adds.
CLASSIC = [("command", 4, 44 + 32 + 3 + 16), ("request", 0, 44 + 3 + 8), ("answer", 8, 44 + 64 + 3 + 24)]
ETHERNET_BYTES = 8 + 14 + 2 + (12 + 5) + (12 + 21) + (12 + 6) + (12 + 8) + 4 + 12


def test_load_of_a_cycle_by_hand():
    frames = ff.bus.bus_load(yoke("odrive", **UNSENSED)).frames
    assert [(frame.name, frame.bytes, frame.bits) for frame in frames] == [*CLASSIC, ("heartbeat", 8, 135)]
    assert sum(frame.time_s for frame in frames[:3]) == pytest.approx(285e-6, rel=1e-12)  # at 1 Mbit/s
    frame, slave = ff.bus.bus_load(yoke("ethercat")).frames
    assert (frame.bits, slave.bits) == (8 * ETHERNET_BYTES, 0)
    # 29 bits of identifier and 8 stuffed among 36 bits; then 64 bytes, each fifth bit stuffed, and the long check sum.
    command = ff.bus.bus_load(yoke()).frames[0]
    assert command.bits == 36 + 8 + 13 + (5 + 8 * 64 + (36 + 5 + 8 * 64 - 1) // 4 - 8 + 32)
    guide = (Path(ff.__file__).parents[2] / "docs/how-to/bus.md").read_text(encoding="utf-8")
    for kind, sensed in [("moteus", {}), ("moteus", UNSENSED), ("odrive", {}), ("odrive", UNSENSED), ("ethercat", {})]:
        load = ff.bus.bus_load(yoke(kind, **sensed))
        bits = sum(frame.bits for frame in load.frames if frame.every_s is None)
        assert f" | {bits} | {1e6 * load.time_s:.0f} us" in guide, (kind, sensed)
    with pytest.raises(ff.InputError, match="one port and one"):
        ff.bus.bus_load(yoke(), yoke(port="other"))


def test_two_axes_of_one_node_are_refused_before_anything_is_powered(run, tmp_path):
    """The port need not be there: nothing is opened."""
    path = project_of(tmp_path, pitch=yoke(node=3, port="/dev/none"), roll=yoke(node=3, port="/dev/none"))
    status, _, err = run(path.name)
    assert status == 2
    assert "axes.roll: expected a node of its own at /dev/none, got 3, which pitch has" in err


def test_axis_without_a_bus_is_named(run, tmp_path):
    status, _, err = run(str(project_of(tmp_path, roll=ff.loader.electric("desktop-yoke"))))
    assert status == 2
    assert "axes.roll" in err
    assert "add the table [bus]" in err


@pytest.mark.parametrize("kind", ["moteus", "odrive-0.5"])
def test_missing_or_double_node_of_one_axis_stops_the_check_before_any_axis_is_powered(tmp_path, monkeypatch, kind):
    def powered(loader, *, move):
        raise AssertionError(loader.name)

    monkeypatch.setattr(cockpit, "check_bus", powered)
    with ff.live.BusEmulator([yoke(kind, node=2), yoke(kind, node=7)]) as emulator:
        pair = {axis: yoke(kind, node=node, port=emulator.port) for axis, node in (("pitch", 2), ("roll", 8))}
        with pytest.raises(ff.InputError, match=r"axes\.roll: bus: .* expected node 8, got no answer"):
            ff.bus.check_cockpit(ff.loader.read_project(project_of(tmp_path, **pair)), move=True)
        emulator.add_twin(1)
        pair["roll"] = yoke(kind, node=7, port=emulator.port)
        with pytest.raises(ff.InputError, match=r"axes\.roll: bus: .* expected one node 7, got 2"):
            ff.bus.check_cockpit(ff.loader.read_project(project_of(tmp_path, **pair)), move=True)


class Stuck:
    """A drive that does not move, and the commands that it got."""

    def __init__(self):
        self.commands = []

    def power_up(self):
        return None

    def exchange(self, command, *, enable):
        self.commands.append(command)
        return (0.0,) * 4, 0


def test_direction_of_a_drive_without_a_limit_is_tested_by_the_output_or_not_at_all(monkeypatch):
    monkeypatch.setattr(check, "_RAMP_S", 0.05)
    loader = valve(loader=ff.digital_elevator().replace({"amplifier.current_limit": None}))
    drive = Stuck()
    (finding,) = check._Directions(loader, loader.bus, drive, lambda _: True).found()
    assert not finding.ok
    assert 0.5 < max(drive.commands) <= 1.0  # V, a tenth of the output's range
    motor = yoke().replace({"current_loop.current_limit": None})
    drive = Stuck()
    (finding,) = check._Directions(motor, motor.bus, drive, lambda _: True).found()
    assert finding.remedy == "add current_loop.current_limit to the loader file"
    assert not drive.commands
