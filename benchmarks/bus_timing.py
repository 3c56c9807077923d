"""Axes in real time on one emulated bus, beside what the computer itself does: cyclictest, where it is installed.

Run ``python benchmarks/bus_timing.py --bus moteus --axes 3 --period 1e-3``; ``ethercat`` and ``ethercat-analog``, of valves, make
a pair of virtual interfaces and need root. The emulator is a program of its own, so the loop shares the computer with it as with no
real drive. ``--bare`` leaves load cell and column encoder out, under ``torque-mode``.

Prints how late the loop's thread woke, what share of the periods had a sample, and how many commands were under way.
"""

import argparse
import shutil
import subprocess
import sys
import tempfile
import time
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

from tests.live.bus_wire import virtual_interfaces
from tests.live.test_bus import UNSENSED, yoke
from tests.live.test_ethercat_analog import valve

import forcefeel as ff
from forcefeel.loader.bus import ANALOG, ETHERCAT, KINDS, UDP
from forcefeel.loader.project import PROJECT_AXES

SECONDS = 6
QUANTILES = (50, 99, 99.9, 100)


def loaders(options, port):
    """A yoke or a valve's column for each axis, on a computer that may be busy."""
    times = {"controller.period": options.period, "controller.delay": options.period}
    patient = {"safety.overrun_time": 1.0, "safety.silence_time": 0.2}
    wired = UNSENSED if options.bare else {}
    numbers = range(1, options.axes + 1)
    if options.bus == ANALOG:
        machines = [valve(port, node=2 * number - 1, input_node=2 * number) for number in numbers]
    else:
        machines = [yoke(options.bus, port=port, node=number, **wired) for number in numbers]
    return [
        replace(machine.replace(times | patient, si=True), name=f"{machine.name}-{number}")
        for number, machine in zip(numbers, machines, strict=True)
    ]


def emulate(options, port):
    """The machines, until standard input ends."""
    with ff.live.BusEmulator(loaders(options, port)) as emulator:
        print(emulator.port, flush=True)
        sys.stdin.read()


def cyclictest():
    """Cyclictest under way, or nothing."""
    if not shutil.which("cyclictest"):
        return None
    words = [
        "cyclictest",
        "--mlockall",
        "--priority=80",
        "--threads=1",
        "--interval=1000",
        f"--duration={SECONDS}",
        "--quiet",
    ]
    return subprocess.Popen(words, stdout=subprocess.PIPE, text=True)


def row(name, session):
    """What an axis did."""
    rows = dict(zip(session.columns, session.history().T, strict=True))
    sampled = rows["sampled"] > 0
    late, work = (np.percentile(1e6 * rows[of], QUANTILES).round() for of in ("late_s", "work_s"))
    state = session.state
    names = " ".join((state.name, *state.trips))
    return (
        f"{name}: {names}; woke late by {late} us, work {work} us (50, 99, 99.9 %, most); {sampled.mean():.2%} of the periods "
        f"have a sample, {(rows['delay'][sampled] <= 1).mean():.2%} of these within a period; {state.missed} missed"
    )


def run(options):
    with ExitStack() as ends:
        master, slaves = None, "pty"
        if options.bus in {ETHERCAT, ANALOG}:
            master, slaves = ends.enter_context(virtual_interfaces())
        words = [sys.executable, "-P", __file__, *sys.argv[1:], "--emulate", slaves]
        emulator = subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        ends.callback(emulator.wait)
        ends.callback(emulator.stdin.close)
        there = emulator.stdout.readline().strip()
        port = master or there
        folder = Path(ends.enter_context(tempfile.TemporaryDirectory()))
        wired = dict(zip(PROJECT_AXES, loaders(options, port), strict=False))
        for axis, loader in wired.items():
            (folder / f"{axis}.toml").write_text(loader.to_toml(), encoding="utf-8")
        (folder / "cockpit.toml").write_text("[axes]\n" + "".join(f'{axis} = "{axis}.toml"\n' for axis in wired))
        project = ff.loader.read_project(folder / "cockpit.toml")
        beside = cyclictest()
        law = "torque-mode" if options.bare else "robust"
        buses = {axis: loader.bus for axis, loader in project.loaders.items()}
        with ff.live.start_cockpit(project, law, endpoints=buses) as cockpit:
            cockpit.on()
            time.sleep(SECONDS)
            for axis, session in cockpit.items():
                print(row(axis, session))
        print("cyclictest:", beside.communicate()[0].strip().splitlines()[-1] if beside else "not installed")


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--bus", default="moteus", choices=[kind for kind in KINDS if kind != UDP])
    parser.add_argument("--axes", type=int, default=3)
    parser.add_argument("--period", type=float, default=1e-3, help="s")
    parser.add_argument("--bare", action="store_true", help="without load cell and column encoder")
    parser.add_argument("--emulate", metavar="PORT", help="the other program")
    options = parser.parse_args()
    if options.bare and options.bus == ANALOG:
        parser.error("--bare: a valve needs its load cell and sensors; leave it out")
    if options.emulate:
        emulate(options, options.emulate)
    else:
        run(options)


if __name__ == "__main__":
    main()
