"""Foreign clients of a bus: the maker's own drives the emulated node, and writes what our driver writes."""

import asyncio
import math
import os
import select
import struct
import time
import tty
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import replace

import pytest

import forcefeel as ff
from tests.live.bus_wire import tapped
from tests.live.test_bus import yoke
from tests.parametrization import mostly_slow

moteus, can = pytest.importorskip("moteus"), pytest.importorskip("can")

HEARTBEAT, SET_STATE, ESTIMATES, SET_MODE, SET_TORQUE = 0x01, 0x07, 0x09, 0x0B, 0x0E
"""Messages of CANSimple, by the maker's documents."""

UNHURRIED_S = 1.0
"""Watchdog of a drive whose client runs beside other tests."""

PADDING = 0x50
FIRST_SOURCE, SOURCES = 96, 16


def test_makers_client_drives_the_emulated_moteus_until_its_watchdog():
    async def drive(port):
        transport = moteus.Fdcanusb(port)
        drive = moteus.Controller(id=1, transport=transport)
        try:
            states = [await drive.set_stop(query=True)]
            for _ in range(50):
                states.append(await drive.set_position(**torque(0.5, UNHURRIED_S), query=True))
                await asyncio.sleep(0.002)
            await asyncio.sleep(2 * UNHURRIED_S)
            states.append(await drive.query())
            states.append(await drive.set_position(**torque(0.5, UNHURRIED_S), query=True))
            states.append(await drive.set_stop(query=True))
            return [state.values for state in states]
        finally:
            transport.close()

    with ff.live.BusEmulator([yoke(node=1, watchdog_s=UNHURRIED_S)]) as emulator, ThreadPoolExecutor(1) as thread:
        states = thread.submit(asyncio.run, drive(emulator.port)).result()
    register = moteus.Register
    assert [states[k][register.MODE] for k in (0, 1, -3, -2, -1)] == [0, 10, 11, 11, 0]
    assert states[50][register.TORQUE] == pytest.approx(0.5, rel=1e-6)  # 32 bits
    assert states[50][register.POSITION] > states[1][register.POSITION] + 1e-3


def torque(value, watchdog_s):
    return {
        "position": math.nan,
        "velocity": 0.0,
        "kp_scale": 0.0,
        "kd_scale": 0.0,
        "ilimit_scale": 0.0,
        "feedforward_torque": value,
        "watchdog_timeout": watchdog_s,
    }


def test_driver_writes_the_frames_of_the_makers_client():
    loader = yoke(node=7)
    with ff.live.BusEmulator([loader], real_time=False) as emulator, tapped(emulator.port) as (port, lines):
        bus = replace(loader.bus, port=port)
        with ff.live.start(loader, "robust", endpoint=bus, real_time=False) as session:
            session.on()
            session.wait(1500)
            emulator.push(5.0)
            session.wait(500)
            session.off()
            session.wait(500)
    register, resolution = moteus.Register, moteus.multiplex
    asked = moteus.QueryResolution()
    asked.voltage = asked.temperature = resolution.IGNORE
    asked._extra = {register.ENCODER_1_POSITION: resolution.F32, register.AUX2_ANALOG_IN1: resolution.F32}
    asked._extra[register.MILLISECOND_COUNTER] = resolution.INT32
    client = moteus.Controller(id=7, query_resolution=asked, position_resolution=all_floats())
    sent = [line.split() for line in lines if line.startswith(b"can send")]
    exchanges = [words for words in sent if int(words[2], 16) >> 8 & 0x7F < FIRST_SOURCE + SOURCES]
    assert len(exchanges) > 2400
    enabled = 0
    for cycle, (_, _, number, data, *_) in enumerate(exchanges):
        assert int(number, 16) == 0x8000 | (FIRST_SOURCE + cycle % SOURCES) << 8 | 7
        frame = bytes.fromhex(data.decode())
        written = written_registers(frame)
        if written[register.MODE] == 10:
            enabled += 1
            value = written[register.COMMAND_FEEDFORWARD_TORQUE]
            expected = client.make_position(**torque(value, 0.1), query=True).data
        else:
            expected = client.make_stop(query=True).data
        assert frame.rstrip(bytes([PADDING])) == expected.rstrip(bytes([PADDING]))
    assert enabled > 1000


@contextmanager
def slcan(port):
    bus = can.Bus(interface="slcan", channel=port, bitrate=1_000_000, sleep_after_open=0.05)
    try:
        yield bus
    finally:
        bus.shutdown()


def received(bus, number, timeout_s=5.0):
    """The next frame of this number."""
    end = time.monotonic() + timeout_s
    while time.monotonic() < end:
        message = bus.recv(0.1)
        if message is not None and message.arbitration_id == number:
            return bytes(message.data)
    raise AssertionError(f"no frame {number:#x}")


