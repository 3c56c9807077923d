"""The host's example in Python against the bytes that the Rust tests and the C example have, and a loader's packet."""

import importlib.util
import struct
import sys
import zlib
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).parent.parent.parent


@pytest.fixture(scope="module")
def host() -> ModuleType:
    spec = importlib.util.spec_from_file_location("live_host_example", ROOT / "examples/live-host/host.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # its dataclasses look for it
    spec.loader.exec_module(module)
    return module


def test_the_packet_has_the_bytes_of_the_rust_encoder(host: ModuleType) -> None:
    values = host.FromHost(6000.0, 1.5, 0.05, -0.1, 120.0, 15.0, 0.5, -300.0, 0.02, 400.0)
    expected = (ROOT / "crates/model/tests/host/packet.hex").read_text().strip()
    assert host.encode(7, host.ACTIVE | host.AUTOPILOT, values).hex() == expected


def test_a_packet_of_a_loader_is_read_or_refused(host: ModuleType) -> None:
    body = struct.pack("<4sII6f", b"FFL1", 9, 3 | 2 << 8, 0.25, -0.5, 30.0, 0.0, 1.0, 1.0)
    found = host.decode(body + struct.pack("<I", zlib.crc32(body)))
    assert (found.sequence, found.state, found.stopped_by, found.angle, found.force) == (9, 3, 2, 0.25, 30.0)
    with pytest.raises(ValueError, match=r"^packet: expected 40 bytes that begin with FFL1"):
        host.decode(body + b"none")
