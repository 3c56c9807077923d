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

MAGIC, VERSION = b"FFLV", 2
SAMPLE, COMMAND, ASK = 1, 2, 3
NO_CYCLE = 2**64 - 1  # what a sample answers before the first command
IDLE = 2  # flag of a sample: the drive carries out no commands
GONE_S = 1.0  # silence of a loop that powers the drive after which another one may ask


def sample_packet(
    sequence: int, session: int, answers: int, sensors: tuple[float, float, float, float, float], *, acts: bool
) -> bytes:
    """A sample: head, sequence number, session key, cycle that it answers, clock, load cell, drive, column's base,
    pilot's force, force at the grip, flags, check sum."""
    packet = struct.pack(
        "<4sHHQQQQ5dI",
        MAGIC,
        VERSION,
        SAMPLE,
        sequence,
        session,
        answers,
        time.monotonic_ns(),
        *sensors,
        0 if acts else IDLE,
    )
    return packet + struct.pack("<I", zlib.crc32(packet))


def read_command(packet: bytes) -> tuple[int, int, int, float, bool] | None:
    """Kind, cycle, session key, command and whether the drive is to be powered; nothing if it is damaged or none of ours."""
    if len(packet) != 56 or zlib.crc32(packet[:52]) != struct.unpack_from("<I", packet, 52)[0]:
        return None
    magic, version, kind, cycle, session, _answers, command, enable = struct.unpack_from("<4sHHQQQdI", packet)
    if (magic, version) != (MAGIC, VERSION):
        return None
    return kind, cycle, session, command, bool(enable & 1)


def serve(port: int, loader_name: str = "elevator-2khz") -> None:
    """Answers every packet, without end."""
    machine = ff.live.Machine(BUILT_IN[loader_name]())
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as link:
        link.bind(("127.0.0.1", port))
        print(f"{loader_name} at 127.0.0.1:{link.getsockname()[1]}", flush=True)
        sequence, newest, sensors = 1, -1, machine.read()
        session, powered, heard_s = None, False, 0.0
        while True:
            packet, loop = link.recvfrom(64)
            if (read := read_command(packet)) is None:
                continue
            kind, cycle, key, command, enable = read
            now_s = time.monotonic()
            if key != session:
                if kind != ASK or (powered and now_s - heard_s < GONE_S):
                    continue  # forged, or of another loop than the one that runs
                session, newest = key, -1
            heard_s = now_s
            if kind == COMMAND and cycle <= newest:
                continue  # it comes late, or twice
            if kind == COMMAND:
                newest, powered = cycle, enable
                machine.write(command, enable)
                sequence, sensors = sequence + 1, machine.read()
            answers = newest if newest >= 0 else NO_CYCLE
            link.sendto(sample_packet(sequence, session, answers, sensors, acts=powered), loop)


if __name__ == "__main__":
    serve(int(sys.argv[1]) if len(sys.argv) > 1 else 5005, *sys.argv[2:3])
