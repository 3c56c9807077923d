"""Who looks on, who holds control, and what each has been sent.

Nobody waits for a watcher. What is sent is of two sorts: frames, of which one that is not taken is lost; and notices, of which each
kind has one, the newest, that a watcher gets when it can take it.
"""

import asyncio
import json
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from itertools import count

from websockets.asyncio.server import ServerConnection, broadcast

from forcefeel.errors import InputError
from forcefeel.json_values import Json
from forcefeel.live.console.admission import Role

MOST = 32
"""Watchers."""

_EACH_SECOND, _AT_ONCE = 150.0, 300.0
"""Commands of one watcher, each second and at once; a hand that is dragged sends sixty a second."""
_AGAIN = 1012
"""RFC 6455's registry of close codes: the service begins anew."""
_MOST_REFUSED = 20
"""Commands of one watcher that are none, after which it is turned out."""


@dataclass(eq=False)
class Watcher:
    """A page, or a program.

    Attributes:
        connection: Its WebSocket.
        number: What the others call it.
        role: What it may.
        seen: Version of each kind of notice that it was sent.
        refused: Commands of it that were none.
        outdated: Whether it was there when the server was held up, and has to come again.
    """

    connection: ServerConnection
    number: int
    role: Role
    seen: dict[str, int] = field(default_factory=dict)
    refused: int = 0
    outdated: bool = False
    _left: float = _AT_ONCE
    _at: float = field(default_factory=time.monotonic)

    @property
    def behind(self) -> bool:
        """Whether it has yet to take what it was sent."""
        return self.connection.transport.get_write_buffer_size() > 0

    def floods(self) -> bool:
        """Counts a command, and tells whether they are too many."""
        now = time.monotonic()
        self._left = min(_AT_ONCE, self._left + _EACH_SECOND * (now - self._at)) - 1
        self._at = now
        return self._left < 0

    def is_refused(self) -> bool:
        """Counts a command that is none, and tells whether they are too many."""
        self.refused += 1
        return self.refused > _MOST_REFUSED


class Watchers:
    """All of them, and the newest notice of each kind."""

    def __init__(self) -> None:
        self._all: dict[ServerConnection, Watcher] = {}
        self._numbers = count(1)
        self._versions = count(1)
        self._notices: dict[str, tuple[int, str]] = {}
        self._closing: set[asyncio.Future[None]] = set()
        self.holder: Watcher | None = None

    def __iter__(self) -> Iterator[Watcher]:
        return iter(self._all.values())

    def __len__(self) -> int:
        return len(self._all)

    def add(self, connection: ServerConnection, role: Role) -> Watcher:
        """Who came; the first who may holds control."""
        watcher = self._all[connection] = Watcher(connection, next(self._numbers), role)
        if self.holder is None and role is Role.CONTROL:
            self.holder = watcher
        return watcher

    def remove(self, watcher: Watcher) -> bool:
        """Who went; tells whether control is free by that."""
        self._all.pop(watcher.connection, None)
        return self.give(watcher)

    def turn_out(self) -> None:
        """Ends the connections of all; their pages open others."""
        for watcher in self:
            watcher.outdated = True
            task = asyncio.ensure_future(watcher.connection.close(_AGAIN, "the console was held up"))
            self._closing.add(task)
            task.add_done_callback(self._closing.discard)

    def take(self, watcher: Watcher) -> None:
        """Gives control to a watcher.

        Raises:
            InputError: If it may not have it, or another holds it.
        """
        if watcher.role is not Role.CONTROL:
            raise InputError("this address is for watching; open the one that forcefeel run printed for control")
        if self.holder not in (None, watcher):
            assert self.holder is not None
            raise InputError(f"watcher {self.holder.number} holds control; it can give it up, anyone can stop")
        self.holder = watcher

    def give(self, watcher: Watcher) -> bool:
        """Takes control from a watcher; tells whether it held it."""
        held = self.holder is watcher
        if held:
            self.holder = None
        return held

    def post(self, kind: str, text: str) -> None:
        """A notice for all, in place of the last of its kind."""
        if self._notices.get(kind, (0, ""))[1] != text:
            self._notices[kind] = next(self._versions), text

    def post_to(self, watcher: Watcher, notice: dict[str, Json]) -> None:
        """A notice for one who has just come, whose buffer is empty."""
        _send([watcher], json.dumps(notice, allow_nan=False))

    def send(self, frame: bytes | None) -> None:
        """A frame and what notices each lacks, to all who can take them."""
        ready = [watcher for watcher in self if not watcher.behind]
        if frame is not None:
            _send(ready, frame)
        for kind, (version, text) in self._notices.items():
            lack = [watcher for watcher in ready if watcher.seen.get(kind) != version]
            _send(lack, text)
            for watcher in lack:
                watcher.seen[kind] = version


def _send(to: Iterable[Watcher], message: str | bytes) -> None:
    broadcast([watcher.connection for watcher in to], message)
