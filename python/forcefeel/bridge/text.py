"""Simulators that send lines of text over UDP: FlightGear by its generic protocol, DCS by a script.

A line has ``name=value`` pairs between blanks, by the names of a host's packet in SI units, and ``frozen``, ``jammed``, ``shaken``
as 0 or 1: ``dynamic_pressure=1500 true_airspeed=50 angle_of_attack=0.07``. The answer is a line with the control's share of its
travel, -1 to 1.
"""

import socket
from contextlib import suppress
from math import isfinite

from forcefeel._core import host_numbers
from forcefeel.bridge.simulator import SimulatorState

PORT = 49010
_SWITCHES = ("frozen", "jammed", "shaken")
_NEEDED = ("dynamic_pressure", "true_airspeed")
_LONGEST = 2048


class Text:
    """A simulator that sends lines to an address of ours, and is answered where it sent them from, or at another.

    Raises:
        OSError: If it cannot listen at the address.

    Example:
        >>> text = ff.bridge.Text(("127.0.0.1", 0))
        >>> text.receive() is None
        True
        >>> text.close()
    """

    def __init__(self, listens: tuple[str, int], answers: tuple[str, int] | None = None) -> None:
        self._wire = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self._wire.bind(listens)
        except OSError:
            self._wire.close()
            raise
        self._wire.setblocking(False)
        self._answers = answers
        self._to = answers
        self._known = {name for name, *_ in host_numbers()}

    @property
    def port(self) -> int:
        """The port at which lines arrive."""
        port: int = self._wire.getsockname()[1]
        return port

    def receive(self) -> SimulatorState | None:
        """The newest line that is good."""
        newest = None
        with suppress(BlockingIOError, ConnectionRefusedError):
            while True:
                packet, sender = self._wire.recvfrom(_LONGEST)
                state = self._state(packet)
                if state is not None:
                    newest, self._to = state, self._answers or sender
        return newest

    def move(self, share: float) -> None:
        """Answers the last sender."""
        if self._to is not None:
            with suppress(OSError):  # nobody listens there
                self._wire.sendto(f"{min(1.0, max(-1.0, share)):.6f}\n".encode(), self._to)

    def close(self) -> None:
        """Closes the socket."""
        self._wire.close()

    def _state(self, packet: bytes) -> SimulatorState | None:
        """The state of a line; ``None`` if it is not text, lacks a number, or has one that is unknown or not finite."""
        try:
            pairs = [pair.partition("=") for pair in packet.decode("ascii").split()]
            values = {name: float(value) for name, _, value in pairs}
        except ValueError:
            return None
        switches = {name: values.pop(name, 0.0) != 0 for name in _SWITCHES}
        if (
            not self._known.issuperset(values)
            or not set(_NEEDED) <= set(values)
            or not all(map(isfinite, values.values()))
        ):
            return None
        return SimulatorState(values, **switches)