@pytest.mark.parametrize(("kind", "expired"), [("odrive", 1 << 24), ("odrive-0.5", 1 << 11)])
def test_python_can_drives_the_emulated_odrive_until_its_watchdog(kind, expired):
    node = 5
    with ff.live.BusEmulator([yoke(kind, node=node, watchdog_s=UNHURRIED_S)]) as emulator, slcan(emulator.port) as bus:

        def write(command, data):
            bus.send(can.Message(arbitration_id=node << 5 | command, data=data, is_extended_id=False))

        def ask(command):
            bus.send(can.Message(arbitration_id=node << 5 | command, is_remote_frame=True, dlc=8, is_extended_id=False))
            return received(bus, node << 5 | command)

        before, _ = struct.unpack("<ff", ask(ESTIMATES))
        write(SET_MODE, struct.pack("<II", 1, 1))
        write(SET_STATE, struct.pack("<I", 8))
        for _ in range(30):
            write(SET_TORQUE, struct.pack("<f", 0.5))
            after, velocity = struct.unpack("<ff", ask(ESTIMATES))
            time.sleep(0.002)
        assert after > before + 1e-4
        assert velocity > 0
        time.sleep(2 * UNHURRIED_S)
        while bus.recv(0) is not None:
            pass
        error, state = struct.unpack_from("<IB", received(bus, node << 5 | HEARTBEAT))
        assert (error, state) == (expired, 1)
        write(SET_STATE, struct.pack("<I", 8))  # refused until errors are cleared
        assert emulator.commands == [0.0]


@pytest.mark.parametrize("kind", mostly_slow(["odrive", "odrive-0.5"]))
def test_driver_writes_can_simple_as_python_can_does(kind):
    """Each line of our driver is that of python-can for the message of the maker's documents with the same content."""
    node, loader = 5, yoke(kind, node=5)
    with (
        ff.live.BusEmulator([loader], real_time=False) as emulator,
        tapped(emulator.port) as (port, lines),
        ff.live.start(loader, "robust", endpoint=replace(loader.bus, port=port), real_time=False) as session,
    ):
        session.on()
        session.wait(2000)
    ours = [line for line in lines if line[:1] in b"tTrR" and line]
    messages = read_by_python_can(ours)
    commands = [message.arbitration_id & 0x1F for message in messages if message.arbitration_id >> 5 == node]
    first = commands.index(SET_MODE)
    assert bytes(next(m for m in messages if m.arbitration_id == node << 5 | SET_MODE).data) == struct.pack("<II", 1, 1)
    assert commands[first : first + 4] == [SET_MODE, SET_STATE, SET_TORQUE, ESTIMATES]
    torques = [m for m in messages if m.arbitration_id == node << 5 | SET_TORQUE]
    assert len(torques) > 1900
    assert any(struct.unpack("<f", m.data)[0] != 0.0 for m in torques)
    assert all(m.is_remote_frame for m in messages if m.arbitration_id in (node << 5 | ESTIMATES, 0x700 | node))


def read_by_python_can(lines):
    """Lines as python-can's own adapter reads them, which writes the same lines again."""
    near, far = os.openpty()
    tty.setraw(near)
    bus = can.Bus(interface="slcan", channel=os.ttyname(far), bitrate=1_000_000, sleep_after_open=0.05)
    messages = []
    try:
        while select.select([near], [], [], 0.05)[0]:
            os.read(near, 4096)
        for line in lines:
            os.write(near, line + b"\r")
            messages.append(bus.recv(2.0))
            bus.send(messages[-1])
            assert os.read(near, 4096).rstrip(b"\r") == line
        return messages
    finally:
        bus.shutdown()
        os.close(near)
        os.close(far)


def all_floats():
    """The client's own resolutions of a command, those of 32-bit floats."""
    made = moteus.PositionResolution()
    for name in vars(type(made)):
        if not name.startswith("_") and isinstance(getattr(made, name), int):
            setattr(made, name, moteus.multiplex.F32)
    return made


def written_registers(frame):
    """Registers that a frame writes."""
    sizes, place, written = {0: (1, "b"), 1: (2, "h"), 2: (4, "i"), 3: (4, "f")}, 0, {}
    while frame[place] < 0x10:
        size, kind = sizes[frame[place] >> 2 & 3]
        count, place = frame[place] & 3, place + 1
        if count == 0:
            count, place = frame[place], place + 1
        first, place = frame[place], place + 1
        for k in range(count):
            (written[first + k],) = struct.unpack_from(f"<{kind}", frame, place)
            place += size
    return written
