"""The console's share of a core and what it costs the loop: eight watchers at 60 frames a second beside a loop at 1 kHz.

``cyclictest`` (of rt-tests) wakes at the same period and priority through the same seconds: what it is late by, the machine
is. Cycles that are missed are reported beside those that it would have missed. ``python benchmarks/console.py 600`` takes ten
minutes. Run it as root, or with limits for priority and memory. Ends with an error if the server takes more of a core than
promised; the rest is the machine's.
"""

import json
import multiprocessing
import os
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import numpy as np
from websockets.sync.client import connect

import forcefeel as ff
from forcefeel.live.console.listener import Listener
from forcefeel.live.console.process import ConsoleProcess
from forcefeel.qualification.plan.run import QualificationSetup

WATCHERS = 8
MOST_SHARE = 0.10
PERIOD_US, PRIORITY = 1000, 80
SHARES = (0.5, 0.99, 0.999, 1.0)
SECONDS = float(sys.argv[1]) if len(sys.argv) > 1 else 20.0


def watch(url: str, token: str, seconds: float, frames) -> None:
    with connect(url, additional_headers={"Authorization": f"Bearer {token}"}, compression=None, proxy=None) as socket:
        end = time.monotonic() + seconds
        count = 0
        while time.monotonic() < end:
            count += isinstance(socket.recv(), bytes)
        frames.put(count)


def loop():
    return ff.live.start(ff.digital_elevator().replace({"controller.period": "1 ms"}), "robust")


def cyclictest(seconds: float, folder: Path) -> subprocess.Popen | None:
    """Begun beside the loop, on its period and at its priority."""
    if shutil.which("cyclictest") is None:
        return None
    arguments = f"-q -m -t1 -p{PRIORITY} -i{PERIOD_US} -D{round(seconds)} -h100000 --json={folder / 'latency.json'}"
    return subprocess.Popen(["cyclictest", *arguments.split()], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def latencies(folder: Path) -> tuple[np.ndarray, int]:
    """p50, p99, p99.9, worst in us, and how often it was a period late or more."""
    (thread,) = json.loads((folder / "latency.json").read_text(encoding="utf-8"))["thread"].values()
    us, counts = (np.array(list(each), dtype=int) for each in (thread["histogram"], thread["histogram"].values()))
    order = np.argsort(us)
    us, counts = us[order], counts[order]
    share = np.cumsum(counts) / counts.sum()
    places = [min(np.searchsorted(share, q), len(us) - 1) for q in SHARES]
    return us[places].astype(float), int((counts * (us // PERIOD_US)).sum())


def cpu_s(console: ConsoleProcess) -> float:
    """What the server has used, and the thread of the loop's process that answers it."""
    fields = Path(f"/proc/{console.process_id}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
    (answers,) = (thread for thread in threading.enumerate() if thread.name == "forcefeel console")
    ticks = int(fields[11]) + int(fields[12])  # utime and stime, fields 14 and 15 of proc(5)
    return ticks / os.sysconf("SC_CLK_TCK") + time.clock_gettime(time.pthread_getcpuclockid(answers.ident))


def main() -> None:
    folder = Path(tempfile.mkdtemp())
    frames, context = multiprocessing.Queue(), multiprocessing.get_context("fork")
    door = Listener.at(0, "127.0.0.1", token=True)
    with loop() as running, ConsoleProcess({"": running}, door, QualificationSetup(), print) as console:
        token = door.admission.watch
        url = door.watch_address.partition("?")[0].replace("http", "ws") + "live"
        watchers = [context.Process(target=watch, args=(url, token, SECONDS + 3, frames)) for _ in range(WATCHERS)]
        for watcher in watchers:
            watcher.start()
        time.sleep(3.0)  # until all are there and the curve is drawn
        before, missed, cycle = cpu_s(console), running.state.missed, running.state.cycle
        late = running.timing.late.counts
        beside = cyclictest(SECONDS - 1, folder)
        time.sleep(SECONDS - 1)
        later = running.timing
        of_loop = ff.live.Histogram(later.late.edges_us, later.late.counts - late, later.late.worst_us)
        share, state = (cpu_s(console) - before) / (SECONDS - 1), running.state
        for watcher in watchers:
            watcher.join()
    each = [frames.get() / (SECONDS + 3) for _ in watchers]
    print(f"{WATCHERS} watchers, {min(each):.1f} to {max(each):.1f} frames/s each, over {SECONDS:g} s")
    print(f"server: {100 * share:.1f} % of a core (at most {100 * MOST_SHARE:g} %)")
    print("; ".join(running.realtime_status))
    loop_us = np.array([of_loop.quantile_us(share) for share in SHARES])
    print("loop       p50 {:.0f} us, p99 {:.0f}, p99.9 {:.0f}, worst {:.0f}".format(*loop_us))
    print(f"missed {state.missed - missed} of {state.cycle - cycle + state.missed - missed} cycles")
    if beside is None:
        print("cyclictest is not installed: apt-get install rt-tests")
    else:
        beside.wait()
        idle_us, would = latencies(folder)
        print("cyclictest p50 {:.0f} us, p99 {:.0f}, p99.9 {:.0f}, worst {:.0f}".format(*idle_us))
        print(
            f"it would have missed {would}; ratio of p50 {loop_us[0] / idle_us[0]:.2f}, of p99.9 {loop_us[2] / idle_us[2]:.2f}"
        )
    sys.exit(share > MOST_SHARE)


if __name__ == "__main__":
    main()
