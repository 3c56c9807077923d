"""Server of the console: the page's files over HTTP, frames and commands over a WebSocket, in its own thread.

A single loader has its page at ``/`` and its WebSocket at ``/live``. The axes of a cockpit have theirs at ``/axis/NAME/`` and
``/axis/NAME/live``; ``/`` is the page that shows all of them, ``/axes.json`` their names.
"""

import asyncio
import json
import logging
import socket
import threading
import time
from collections.abc import Callable, Mapping
from contextlib import AsyncExitStack
from http import HTTPStatus
from types import TracebackType
from typing import Any, Self
from urllib.parse import urlsplit

from websockets.asyncio.server import ServerConnection, serve
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response

from forcefeel.errors import InputError
from forcefeel.live.console.admission import Refused, Role
from forcefeel.live.console.commands import LARGEST_BYTES, command_of
from forcefeel.live.console.files import answer, page_files
from forcefeel.live.console.listener import DEFAULT_PORT, Listener
from forcefeel.live.console.session import ConsoleSession
from forcefeel.live.console.telemetry import RATE_HZ
from forcefeel.live.console.watchers import MOST, Watcher, Watchers
from forcefeel.live.live_session import LiveSession
from forcefeel.qualification.plan.run import QualificationSetup

SOCKET = "live"

_SEND_BYTES = 32768
"""Send buffer of a watcher: one or two seconds of frames."""
_ASKED_EVERY_S, _ANSWER_WITHIN_S = 5.0, 10.0
"""A watcher that does not answer a ping is disconnected and loses control."""
_PATIENCE_S = 5.0
"""Timeout for a request, for closing, and for the thread's start and end."""

_LOG = logging.getLogger("forcefeel.live.console")
_LOG.addHandler(logging.NullHandler())
_LOG.propagate = False  # bad requests must not fill the terminal


