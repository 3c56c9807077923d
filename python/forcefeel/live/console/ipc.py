"""Between a loop's process and that of its console: what a loop offers, asked for and answered over a socket.

A request is JSON, ``[name, arguments]`` of a method of ``_core.LiveLoop``; the answer JSON too, or of a history the rows that
follow in a later part, ``uint64``, then rows of ``float64``. Both are one message of a socket that keeps messages apart, and short
enough to find room in it: the loop's process never waits for a console that takes nothing. The console, which a network may
reach, can ask for nothing but what stands here.
"""

import json
import os
import socket
import struct
from threading import Lock
from typing import Any

import numpy as np
from numpy.typing import NDArray

from forcefeel.errors import InputError
from forcefeel.live.live_session import LiveSession
from forcefeel.live.state import COLUMNS

LAPSES_S = 0.5
"""A console that asks for nothing for so long is silent: what it holds of a simulated hand lets go."""

_LEFT = struct.Struct("<Q")
_ROWS = 256
"""Of a part of a history: some 64 kB."""
_ALL = 2**62
_LARGEST_BYTES = 1 << 17

_HAND = {"hold_at": None, "force": 0.0}
"""What the simulated hand may do, with the number by which it does so no more."""

_LOOKED_AT = ("status", "recorded", "host_status", "timing", "refused")
"""What is asked for without arguments, and changes nothing."""


def pair() -> tuple[socket.socket, socket.socket]:
    """The two ends of a wire."""
    return socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)


class LoopProxy:
    """A loop of another process, with the methods of ``_core.LiveLoop``; any thread may call them.

    Where the other end is closed there is no loop any more and nothing to serve: the process ends at once.

    Args:
        wire: This end.
    """

    def __init__(self, wire: socket.socket) -> None:
        self._wire, self._lock = wire, Lock()

    def request(self, name: str, numbers: list[float]) -> bool:
        """Asks something of the loop; whether there was room for it."""
        return bool(self._query("request", name, numbers))

    def disturb(self, name: str, sensor: int = 0, number: float | None = None) -> bool:
        """Does something to a simulated machine; whether there was room for it."""
        return bool(self._query("disturb", name, sensor, number))

    def status(self) -> Any:
        """As of the loop; so are the next ones."""
        return self._query("status")

    def recorded(self) -> Any:
        """See there."""
        return self._query("recorded")

    def host_status(self) -> Any:
        """See there."""
        return self._query("host_status")

    def timing(self) -> Any:
        """See there."""
        return self._query("timing")

    def refused(self) -> Any:
        """See there."""
        return self._query("refused")

    def history(self, since: float, most: int) -> NDArray[np.float64]:
        """The newest ``most`` rows of cycles after ``since``, part after part."""
        parts, cycle = [], COLUMNS.index("cycle")
        while True:
            answer = self._answer("history", since, most)
            (most,) = _LEFT.unpack_from(answer)
            rows = np.frombuffer(answer, np.float64, offset=_LEFT.size).reshape(-1, len(COLUMNS))
            parts.append(rows)
            if not most:
                return np.concatenate(parts)
            # All after it: of the newest so many some would be newer by now, and others left out.
            since, most = float(rows[-1, cycle]), _ALL

    def end(self) -> None:
        """Nothing: the loop is its own process's to end."""

    def _query(self, name: str, *arguments: object) -> Any:
        answer = json.loads(self._answer(name, *arguments))
        if isinstance(answer, dict):
            raise InputError(answer["refused"])
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


class LoopServer:
    """The loop's end of the wire.

    Args:
        running: The loop.
        wire: This end.
    """

    def __init__(self, running: LiveSession, wire: socket.socket) -> None:
        self._running, self._wire = running, wire
        self._held: set[str] = set()
        wire.settimeout(LAPSES_S)

    def until_gone(self) -> None:
        """Answers until the other end is closed; lets the hand go when that is silent, or gone."""
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
            # Whatever was wrong with what it asked: who answers the next one must not end by it.
            return json.dumps({"refused": str(error)}).encode()

    def _execute(self, name: str, arguments: list[Any]) -> object:
        if name == "request":
            return self._running.take_request(*arguments)
        if name == "disturb":
            what, _, number = arguments
            if what in _HAND and number != _HAND[what]:
                self._held.add(what)
            return self._running.take_disturbance(*arguments)
        if name in _LOOKED_AT:
            return getattr(self._running.loop, name)()
        raise InputError(f"request: expected request, disturb, history or {', '.join(_LOOKED_AT)}, got {name!r}")

    def _part(self, since: float, most: int) -> bytes:
        rows = self._running.loop.history(since, most)
        return _LEFT.pack(max(0, len(rows) - _ROWS)) + rows[:_ROWS].tobytes()

    def _let_go(self) -> None:
        self._held -= {what for what in self._held if self._running.take_disturbance(what, 0, _HAND[what])}
