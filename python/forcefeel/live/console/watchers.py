"""Watchers of a console, control, and the data sent to each.

The server never waits for a watcher. A frame that a watcher cannot take is lost. Of each kind of notice a watcher gets the newest
when it can take it.
"""

import asyncio
import json
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from itertools import count

from websockets.asyncio.server import ServerConnection, broadcast

from forcefeel.errors import InputError
from forcefeel.live.console.admission import Role
from forcefeel.units import Json

MOST = 32
"""Largest number of watchers."""

_EACH_SECOND, _AT_ONCE = 150.0, 300.0
"""Largest rate of a watcher's commands per second, and largest burst; a dragged hand sends 60 per second."""
_AGAIN = 1012
"""Close code of RFC 6455's registry: service restart."""
_MOST_REFUSED = 20
"""Invalid commands after which a watcher is disconnected."""


@dataclass(eq=False)
class Watcher:
    """A connected page or program.

    Attributes:
        connection: Its WebSocket.
        number: Number shown to other watchers.
        role: Its rights.
        seen: Version of the last sent notice of each kind.
        refused: Number of its invalid commands.
        outdated: Whether it was connected while the server was blocked and must reconnect.
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
        """Whether sent data is still in its buffer."""
        return self.connection.transport.get_write_buffer_size() > 0

    def floods(self) -> bool:
        """Count a command; return whether there are too many."""
        now = time.monotonic()
        self._left = min(_AT_ONCE, self._left + _EACH_SECOND * (now - self._at)) - 1
        self._at = now
        return self._left < 0

    def is_refused(self) -> bool:
        """Count an invalid command; return whether there are too many."""
        self.refused += 1
        return self.refused > _MOST_REFUSED


class Watchers:
    """All watchers, and the newest notice of each kind."""

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
        """Add a watcher; the first with the right gets control."""
        watcher = self._all[connection] = Watcher(connection, next(self._numbers), role)
        if self.holder is None and role is Role.CONTROL:
            self.holder = watcher
        return watcher

    def remove(self, watcher: Watcher) -> bool:
        """Remove a watcher; return whether this frees control."""
        self._all.pop(watcher.connection, None)
        return self.give(watcher)

    def turn_out(self) -> None:
        """Close all connections; the pages reconnect."""
        for watcher in self:
            watcher.outdated = True
            task = asyncio.ensure_future(watcher.connection.close(_AGAIN, "the console was blocked"))
            self._closing.add(task)
            task.add_done_callback(self._closing.discard)

    def take(self, watcher: Watcher) -> None:
        """Give control to a watcher.

        Raises:
            InputError: If the watcher has no right, or another one has control.
        """
        if watcher.role is not Role.CONTROL:
            raise InputError(
                "this address is only for watching; for control open the address that forcefeel run printed"
            )
        if self.holder not in (None, watcher):
            assert self.holder is not None
            raise InputError(f"watcher {self.holder.number} has control and can give it up; every watcher can stop")
        self.holder = watcher

    def give(self, watcher: Watcher) -> bool:
        """Take control from a watcher; return whether it had control."""
        held = self.holder is watcher
        if held:
            self.holder = None
        return held

    def post(self, kind: str, text: str) -> None:
        """Post a notice to all; it replaces the last of its kind."""
        if self._notices.get(kind, (0, ""))[1] != text:
            self._notices[kind] = next(self._versions), text

    def post_to(self, watcher: Watcher, notice: dict[str, Json]) -> None:
        """Send a notice to a new watcher, whose buffer is empty."""
        _send([watcher], json.dumps(notice, allow_nan=False))

    def send(self, frame: bytes | None) -> None:
        """Send a frame and missing notices to all watchers with an empty buffer."""
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
