"""The line to a machine over the network, cut and restored: what the loop does, sample by sample, as its record has it."""

import shutil
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

import forcefeel as ff
from forcefeel import _core
from tests.live.bus_wire import before_others

HERE = Path(__file__).parent
EXAMPLE = Path(__file__).parents[2] / "examples" / "live-udp"
PERIOD = "2 ms"
CUTS_MS = (50, 300, 1000)
"""Each longer than ``safety.silence_time``, 20 ms."""
AFTER_S = 0.2
"""How long it is watched after the samples are back, and once more after it is acknowledged."""
PASSING = 3
"""Cycles within which a command reaches the relay and its process."""
PATIENCE_S = 30.0

MACHINE = f"""
import sys
sys.path.insert(0, {str(EXAMPLE)!r})
import forcefeel as ff, machine
machine.BUILT_IN = {{"slow": lambda: ff.digital_elevator().replace({{"controller.period": "{PERIOD}"}})}}
machine.serve(0, "slow")
"""

pytestmark = pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler")


@contextmanager
def served(*command):
    """A process that tells its address."""
    process = subprocess.Popen([*map(str, command)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    before_others(process)
    try:
        yield process, process.stdout.readline().split()[-1]
    finally:
        process.kill()
        process.communicate()


def until(holds):
    end = time.monotonic() + PATIENCE_S
    while not holds():
        assert time.monotonic() < end
        time.sleep(0.005)


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A loader, and the record of a run with the cuts one after the other."""
    folder = tmp_path_factory.mktemp("cut")
    subprocess.run(["cc", "-O2", "-Wall", "-Werror", "-o", folder / "relay", HERE / "relay.c"], check=True)
    loader = ff.digital_elevator().replace({"controller.period": PERIOD}, si=True)
    with (
        served(sys.executable, "-c", MACHINE) as (_, machine),
        served(folder / "relay", machine.partition(":")[2]) as (relay, address),
        ff.live.start(loader, "robust", endpoint=ff.live.Udp(address), record=folder / "run.mcap") as running,
    ):
        for lasts_ms in CUTS_MS:
            running.off()
            running.wait(10)  # off has to be seen before on
            running.on()
            until(lambda: running.state.name == "active")
            silent = running.state.silent
            relay.stdin.write(f"cut {lasts_ms}\n")
            relay.stdin.flush()
            until(lambda before=silent: running.state.silent > before)
            time.sleep(lasts_ms / 1e3 + AFTER_S)
            running.acknowledge()
            until(lambda: running.state.trips == ())
            time.sleep(AFTER_S)
    return loader, ff.live.read_live_record(folder / "run.mcap")


def test_network_cut_trips_in_time_without_restart(run):
    loader, record = run
    period = loader["controller.period"]
    times = record.column("time_s")
    sampled, state = record.column("sampled") == 1, record.column("state")
    safe = (record.column("enable") == 0) & (record.column("command") == 0)
    functions = _core.safety_functions(loader.si_values, loader.drive, period)
    samples = next(count for name, _, count, *_ in functions if name == "sensors silent")
    stop = round(loader["safety.stop_time"] / period)
    silent = [(begin, end) for begin, end in runs(~sampled) if end - begin >= samples]  # a busy machine is late by less
    assert len(silent) == len(CUTS_MS)  # an old sample that came within, taken for one, would have made two of a cut
    on = [cycle for cycle, name, _ in record.requests if name == "on"]
    off, active, tripped = (ff.live.STATES.index(name) for name in ("off", "active", "tripped"))
    for lasts_ms, (begin, end), started in zip(CUTS_MS, silent, [*on[1:], len(state)], strict=True):
        assert times[end] - times[begin] > lasts_ms / 1e3 - PASSING * period  # cycles that were missed have no row
        assert state[begin - 1] == active
        # Cycles that were missed count as silent.
        trips = begin + int(np.argmax(times[begin:end] - times[begin - 1] > (samples - 0.5) * period))
        assert (state[trips - 1], state[trips]) == (active, tripped)
        assert safe[trips + stop : started].all()
        returned, cleared = end, begin + int(np.argmax(state[begin:] == off))
        assert (state[trips:cleared] == tripped).all()
        assert times[cleared] - times[returned] > AFTER_S / 2
        assert (state[cleared:started] == off).all()
        assert times[started - 1] - times[cleared] > AFTER_S / 2


def runs(holds):
    """First place and the one after the last of each stretch in which something holds."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], holds, [False]])))
    return edges.reshape(-1, 2)
