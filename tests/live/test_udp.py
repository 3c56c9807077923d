"""A machine over the network: the example in Python and that in C, at the other end of a socket."""

import shutil
import socket
import struct
import subprocess
import sys
import zlib
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

import forcefeel as ff
from tests.command_line import runs
from tests.live.unhurried import unhurried_elevator

run = runs("run")

EXAMPLES = Path(__file__).parents[2] / "examples" / "live-udp"


@contextmanager
def served(*command):
    """A machine in a process of its own, and its address."""
    process = subprocess.Popen([*map(str, command)], stdout=subprocess.PIPE, text=True)
    try:
        yield process.stdout.readline().split()[-1]
    finally:
        process.kill()
        process.wait()
        process.stdout.close()


def test_udp_machine_matches_local_machine_and_trips_when_killed():
    # One process for both: Python takes seconds to start there.
    with served(sys.executable, EXAMPLES / "machine.py", 0) as address:
        runs_as_the_one_in_the_process(address)
        running = ff.live.start(unhurried_elevator(), "robust", endpoint=ff.live.Udp(address))
        running.on()
        running.wait(1000, 20.0)
        assert running.state.silent < running.state.cycle
    running.wait(400)
    running.end()
    assert running.state.name == "tripped"
    assert "sensors silent" in running.state.trips
    last = dict(zip(running.columns, running.history(most=1)[0], strict=True))
    assert (last["command"], last["enable"]) == (0.0, 0.0)
    with pytest.raises(ff.InputError, match="simulated"):
        running.hand_force_n = 1.0


def runs_as_the_one_in_the_process(python_machine):
    loader = ff.digital_elevator()
    runs = []
    for endpoint in (ff.live.Udp(python_machine), ff.live.Simulated()):
        with ff.live.start(loader, "robust", endpoint=endpoint, real_time=False) as running:
            running.on()
            running.wait(12_000)
            rows = running.history(most=1000)
            assert running.state.name == "active"
        runs.append(dict(zip(running.columns, rows.T, strict=True)))
    for column, least in (("column_angle_rad", 1e-4), ("command", 0.05)):
        far, near = runs[0][column], runs[1][column]
        # The same machine with the same noise, begun otherwise: at rest both, but for that noise.
        assert np.abs(far.mean() - near.mean()) < least


def sample_head(session):
    """A sample before the first command, without its check sum."""
    return struct.pack("<4sHHQQQQ5dI", b"FFLV", 2, 1, 5, session, 2**64 - 1, 0, 0.0, 0.0, 0.0, float("nan"), 0.0, 0)


def summed(packet):
    return packet + struct.pack("<I", zlib.crc32(packet))


def test_invalid_packets_are_dropped():
    loop_s = 0.3
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as machine:
        machine.bind(("127.0.0.1", 0))
        machine.settimeout(10)
        address = f"127.0.0.1:{machine.getsockname()[1]}"
        with ff.live.start(ff.digital_elevator(), endpoint=ff.live.Udp(address)) as running:
            ask, loop = machine.recvfrom(64)
            (session,) = struct.unpack_from("<Q", ask, 16)
            head = sample_head(session)
            good = summed(head)
            forged = summed(sample_head(session ^ 1))
            for bad in (
                forged,
                b"",
                b"x" * 64,
                good[:-1],
                good[:-1] + b"\0",
                good[:4] + b"\1" + good[5:],
                good + b"\0",
            ):
                machine.sendto(bad, loop)
            running.wait(int(loop_s / running.period_s))
            state = running.state
            assert abs(state.silent - state.cycle) <= 1  # both are read while the loop goes on
            machine.sendto(good, loop)
            machine.sendto(good, loop)
            running.wait(100)
            history = running.history()
            assert history[:, running.columns.index("sampled")].sum() == 1  # the second is no newer


@pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler")
def test_c_machine_uses_same_protocol(run, tmp_path):
    program = tmp_path / "machine"
    subprocess.run(["cc", "-O2", "-Wall", "-Werror", "-o", program, EXAMPLES / "machine.c"], check=True)
    with (
        served(program, 0) as address,
        ff.live.start(ff.digital_elevator(), "robust", endpoint=ff.live.Udp(address), real_time=False) as running,
    ):
        running.wait(2000)
        assert (running.state.silent, running.state.drive_fault) == (0, "")
        history = running.history(most=100)
        assert np.isfinite(history[:, running.columns.index("column_angle_rad")]).all()
        assert np.isnan(history[:, running.columns.index("pilot_force_n")]).all()
        requires_pilots_force(run, address, tmp_path)


def requires_pilots_force(run, machine, folder):
    """A machine that measures no pilot's force, under a law that feeds it back: named, and nothing moves."""
    record = folder / "run" / "record.mcap"
    words = ["elevator-2khz", "--law", "original", "--machine", machine, "--headless", "--duration", "0.5 s"]
    status, out, err = run(*words, "--out", str(record.parent))
    assert (status, err) == (1, ""), out
    assert "drive: no pilot's force in the samples; the law requires it: choose the law robust" in " ".join(out.split())
    assert not ff.live.read_live_record(record).column("enable").any()
    assert ff.live.replay(record).same


@pytest.mark.parametrize("address", ["nowhere", "127.0.0.1", "127.0.0.1:", "127.0.0.1:99999", ":5005"])
def test_invalid_address_raises_input_error(address):
    with pytest.raises(ff.InputError, match="host:port"):
        ff.live.Udp(address)
