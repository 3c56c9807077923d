"""A machine over the network: answers the packets of a live loop with the nonlinear machine of a built-in loader.

    python examples/live-udp/machine.py 5005 &
    forcefeel run elevator-2khz --law robust --machine 127.0.0.1:5005 --headless --duration 10

The packets are taken apart by hand, as a driver in any language would; ``docs/reference/live.md`` has their table. To drive
hardware, put what reads its sensors and writes its command in place of ``machine``.
"""

import socket
import struct
import sys
import time
import zlib

import forcefeel as ff
from forcefeel.loader.built_in import BUILT_IN

MAGIC, VERSION = b"FFLV", 1
SAMPLE, COMMAND, ASK = 1, 2, 3


def sample_packet(sequence: int, sensors: tuple[float, float, float, float, float]) -> bytes:
    """A sample: head, sequence number, clock, load cell, drive, column's base, pilot's force, force at the grip, flags,
    check sum."""
    packet = struct.pack("<4sHHQQ5dI", MAGIC, VERSION, SAMPLE, sequence, time.monotonic_ns(), *sensors, 0)
    return packet + struct.pack("<I", zlib.crc32(packet))


def read_command(packet: bytes) -> tuple[int, int, float, bool] | None:
    """Kind, cycle, command and whether the drive is to be powered; nothing if the packet is damaged or none of ours."""
    if len(packet) != 48 or zlib.crc32(packet[:44]) != struct.unpack_from("<I", packet, 44)[0]:
        return None
    magic, version, kind, cycle, _answers, command, enable = struct.unpack_from("<4sHHQQdI", packet)
    if (magic, version) != (MAGIC, VERSION):
        return None
    return kind, cycle, command, bool(enable & 1)


def serve(port: int, loader_name: str = "elevator-2khz") -> None:
    """Answers every packet, without end."""
    machine = ff.live.Machine(BUILT_IN[loader_name]())
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as link:
        link.bind(("127.0.0.1", port))
        print(f"{loader_name} at 127.0.0.1:{link.getsockname()[1]}", flush=True)
        sequence, newest, sensors = 1, -1, machine.read()
        while True:
            packet, loop = link.recvfrom(64)
            if (read := read_command(packet)) is None:
                continue
            kind, cycle, command, enable = read
            if kind == COMMAND and cycle <= newest:
                continue  # it comes late, or twice
            newest = cycle if kind == COMMAND else -1  # a loop that begins asks first
            if kind == COMMAND:
                machine.write(command, enable)
                sequence, sensors = sequence + 1, machine.read()
            link.sendto(sample_packet(sequence, sensors), loop)


if __name__ == "__main__":
    serve(int(sys.argv[1]) if len(sys.argv) > 1 else 5005, *sys.argv[2:3])
