"""A million mutated packets of each protocol that a simulator speaks: FFH2, X-Plane's RREF, lines of text.

    python benchmarks/packets.py [packets]

A packet has one to four of its bytes replaced, and three in ten are cut short. Those of FFH2 go to a supervised loop of
``elevator-2khz`` under ``robust``, one in each cycle, half of them with a checksum that is right again.

It fails on an error, a state that no loader takes, a number of the loop that is not finite, or a loop that its supervisor stops, as
for a step of force beyond ``force_rate``.
"""

import socket
import sys
import time
import zlib
from collections.abc import Callable

import numpy as np

import forcefeel as ff
from forcefeel import _core
from forcefeel.bridge.run import packet_of
from forcefeel.live.setup import live_law, made_of
from forcefeel.live.state import COLUMNS, STATES

PACKETS, PIECE, SEED = 1_000_000, 10_000, 35


def mutated(packets: list[bytes], random: np.random.Generator) -> list[bytes]:
    """The packets, each changed."""
    rows = np.array([np.frombuffer(packet, np.uint8) for packet in packets])
    count, size = rows.shape
    for k in range(4):
        changed = np.flatnonzero(random.random(count) < 1 / (k + 1))
        rows[changed, random.integers(0, size, len(changed))] = random.integers(0, 256, len(changed))
    lengths = np.where(random.random(count) < 0.3, random.integers(1, size + 1, count), size)
    return [row[:length].tobytes() for row, length in zip(rows, lengths, strict=True)]


def send(name: str, packet: Callable[[int], bytes], take: Callable[[bytes], bool], packets: int) -> None:
    """Sends mutated packets, and prints how many were taken."""
    random, taken, begin = np.random.default_rng(SEED), 0, time.perf_counter()
    for first in range(0, packets, PIECE):
        for given in mutated([packet(k) for k in range(first, min(first + PIECE, packets))], random):
            taken += take(given)
    print(f"{name}: {packets} packets, {taken} taken, {time.perf_counter() - begin:.0f} s")


def check_loop(packets: int) -> None:
    """FFH2, to a loop: a flight state, a force, spring and damping beside the feel."""
    loader = ff.digital_elevator()
    loop = _core.LockStep(made_of(loader, live_law("robust", loader), host=True)[0])
    loop.request("on", [])
    loop.run(round(3.0 / loader["controller.period"]), None)
    switches = sum(_core.host_switches()[name] for name in ("active", "flight"))
    numbers = {"added_force": 20.0, "added_stiffness": 20.0, "added_damping": 2.0, "load_factor": 1.1}
    state = COLUMNS.index("state")

    def take(given: bytes) -> bool:
        if given[-1] % 2:
            given = given[:-4] + zlib.crc32(given[:-4]).to_bytes(4, "little")
        known = _core.host_request(given) is not None
        row = loop.run(1, given if known else None)[-1]
        if not np.isfinite(row).all() or STATES[int(row[state])] == "tripped":
            raise SystemExit(f"FFH2: after {given.hex()}: {dict(zip(COLUMNS, row.tolist(), strict=True))}")
        return known

    send("FFH2", lambda k: _core.host_packet(k, switches, numbers), take, packets)


def check_bridges(packets: int) -> None:
    """RREF and lines of text, over UDP, to packets that a loader takes."""
    settings = ff.bridge.BridgeSettings(travel_rad=0.25, tab_rad=0.4)
    body = b"RREF," + b"".join(np.int32(k).tobytes() + np.float32(k).tobytes() for k in range(13))
    line = b"dynamic_pressure=1500 true_airspeed=50.0 angle_of_attack=0.07 load_factor=1.1 frozen=0\n"
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as wire:
        wire.bind(("127.0.0.1", 0))
        x_plane = ff.bridge.XPlane(wire.getsockname(), ff.bridge.Axis.PITCH)
        text = ff.bridge.Text(("127.0.0.1", 0))
        x_plane.receive()
        _, asks = wire.recvfrom(1024)

        def taken(bridge: ff.bridge.XPlane | ff.bridge.Text, to: tuple[str, int], given: bytes) -> bool:
            wire.sendto(given, to)
            state = bridge.receive()
            if state is not None and _core.host_request(packet_of(1, state, settings)) is None:
                raise SystemExit(f"a state that no loader takes: {state}, after {given.hex()}")
            return state is not None

        wire.sendto(body, asks)
        send("X-Plane", lambda _: body, lambda given: taken(x_plane, asks, given), packets)
        send("text", lambda _: line, lambda given: taken(text, ("127.0.0.1", text.port), given), packets)
        x_plane.close()
        text.close()


def main() -> None:
    packets = int(sys.argv[1]) if len(sys.argv) > 1 else PACKETS
    check_loop(packets)
    check_bridges(packets)


if __name__ == "__main__":
    main()
