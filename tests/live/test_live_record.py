"""Records: whole after a kill, bounded, and read by the rest of the program."""

import json
import signal
import struct
import subprocess
import sys
import time

import numpy as np
import pytest
from mcap.reader import NonSeekingReader, make_reader

import forcefeel as ff

RUNS = """
import mmap, struct, sys, time, forcefeel as ff
with open(sys.argv[2], "r+b") as file, ff.live.start(ff.digital_elevator(), record=sys.argv[1]) as running:
    running.on()
    published = mmap.mmap(file.fileno(), 16)
    late_ns = [0] * 50
    while True:
        begun = time.monotonic_ns()
        time.sleep(0.005)
        late_ns = [*late_ns[1:], time.monotonic_ns() - begun - 5_000_000]
        published[:] = struct.pack("<QQ", running.state.cycle, max(late_ns))
"""
"""Publishes the cycles of the loop, and how late a thread wakes that sleeps as the record's does: the load's cost."""

PUBLISHED_S = 0.005
LOST_S = 0.02
"""Promised of a kill, on a machine that lets the record's thread run."""


def killed(path, seconds):
    """A record whose process was killed, and the time of the published rows that it lacks, less the cost of the load, s."""
    publishes = path.with_suffix(".cycles")
    publishes.write_bytes(bytes(16))
    period = ff.digital_elevator()["controller.period"]
    process = subprocess.Popen([sys.executable, "-c", RUNS, path, publishes])
    try:
        until = time.monotonic() + 100
        while struct.unpack("<QQ", publishes.read_bytes())[0] * period < seconds:
            assert time.monotonic() < until
            time.sleep(0.02)
    finally:
        process.send_signal(signal.SIGKILL)
        process.wait()
    cycles, late_ns = struct.unpack("<QQ", publishes.read_bytes())
    record = ff.live.read_live_record(path)
    return record, (cycles - len(record.rows)) * period - late_ns * 1e-9


def test_kill_loses_at_most_20_ms(tmp_path):
    path = tmp_path / "run.mcap"
    lost_s = []
    for seconds in (0.9, 1.1, 1.3):  # anywhere in a chunk of 0.25 s
        record, lost = killed(path, seconds)
        lost_s.append(lost)
        assert not record.broken
        assert not record.ended
        # Header and end as the format asks for.
        data = path.read_bytes()
        assert data[:8] == data[-8:] == b"\x89MCAP0\r\n"
        assert ff.live.replay(path).same
        with path.open("rb") as file:
            messages = NonSeekingReader(file, validate_crcs=True).iter_messages(topics="/cycle")
            assert sum(1 for _ in messages) == len(record.rows)
    # The median, since load may hold back the record's thread alone; a published count is old by one publication at most.
    assert sorted(lost_s)[1] <= LOST_S - PUBLISHED_S, lost_s


