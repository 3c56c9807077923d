"""Communication between the processes of a loop and its console over a socket.

A request is JSON, ``[name, arguments]`` of a method of ``_core.LiveLoop``. The answer is JSON too; that of a history is the number
of remaining rows, ``uint64``, then rows of ``float64``. Each is one message of a sequenced-packet socket and short enough for its
buffer, so the loop's process never waits for the console. The console, which may be on a network, has only these requests.
"""

import json
import os
import socket
import struct
from collections.abc import Mapping
from threading import Lock
from typing import Any

import numpy as np
from numpy.typing import NDArray

from forcefeel.errors import InputError
from forcefeel.live.flight_controls import Lever
from forcefeel.live.live_session import LiveSession
from forcefeel.live.state import COLUMNS

LAPSES_S = 0.5
"""A console without requests for this long is silent; its simulated hand is released."""

_LEFT = struct.Struct("<Q")
_ROWS = 256
"""Rows in a message of a history: some 64 kB."""
_ALL = 2**62
_LARGEST_BYTES = 1 << 17

_HAND = {"hold_at": None, "force": 0.0}
"""Inputs of the simulated hand, with their released value."""

_LOOKED_AT = ("status", "recorded", "host_status", "timing", "refused")
"""Read-only requests without arguments."""


_ERROR = "input error"
"""Key of an answer that refuses a request; no result has it."""

_OF_FLIGHT = ("readings", "set_lever", "restart")
"""Requests to the flight."""


def pair() -> tuple[socket.socket, socket.socket]:
    """A connected pair of sockets."""
    return socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)


class LoopProxy:
    """Proxy of a loop in another process, with the methods of ``_core.LiveLoop``; thread-safe.

    If the other end closes, the loop is gone and this process exits.

    Args:
        wire: Socket of this end.
    """

    def __init__(self, wire: socket.socket) -> None:
        self._wire, self._lock = wire, Lock()

    def request(self, name: str, numbers: list[float]) -> bool:
        """Send a request; return whether the ring had space."""
        return bool(self._query("request", name, numbers))

    def disturb(self, name: str, sensor: int = 0, number: float | None = None) -> bool:
        """Send an input to a simulated machine; return whether the ring had space."""
        return bool(self._query("disturb", name, sensor, number))

    def status(self) -> Any:
        """As ``Loop.status``."""
        return self._query("status")

    def recorded(self) -> Any:
        """As ``Loop.recorded``."""
        return self._query("recorded")

    def host_status(self) -> Any:
        """As ``Loop.host_status``."""
        return self._query("host_status")

    def timing(self) -> Any:
        """As ``Loop.timing``."""
        return self._query("timing")

    def refused(self) -> Any:
        """As ``Loop.refused``."""
        return self._query("refused")

    def history(self, since: float, most: int) -> NDArray[np.float64]:
        """The newest ``most`` rows of cycles after ``since``, in several messages."""
        parts, cycle = [], COLUMNS.index("cycle")
        while True:
            answer = self._answer("history", since, most)
            (most,) = _LEFT.unpack_from(answer)
            rows = np.frombuffer(answer, np.float64, offset=_LEFT.size).reshape(-1, len(COLUMNS))
            parts.append(rows)
            if not most:
                return np.concatenate(parts)
            # Request all later rows: a limit would now select newer rows and skip others.
            since, most = float(rows[-1, cycle]), _ALL

    def flight(self, what: str, *arguments: object) -> Any:
        """A method of the flight beside the loop."""
        return self._query("flight", what, *arguments)

    def end(self) -> None:
        """Do nothing: only the loop's own process ends it."""

    def _query(self, name: str, *arguments: object) -> Any:
        answer = json.loads(self._answer(name, *arguments))
        if isinstance(answer, dict) and _ERROR in answer:
            raise InputError(answer[_ERROR])
        return answer

    def _answer(self, name: str, *arguments: object) -> bytes:
        with self._lock:
            try:
                self._wire.send(json.dumps([name, arguments]).encode())
                answer = self._wire.recv(_LARGEST_BYTES)
            except OSError:
                answer = b""
        if not answer:
            os._exit(0)
        return answer


class FlightProxy:
    """Proxy of the flight beside a loop in another process.

    Args:
        loop: The loop's proxy.
        levers: The flight's levers.
    """

    def __init__(self, loop: LoopProxy, levers: Mapping[str, Lever]) -> None:
        self._loop, self.levers = loop, levers

    def readings(self) -> dict[str, float]:
        """As ``FlightControls.readings``."""
        readings: dict[str, float] = self._loop.flight("readings")
        return readings

    def set_lever(self, name: str, position: float) -> None:
        """As ``FlightControls.set_lever``."""
        self._loop.flight("set_lever", name, position)

    def restart(self) -> None:
        """As ``FlightControls.restart``."""
        self._loop.flight("restart")


class LoopServer:
    """Server at the loop's end of the socket.

    Args:
        running: The loop.
        wire: Socket of this end.
    """

    def __init__(self, running: LiveSession, wire: socket.socket) -> None:
        self._running, self._wire = running, wire
        self._held: set[str] = set()
        wire.settimeout(LAPSES_S)

    def until_gone(self) -> None:
        """Answer until the other end closes; release the hand if that is silent or closed."""
        while True:
            try:
                request = self._wire.recv(_LARGEST_BYTES)
                if not request:
                    break
                self._wire.send(self._answer(*json.loads(request)))
            except TimeoutError:
                self._let_go()
            except OSError:
                break
        self._let_go()

    def _answer(self, name: str, arguments: list[Any]) -> bytes:
        try:
            if name == "history":
                return self._part(*arguments)
            return json.dumps(self._execute(name, arguments)).encode()
        except Exception as error:
            # An invalid request must not end this server.
            return json.dumps({_ERROR: str(error)}).encode()

    def _execute(self, name: str, arguments: list[Any]) -> object:
        if name == "request":
            return self._running.take_request(*arguments)
        if name == "disturb":
            what, _, number = arguments
            if what in _HAND and number != _HAND[what]:
                self._held.add(what)
            return self._running.take_disturbance(*arguments)
        if name == "flight" and self._running.flight is not None and arguments[0] in _OF_FLIGHT:
            return getattr(self._running.flight, arguments[0])(*arguments[1:])
        if name in _LOOKED_AT:
            return getattr(self._running.loop, name)()
        raise InputError(f"request: expected request, disturb, history or {', '.join(_LOOKED_AT)}, got {name!r}")

    def _part(self, since: float, most: int) -> bytes:
        rows = self._running.loop.history(since, most)
        return _LEFT.pack(max(0, len(rows) - _ROWS)) + rows[:_ROWS].tobytes()

    def _let_go(self) -> None:
        self._held -= {what for what in self._held if self._running.take_disturbance(what, 0, _HAND[what])}
