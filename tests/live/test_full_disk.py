"""A disk that is full, or becomes full, is never passed over in silence, and what was written stays readable."""

import json
import subprocess
import sys
from contextlib import contextmanager

import pytest

import forcefeel as ff

LIMITED = """
import resource, sys
resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[1]), resource.RLIM_INFINITY))
sys.argv[1:] = sys.argv[2:]
from forcefeel.cli import main
main()
"""
"""The command in a process whose files may grow no larger: a write beyond fails, as on a full disk without reserved room."""

LIVE = ("run", "elevator-2khz", "--headless", "--out", "live", "--json")


def limited(most_bytes, *words, cwd):
    return subprocess.run(
        [sys.executable, "-c", LIMITED, str(most_bytes), *words],
        cwd=cwd,
        capture_output=True,
        text=True,
        timeout=100,
        check=False,
    )


def test_failed_write_is_reported_and_earlier_data_kept(tmp_path):
    done = limited(500_000, *LIVE, "--duration", "1.5 s", cwd=tmp_path)
    assert done.returncode == 1, done.stderr
    found = json.loads(done.stdout)
    assert "File too large" in found["record_ended"]
    assert "the record has ended, and the loop goes on: File too large" in done.stderr
    path = tmp_path / "live" / "record.mcap"
    record = ff.live.read_live_record(path)
    assert not record.broken
    assert len(record.rows) > 100
    assert found["rows_lost"] == found["cycles"] - len(record.rows)
    assert ff.live.replay(path).same
    data = path.read_bytes()
    assert data[:8] == data[-8:] == b"\x89MCAP0\r\n"
    assert len(data) <= 500_000


def test_full_record_states_reason_of_its_end(tmp_path):
    path = tmp_path / "run.mcap"
    cycles = 8000
    with ff.live.start(ff.digital_elevator(), real_time=False, record=path, most_bytes=2**20) as running:
        running.wait(cycles)
    state, record = running.state, ff.live.read_live_record(path)
    assert state.record_ended == record.ended == ff.live.replay(path).ended == "full"
    assert state.unrecorded_rows == state.cycle - len(record.rows) > 0
    with ff.live.start(ff.digital_elevator(), real_time=False, record=path) as running:
        running.wait(100)
    assert running.state.unrecorded_rows == 0
    assert ff.live.read_live_record(path).ended == "with the run"


@contextmanager
def small_disk(folder, size):
    """A file system of its own; skipped where it may not be mounted."""
    folder.mkdir()
    mounted = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", folder], capture_output=True, check=False
    )
    if mounted.returncode:
        pytest.skip("this user may not mount a file system")
    try:
        yield folder
    finally:
        subprocess.run(["umount", folder], check=True)


@pytest.mark.parametrize("size", ["100k", "2m"])
def test_run_without_disk_space_for_record_is_refused(tmp_path, size):
    with small_disk(tmp_path / "disk", size) as disk:
        done = subprocess.run(
            [sys.executable, "-c", "from forcefeel.cli import main; main()", *LIVE, "--duration", "6 s"],
            cwd=disk,
            capture_output=True,
            text=True,
            timeout=100,
            check=False,
        )
        assert (done.returncode, done.stdout) == (2, "")
        assert "No space left on device" in done.stderr
        assert "a record of this run takes" in done.stderr
        assert not (disk / "live" / "record.mcap").exists()


def test_record_on_full_disk_ends_complete(tmp_path):
    with small_disk(tmp_path / "disk", "9m") as disk:
        path = disk / "run.mcap"
        with ff.live.start(ff.digital_elevator(), real_time=False, record=path) as running:
            running.wait(40_000)
            assert running.state.record_ended.startswith("the disk is full: No space left on device")
        record = ff.live.read_live_record(path)
        assert record.ended == running.state.record_ended
        assert not record.broken
        assert len(record.rows) + running.state.unrecorded_rows == running.state.cycle
        # All but the last reservation of 1 MiB and the 64 KiB kept for the end of the file.
        size = path.stat().st_size
        assert size > 8 * 2**20 - 2**16
        # A row has 307 bytes; how many chunks they make, which end by the clock, is up to the machine.
        assert 307 * len(record.rows) > 0.7 * size
        assert ff.live.replay(path).same
