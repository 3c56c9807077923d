"""The host's example in Python: its bytes against those of the Rust tests and the C example, and a running loop that it guides."""

import importlib.util
import json
import socket
import struct
import subprocess
import sys
import time
import zlib
from contextlib import suppress
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import forcefeel as ff
from tests.live.unhurried import unhurried_elevator

ROOT = Path(__file__).parent.parent.parent

pytestmark = pytest.mark.usefixtures("coarse_range")


@pytest.fixture(scope="module")
def host() -> ModuleType:
    spec = importlib.util.spec_from_file_location("live_host_example", ROOT / "examples/live-host/host.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # its dataclasses look for it
    spec.loader.exec_module(module)
    return module


def test_packet_bytes_match_rust_encoder(host: ModuleType) -> None:
    flight = (250.0, 12.0, 62.0, 0.07, -0.02, 0.1, 0.05, -0.03, 1.4, 0.18, 0.06, 0.35)
    values = host.FromHost(6000.0, 1.5, 0.05, -0.1, 120.0, 15.0, 0.5, -300.0, 0.02, 400.0, *flight)
    expected = (ROOT / "crates/model/tests/all/host/packet.hex").read_text().strip()
    assert host.encode(7, host.ACTIVE | host.AUTOPILOT, values).hex() == expected


_CPP = """#include "host.hpp"
#include <cstdio>
int main() {
    forcefeel::FromHost v{6000.0f, 1.5f, 0.05f, -0.1f, 120.0f, 15.0f, 0.5f, -300.0f, 0.02f, 400.0f, 250.0f, 12.0f, 62.0f, 0.07f,
                          -0.02f, 0.1f, 0.05f, -0.03f, 1.4f, 0.18f, 0.06f, 0.35f};
    for (auto byte : forcefeel::encode(7, forcefeel::ACTIVE | forcefeel::AUTOPILOT, v)) std::printf("%02x", byte);
}
"""


@pytest.mark.parametrize("language", ["c", "c++"])
def test_hosts_in_c_and_cpp_make_the_same_bytes(language: str, tmp_path: Path) -> None:
    examples, program = ROOT / "examples/live-host", tmp_path / "host"
    source = examples / "host.c"
    if language == "c++":
        source = tmp_path / "host.cpp"
        source.write_text(_CPP, encoding="utf-8")
    compiler = {"c": ["cc", "-std=c11"], "c++": ["c++", "-std=c++17", "-I", str(examples)]}[language]
    subprocess.run([*compiler, "-O2", "-Wall", "-Wextra", "-Werror", "-o", program, source], check=True)
    made = subprocess.run([program], check=True, capture_output=True, text=True).stdout
    assert made.strip() == (ROOT / "crates/model/tests/all/host/packet.hex").read_text().strip()


def test_a_packet_of_a_loader_is_read_or_refused(host: ModuleType) -> None:
    body = struct.pack("<4sII6f", b"FFL1", 9, 3 | 2 << 8 | 1 << 16, 0.25, -0.5, 30.0, 0.0, 1.0, 1.0)
    found = host.decode(body + struct.pack("<I", zlib.crc32(body)))
    read = (found.sequence, found.state, found.stopped_by, found.refused, found.angle, found.force)
    assert read == (9, 3, 2, True, 0.25, 30.0)
    with pytest.raises(ValueError, match=r"^packet: expected 40 bytes that begin with FFL1"):
        host.decode(body + b"none")


PATIENCE_S = 30.0
TRIM_RAD = 0.02


def test_simulator_guides_loop_and_its_silence_restores_feel(host: ModuleType, tmp_path: Path) -> None:
    loader = unhurried_elevator()
    path = tmp_path / "run.mcap"
    running = ff.live.start(loader, "robust", host=0, record=path)
    with running, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as wire:
        running.on()
        assert running.host == ff.live.HostState(running.host.listens, "", 0, 0, None, 0.0)
        address, _, port = running.host.listens.rpartition(":")
        assert address == "127.0.0.1"
        wire.settimeout(0.5)
        until, answer = time.monotonic() + PATIENCE_S, None
        while answer is None or (answer.share, answer.host_share) != (1.0, 1.0):
            assert time.monotonic() < until, answer
            sequence = running.host.packets + 1
            wire.sendto(host.encode(sequence, host.ACTIVE, host.FromHost(trim=TRIM_RAD)), (address, int(port)))
            with suppress(TimeoutError):  # a loop that others keep from running answers no packet that is old
                answer = host.decode(wire.recv(64))
            time.sleep(0.01)
        assert (answer.state, answer.stopped_by) == (ff.live.STATES.index("active"), 0)
        wire.sendto(b"no packet", (address, int(port)))
        while running.host.share > 0 or running.host.refused == 0:
            assert time.monotonic() < until, running.host
            time.sleep(0.01)
        assert running.state.name == "active"
        taken = running.host.packets
        assert taken >= answer.sequence
    record = ff.live.read_live_record(path)
    packets = [numbers for _, name, numbers in record.requests if name == "host"]
    assert len(packets) == taken
    assert np.float32(TRIM_RAD) == packets[0][4]
    assert record.column("neutral_rad").max() == pytest.approx(TRIM_RAD, abs=1e-6)  # of single precision
    assert ff.live.replay(path).same


@pytest.mark.slow
def test_other_sender_takes_over_only_when_accepted(host: ModuleType) -> None:
    with ff.live.start(unhurried_elevator(), "robust", host=0) as running:
        address, _, port = running.host.listens.rpartition(":")
        with pytest.raises(ff.InputError, match="expected another sender"):
            running.accept_host()

        def send(wire: socket.socket, until) -> None:
            patience = time.monotonic() + PATIENCE_S
            while not until():
                assert time.monotonic() < patience, running.host
                wire.sendto(host.encode(running.host.packets + 1, host.ACTIVE, host.FromHost()), (address, int(port)))
                time.sleep(0.02)

        with (
            socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as first,
            socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other,
        ):
            send(first, lambda: running.host.packets >= 1)
            send(other, lambda: running.host.waiting)
            taken, name = running.host.packets, running.host.waiting
            assert name == f"127.0.0.1:{other.getsockname()[1]}"
            assert running.host.address != name
            running.accept_host()
            assert (running.host.address, running.host.silent_s, running.host.waiting) == (name, None, "")
            send(other, lambda: running.host.packets > taken)
            assert running.host.address == name


def test_run_accepts_simulator_packets(forcefeel) -> None:
    asked = ("elevator-2khz", "--headless", "--duration", "20 ms", "--host")
    status, out, err = forcefeel("run", *asked, "0", "--json")
    assert (status, err) == (0, "")
    assert json.loads(out)["host"]["packets"] == 0
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", 0))
        port = str(taken.getsockname()[1])
        for given, part in (("here", "UDP port"), ("70000", "UDP port"), (port, port)):
            status, out, err = forcefeel("run", *asked, given)
            assert (status, out) == (2, "")
            assert part in err


def test_host_without_supervisor_raises_input_error() -> None:
    with pytest.raises(ff.InputError, match="requires the supervisor"):
        ff.live.start(ff.digital_elevator(), host=0, supervised=False)


def test_host_spring_damping_loss_matches_reference() -> None:
    """Roots of s^2 + 2 zeta w s + w^2 exp(-s tau) = 0, tau two periods of a host at 60 Hz, by Newton's method."""
    zeta, tau, lost = 0.2, 2 / 60, []
    for hertz in (1.0, 2.0, 3.0, 4.0):
        w = 2 * np.pi * hertz
        s = 1j * w
        for _ in range(50):
            late = w**2 * np.exp(-s * tau)
            s -= (s**2 + 2 * zeta * w * s + late) / (2 * s + 2 * zeta * w - tau * late)
        lost.append(f"{zeta + s.real / abs(s):.2f}")
        if hertz <= 2.0:  # the rule of thumb, where the delay is short beside the period
            assert zeta + s.real / abs(s) == pytest.approx(w * tau / 2, rel=0.05)  # of second order in w tau
    text = " ".join((ROOT / "docs/reference/host.md").read_text(encoding="utf-8").split())
    assert f"takes {', '.join(lost[:-1])} and {lost[-1]} of damping ratio" in text
