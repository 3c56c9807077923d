"""A host in Python: what an aircraft simulator sends to a loader, 60 times a second, and what it gets back.

    python host.py [address] [port]

The layout stands in docs/reference/host.md. It needs nothing but Python's own library.
"""

import socket
import struct
import sys
import time
import zlib
from dataclasses import astuple, dataclass

ACTIVE, AUTOPILOT, PUSHER, JAM, DISCONNECT, POWER_LOST, TRIM_RUNAWAY, FREEZE, FLIGHT = (1 << bit for bit in range(9))
_FROM_HOST = struct.Struct("<4sII22f")
_TO_HOST = struct.Struct("<4sII6f")
_SUM = struct.Struct("<I")
RATE_HZ = 60


@dataclass(frozen=True)
class FromHost:
    """What a host sends, in SI units; the defaults are what holds without a host."""

    dynamic_pressure: float = 0.0
    spring_factor: float = 1.0
    trim: float = 0.0
    autopilot_position: float = 0.0
    autopilot_force: float = 0.0
    added_force: float = 0.0  # of what does not depend on the control's own position
    shaker: float = 0.0
    pusher_force: float = 0.0
    trim_runaway_rate: float = 0.0
    jam_force: float = 0.0
    added_stiffness: float = 0.0  # of what does: a spring and a damper, closed in the loader
    added_damping: float = 0.0
    true_airspeed: float = 0.0
    angle_of_attack: float = 0.0
    sideslip: float = 0.0
    roll_rate: float = 0.0
    pitch_rate: float = 0.0
    yaw_rate: float = 0.0
    load_factor: float = 1.0
    mach: float = 0.0
    tab: float = 0.0
    flap: float = 0.0  # angle of the flaps; a project's [flap_trim] moves neutrals by it


@dataclass(frozen=True)
class ToHost:
    """What a loader sends: angles in rad, force in N; the state's and the function's places in their tables.

    ``refused``: whether the last packet was, since the loader cannot render its spring or damping.
    """

    sequence: int
    state: int
    stopped_by: int
    refused: bool
    angle: float
    rate: float
    force: float
    neutral: float
    share: float
    host_share: float


def encode(sequence: int, switches: int, values: FromHost) -> bytes:
    """The bytes of a packet."""
    body = _FROM_HOST.pack(b"FFH2", sequence & 0xFFFFFFFF, switches, *astuple(values))
    return body + _SUM.pack(zlib.crc32(body))


def decode(packet: bytes) -> ToHost:
    """What a loader's packet holds.

    Raises:
        ValueError: If it has another length, name, version or check sum.
    """
    body, checksum = packet[:-4], packet[-4:]
    if len(body) != _TO_HOST.size or body[:4] != b"FFL1" or checksum != _SUM.pack(zlib.crc32(body)):
        raise ValueError(
            f"packet: expected {_TO_HOST.size + 4} bytes that begin with FFL1, got {len(packet)}: {packet[:4]!r}"
        )
    _, sequence, status, *numbers = _TO_HOST.unpack(body)
    return ToHost(sequence, status & 0xFF, status >> 8 & 0xFF, bool(status >> 16 & 1), *numbers)


def main() -> None:
    address = (sys.argv[1] if len(sys.argv) > 1 else "127.0.0.1", int(sys.argv[2]) if len(sys.argv) > 2 else 8732)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as wire:
        wire.settimeout(1 / RATE_HZ)
        sequence = 0
        while True:
            sequence += 1
            wire.sendto(encode(sequence, ACTIVE, FromHost(trim=0.02)), address)
            try:
                print(decode(wire.recv(2048)))
            except TimeoutError:
                continue
            time.sleep(1 / RATE_HZ)


if __name__ == "__main__":
    main()