def test_truncated_record_is_read_up_to_its_end(tmp_path):
    path = tmp_path / "run.mcap"
    with ff.live.start(ff.digital_elevator(), real_time=False, record=path) as running:
        running.wait(5000)
    whole = ff.live.read_live_record(path)
    path.write_bytes(path.read_bytes()[: 2 * path.stat().st_size // 3])
    part = ff.live.read_live_record(path)
    assert part.broken
    assert 0 < len(part.rows) < len(whole.rows)
    assert ff.live.replay(path).same


def test_record_size_stays_within_limit(tmp_path):
    path = tmp_path / "run.mcap"
    most = 2**20
    with ff.live.start(ff.digital_elevator(), real_time=False, record=path, most_bytes=most) as running:
        running.wait(8000)
        assert running.state.record_ended == "full"
    assert most / 2 < path.stat().st_size <= most
    assert ff.live.replay(path).same


@pytest.mark.parametrize("content", [b"", b"no record at all", b"\x89MCAP0\r\n"])
def test_invalid_record_raises_input_error(tmp_path, content):
    path = tmp_path / "run.mcap"
    path.write_bytes(content)
    for read in (ff.live.read_live_record, ff.live.replay, ff.qualification.read_record):
        with pytest.raises(ff.InputError, match=r"run\.mcap"):
            read(path)
    with pytest.raises(ff.InputError, match=r"\.mcap"):
        ff.live.start(ff.digital_elevator(), record=tmp_path / "run.csv")


HELD_RAD = np.radians(5)
LET_GO_S = 1.0
"""A quarter of the 20 deg that a loader without stops is given."""


@pytest.fixture(scope="module")
def release(tmp_path_factory):
    """The record of a release: by the supervisor's leave, with the simulated hand, in virtual time."""
    path = tmp_path_factory.mktemp("live") / "release.mcap"
    scenario = ff.Scenario(ff.Release(HELD_RAD, LET_GO_S), duration_s=6.0, sample_s=5e-4)
    endpoint = ff.live.Simulated(scenario)
    loader = ff.digital_elevator()
    with ff.live.start(loader, "robust", endpoint=endpoint, real_time=False, supervised=False, record=path) as running:
        running.wait(10**6)
    return path


@pytest.mark.slow
def test_live_release_qualifies_like_simulated_release(release, tmp_path, forcefeel):
    record = ff.qualification.read_record(release)
    assert record.position_unit == "rad"
    assert record.force_n is not None
    assert len(record.time_s) == 12000
    scenario = ff.Scenario(ff.Release(HELD_RAD, LET_GO_S), duration_s=6.0, sample_s=5e-4)
    history = ff.simulate(ff.digital_elevator(), scenario, "robust").history
    simulated = tmp_path / "simulated.csv"
    table = np.column_stack([history["time_s"], history["column_angle_rad"], history["pilot_force_n"]])
    np.savetxt(simulated, table, delimiter=",", header="time (s),position (rad),force (N)", comments="")
    asked = ("elevator-2khz", "--json", "--test", "release-25-positive")
    verdicts = []
    for device in (simulated, release):
        out_folder = ("--out", tmp_path / f"{device.stem}-out")
        status, out, err = forcefeel("qualify", *asked, *out_folder, "--record", f"release-25-positive={device}")
        assert status == 0, err or out
        verdicts.append(json.loads(out))
    assert [found["status"] for found in verdicts] == ["incomplete", "incomplete"]


def test_a_live_record_is_bench_data(release):
    data = ff.bench.read_bench_record(release, experiment="release")
    assert {"column_angle", "load_cell_force"} <= set(data.channels)


def test_mcap_package_reads_every_message(tmp_path):
    """The ``mcap`` package of the format's makers: each record, its schema, its numbers by the layout that the reference states."""
    path = tmp_path / "run.mcap"
    with ff.live.start(ff.digital_elevator(), real_time=False, record=path) as running:
        running.on()
        running.wait(3000)
    ours = ff.live.read_live_record(path)
    with path.open("rb") as file:
        assert make_reader(file).get_summary().statistics.message_count > len(ours.rows)
    with path.open("rb") as file:
        messages = list(NonSeekingReader(file, validate_crcs=True).iter_messages())
    schema = next(schema for schema, channel, _ in messages if channel.topic == "/cycle")
    assert (schema.name, schema.encoding) == ("forcefeel_msgs/msg/Cycle", "ros2msg")
    lines = schema.data.decode().split("\n")
    assert [line.removeprefix("float64 ") for line in lines if line] == list(ours.columns)
    rows = [message for _, channel, message in messages if channel.topic == "/cycle"]
    # Common data representation: four bytes of head, then the numbers.
    theirs = np.array([np.frombuffer(message.data[4:], "<f8") for message in rows])
    assert np.array_equal(theirs, ours.rows, equal_nan=True)
    at_ns = np.array([message.log_time for message in rows], dtype=np.int64)
    since_s = (at_ns - at_ns[0]) * 1e-9
    assert np.abs(since_s - (ours.column("time_s") - ours.column("time_s")[0])).max() < 2e-9  # whole ns
    lists = [message.data for _, channel, message in messages if channel.topic == "/list"]
    assert any(b"values\0" in data for data in lists)
    assert sum(b"on\0" in data[8:11] for data in lists) == 1
