"""Wires for tests: a serial bus that is looked at, line by line; the two ends of a network; a run that kept its time."""

import json
import os
import select
import shutil
import subprocess
import threading
import tty
from collections.abc import Iterator
from contextlib import contextmanager, suppress

import pytest

NEEDS_ROOT = pytest.mark.skipif(
    not (hasattr(os, "geteuid") and os.geteuid() == 0 and shutil.which("ip")),
    reason="virtual interfaces need root and ip",
)


TRIES = 3
"""Runs of a command in real time: a machine that tests share may keep one from its cycles."""

KEPT_TIME = 5
"""Cycles at most that a run of 1 kHz misses, for its supervisor to judge the bus and not the machine."""


def run_that_kept_time(run, *words: str) -> dict:
    """What a headless run of 1 s over a bus reports, once its loop had its cycles; it ends well, or the test fails."""
    for _ in range(TRIES):
        status, out, err = run(*words, "--headless", "--duration", "1 s", "--json")
        found = json.loads(out)
        if status == 0 or found["missed"] + found["cycles_without_sample"] <= KEPT_TIME:
            break
    assert (status, err, found["trips"]) == (0, "", []), out
    return found


def before_others(process: subprocess.Popen[str]) -> None:
    """Has a process, one that is to keep real time, run before what else the machine has to do, where that is allowed."""
    with suppress(PermissionError):
        os.sched_setscheduler(process.pid, os.SCHED_FIFO, os.sched_param(50))


@contextmanager
def virtual_interfaces() -> Iterator[tuple[str, str]]:
    """The master's end of a wire, and the slaves'."""
    master, slaves = (f"ff{os.getpid()}{side}" for side in "ms")
    made = subprocess.run(
        ["ip", "link", "add", master, "type", "veth", "peer", "name", slaves],
        capture_output=True,
        text=True,
        check=False,
    )
    if made.returncode:
        pytest.skip(f"no virtual interfaces: {made.stderr.strip()}")
    try:
        for end in (master, slaves):
            subprocess.run(["ip", "link", "set", end, "up"], check=True)
        yield master, slaves
    finally:
        subprocess.run(["ip", "link", "del", master], check=True)


@contextmanager
def tapped(port) -> Iterator[tuple[str, list[bytes]]]:
    """A port of its own that leads to ``port``, and the lines that a client writes to it."""
    near, client = os.openpty()
    far = os.open(port, os.O_RDWR | os.O_NOCTTY)
    for end in (near, client, far):
        tty.setraw(end)
    lines, ended = [b""], threading.Event()

    def pass_on():
        while not ended.is_set():
            for end in select.select([near, far], [], [], 0.05)[0]:
                data = os.read(end, 4096)
                os.write(far if end == near else near, data)
                if end == near:
                    *whole, rest = (lines.pop() + data).replace(b"\r", b"\n").split(b"\n")
                    lines.extend([*(line for line in whole if line), rest])

    thread = threading.Thread(target=pass_on)
    thread.start()
    try:
        yield os.ttyname(client), lines
    finally:
        ended.set()
        thread.join()
        for end in (near, client, far):
            os.close(end)