class Server:
    """The server of a running loop, a context manager that ends the server, not the loop.

    Args:
        axes: The running axes by name; the name of a single loader is empty.
        door: Socket and access control.
        setup: Rule of the tests, and displayed units.
    """

    def __init__(self, axes: Mapping[str, LiveSession], door: Listener, setup: QualificationSetup) -> None:
        self.door, self.admission = door, door.admission
        self._desks = {
            f"/axis/{axis}/" if axis else "/": ConsoleSession(running, setup, Watchers())
            for axis, running in axes.items()
        }
        self._files = page_files(tuple(axes))
        self._thread = threading.Thread(target=self._run, name="forcefeel console", daemon=True)
        self._ready, self._end = threading.Event(), asyncio.Event()
        self._loop: asyncio.AbstractEventLoop | None = None

    def __enter__(self) -> Self:
        """Start to listen."""
        self._thread.start()
        self._ready.wait(_PATIENCE_S)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, where: TracebackType | None
    ) -> None:
        """Close all connections."""
        if self._loop is not None and self._thread.is_alive():
            self._loop.call_soon_threadsafe(self._end.set)
            self._thread.join(_PATIENCE_S)

    @property
    def serves(self) -> bool:
        """Whether the server is running."""
        return self._thread.is_alive()

    def _run(self) -> None:
        asyncio.run(self._serve())

    async def _serve(self) -> None:
        self._loop = asyncio.get_running_loop()
        server = serve(
            self._watch,
            sock=self.door.listening,
            process_request=self._request,
            compression=None,
            server_header=None,
            max_size=LARGEST_BYTES,
            max_queue=8,
            write_limit=0,
            open_timeout=_PATIENCE_S,
            close_timeout=1.0,
            ping_interval=_ASKED_EVERY_S,
            ping_timeout=_ANSWER_WITHIN_S,
            logger=_LOG,
        )
        # A failed task ends the server and so disconnects the watchers, instead of leaving them with a frozen picture.
        async with AsyncExitStack() as opened:
            await opened.enter_async_context(server)
            for desk in self._desks.values():
                await opened.enter_async_context(desk)
            tasks = await opened.enter_async_context(asyncio.TaskGroup())
            works = [
                tasks.create_task(work)
                for desk in self._desks.values()
                for work in (_every(1 / RATE_HZ, desk.tick), *desk.works())
            ]
            self._ready.set()
            await self._end.wait()
            for work in works:
                work.cancel()

    # HTTP.

    def _request(self, connection: ServerConnection, request: Request) -> Response | None:
        """Serve a file, or return ``None`` to accept a WebSocket."""
        path = urlsplit(request.path).path
        try:
            role = self.admission.role(request.path, request.headers)
            desk = self._desks.get(path.removesuffix(SOCKET)) if path.endswith(f"/{SOCKET}") else None
            if desk is not None:
                self.admission.check_origin(request.headers)
                if len(desk.watchers) >= MOST:
                    raise Refused(HTTPStatus.SERVICE_UNAVAILABLE, f"{MOST} watchers are connected already")
                connection.forcefeel_admitted = (role, desk)  # type: ignore[attr-defined]  # for the handler
                return None
        except Refused as refused:
            return answer(refused.status, f"forcefeel: {refused}\n".encode())
        if token := self.admission.token_of(request.path):
            # The token moves from the address into a cookie, so that it is not visible or stored in the history.
            cookie = f"{self.admission.cookie}={token}; Path=/; HttpOnly; SameSite=Lax"
            return answer(HTTPStatus.SEE_OTHER, b"", Location="/", Set_Cookie=cookie)
        if path not in self._files:
            return answer(HTTPStatus.NOT_FOUND, b"forcefeel: no such file\n")
        kind, body = self._files[path]
        return answer(HTTPStatus.OK, body, kind)

    # The WebSocket.

    async def _watch(self, connection: ServerConnection) -> None:
        admitted: tuple[Role, ConsoleSession] = connection.forcefeel_admitted  # type: ignore[attr-defined]
        role, desk = admitted
        at = connection.transport.get_extra_info("socket")
        at.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, _SEND_BYTES)
        watcher = desk.join(connection, role)
        try:
            async for message in connection:
                if watcher.floods():
                    await connection.close(1008, "too many commands")
                    break
                refusal = _respond(desk, watcher, message)
                if refusal and watcher.is_refused():
                    await connection.close(1008, "too many invalid commands")
                    break
                if refusal and not watcher.behind:
                    await connection.send(json.dumps({"kind": "refused", "reason": refusal}))
        except ConnectionClosed:
            pass
        finally:
            desk.leave(watcher)


def _respond(desk: ConsoleSession, watcher: Watcher, message: str | bytes) -> str:
    """Execute a command; return the reason of a refusal, or an empty text."""
    try:
        desk.carry_out(watcher, command_of(message))
    except InputError as error:
        return str(error)
    return ""


async def _every(period_s: float, do: Callable[[], Any]) -> None:
    """Call a function periodically; missed periods are not repeated."""
    following = time.monotonic()
    while True:
        do()
        following = max(following + period_s, time.monotonic())
        await asyncio.sleep(following - time.monotonic())


class Console(Server):
    """The console of a running loop in a thread of this process; a context manager that does not end the loop.

    Args:
        running: The loop, or the axes of a cockpit.
        port: Port; 0 for a free one.
        bind: Address; by default only this machine can reach it.
        token: Whether requests need a token.
        setup: Rule of the tests, and displayed units.

    Raises:
        InputError: If the port is in use, the address does not belong to this machine, or it is public without a token.

    Example:
        >>> with ff.live.start(ff.digital_elevator(), "robust") as running, ff.live.Console(running, port=0) as console:
        ...     console.address.partition("?token=")[1]
        '?token='
    """

    def __init__(
        self,
        running: LiveSession | Mapping[str, LiveSession],
        *,
        port: int = DEFAULT_PORT,
        bind: str = "127.0.0.1",
        token: bool = True,
        setup: QualificationSetup | None = None,
    ) -> None:
        axes = running if isinstance(running, Mapping) else {"": running}
        super().__init__(axes, Listener.at(port, bind, token=token), setup or QualificationSetup())

    @property
    def address(self) -> str:
        """Address for control, with its token."""
        return self.door.address

    @property
    def watch_address(self) -> str:
        """Address for watching, with its token."""
        return self.door.watch_address
