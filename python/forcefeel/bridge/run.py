"""A bridge between a simulator and a running loader."""

import socket
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass

from forcefeel._core import host_answer, host_numbers, host_packet, host_switches, live_states
from forcefeel.bridge.simulator import Simulator, SimulatorState

RATE_HZ = 60.0
"""How often a packet is sent at most."""

REFUSED = 1 << 16
"""Bit of the loader's status: it cannot render the spring or damping of the last packet."""

_SWITCHES = host_switches()
_RANGES = {name: (low, high) for name, _, low, high, _ in host_numbers()}
_LOOKS_S = 0.002


@dataclass
class BridgeReport:
    """What a bridge did.

    Attributes:
        states: States that came from the simulator.
        answers: Packets that came from the loader.
        refused: Whether the loader refused the last one: its spring or damping is more than the loader renders.
        loader_state: The loader's last state, one of ``live.STATES``; empty before its first answer.
        angle_rad: The control's last angle.

    Example:
        >>> ff.bridge.BridgeReport().answers
        0
    """

    states: int = 0
    answers: int = 0
    refused: bool = False
    loader_state: str = ""
    angle_rad: float = 0.0


@dataclass(frozen=True)
class BridgeSettings:
    """What a bridge is told of control and aircraft.

    Attributes:
        travel_rad: Angle of the control at which the aircraft's is at 1.
        tab_rad: Angle of the trim tab at which the simulator's trim is at 1.
        jam_n: Force at the grip that breaks a jam.

    Example:
        >>> ff.bridge.BridgeSettings(travel_rad=0.25).jam_n
        400.0
    """

    travel_rad: float
    tab_rad: float = 0.35
    jam_n: float = 400.0


def bridge(
    simulator: Simulator,
    loader: tuple[str, int],
    settings: BridgeSettings,
    ended: Callable[[], bool],
    report: BridgeReport | None = None,
) -> BridgeReport:
    """Passes the flight on to the loader and the control's angle back, until ``ended`` says so.

    A simulator that is silent sends nothing on: the loader fades to its own feel by itself, as after any host.

    Args:
        simulator: The simulator.
        loader: Address of the loader's host port.
        settings: Travels and forces.
        ended: Asked about 500 times a second.
        report: Where it is reported as it happens; by default a new report.

    Example:
        >>> simulator = ff.bridge.Text(("127.0.0.1", 0))
        >>> ff.bridge.bridge(simulator, ("127.0.0.1", 9), ff.bridge.BridgeSettings(0.25), lambda: True).states
        0
    """
    report = BridgeReport() if report is None else report
    states, next_s, state = live_states(), 0.0, None
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as wire:
        wire.setblocking(False)
        wire.connect(loader)
        try:
            while not ended():
                state = simulator.receive() or state
                now = time.monotonic()
                if state is not None and now >= next_s:
                    report.states += 1
                    next_s = now + 1 / RATE_HZ
                    with suppress(OSError):  # no loader there yet
                        wire.send(packet_of(report.states, state, settings))
                    state = None
                with suppress(OSError):
                    while (answer := host_answer(wire.recv(64))) is not None:
                        _, status, numbers = answer
                        report.answers += 1
                        report.refused = bool(status & REFUSED)
                        report.loader_state, report.angle_rad = states[status & 0xFF], numbers[0]
                        simulator.move(report.angle_rad / settings.travel_rad)
                time.sleep(_LOOKS_S)
        finally:
            simulator.close()
    return report


def packet_of(sequence: int, state: SimulatorState, settings: BridgeSettings) -> bytes:
    """The packet of a state; a number beyond the packet's range is held at it."""
    numbers = dict(state.numbers)
    numbers["tab"] = settings.tab_rad * numbers.get("tab", 0.0)
    numbers["shaker"] = float(state.shaken)
    if state.jammed:
        numbers["jam_force"] = settings.jam_n
    within = {name: min(_RANGES[name][1], max(_RANGES[name][0], value)) for name, value in numbers.items()}
    on = ("active", "flight", *("freeze",) * state.frozen, *("jam",) * state.jammed)
    return host_packet(sequence, sum(_SWITCHES[name] for name in on), within)
