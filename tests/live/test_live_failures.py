"""What a running loop makes of a console that hangs, a process that is stopped, and Ctrl-C."""

import json
import signal
import threading
import time

import forcefeel as ff
from tests.live.run_command import run_command

PATIENCE_S = 100.0


def test_hung_console_does_not_delay_loop():
    """The server's thread holds the interpreter's lock; the loop's thread needs none."""
    with ff.live.start(ff.digital_elevator(), real_time=False) as running, ff.live.Console(running, port=0) as console:
        running.on()
        running.wait(10_000)
        before = running.state
        hangs, done = threading.Event(), []

        def hang():
            hangs.set()
            total = 0
            for number in range(3_000_000):  # some tenths of a second of nothing but Python
                total += number
            done.append(running.state)

        console._loop.call_soon_threadsafe(hang)
        assert hangs.wait(PATIENCE_S)
        until = time.monotonic() + PATIENCE_S
        while not done:
            assert time.monotonic() < until
            time.sleep(0.01)
        assert done[0].cycle - before.cycle > 1000
        assert done[0].lost_rows == 0
        assert done[0].name == "active"


def test_stopped_run_counts_missed_cycles_and_ctrl_c_ends_cleanly(tmp_path):
    """SIGSTOP holds the whole process, its loop too; what is wired beside it is what acts then."""
    path = tmp_path / "live" / "record.mcap"
    until = time.monotonic() + PATIENCE_S

    def grown(process, most):
        while not (path.exists() and path.stat().st_size > most):
            assert process.poll() is None, process.communicate()
            assert time.monotonic() < until
            time.sleep(0.02)

    with run_command("elevator-2khz", "--headless", "--out", "live", "--json", cwd=tmp_path) as process:
        grown(process, 500_000)
        process.send_signal(signal.SIGSTOP)
        time.sleep(0.1)
        size = path.stat().st_size
        time.sleep(0.2)
        process.send_signal(signal.SIGCONT)
        grown(process, size + 300_000)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=PATIENCE_S)
    assert (process.returncode, err) == (0, "")
    found = json.loads(out)
    assert found["missed"] >= 200
    assert found["trips"] == []
    record = ff.live.read_live_record(path)
    assert not record.broken
    assert record.column("missed").max() >= 200
    assert len(record.rows) == found["cycles"]
    assert ff.live.replay(path).same
