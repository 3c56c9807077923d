"""The console's server: the page's files over HTTP, frames and commands over a WebSocket, in a thread of its own."""

import asyncio
import json
import logging
import socket
import threading
import time
from collections.abc import Callable
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

SOCKET = "/live"

_SEND_BYTES = 32768
"""What the system holds of frames that a watcher does not take: a second or two of them."""
_ASKED_EVERY_S, _ANSWER_WITHIN_S = 5.0, 10.0
"""A watcher that does not answer a ping is gone, and with it control."""
_PATIENCE_S = 5.0
"""For a request, for a good-bye, for the thread's start and end."""

_LOG = logging.getLogger("forcefeel.live.console")
_LOG.addHandler(logging.NullHandler())
_LOG.propagate = False  # who knocks wrongly must not fill the terminal


class Server:
    """The server of a running loop, a context manager: leaving it ends the server, not the loop.

    Args:
        running: The loop.
        door: Where it listens, and who gets in.
        setup: How the rule's tests are judged, and in which units all is shown.
    """

    def __init__(self, running: LiveSession, door: Listener, setup: QualificationSetup) -> None:
        self.door, self.admission = door, door.admission
        self._desk = ConsoleSession(running, setup, Watchers())
        self._thread = threading.Thread(target=self._run, name="forcefeel console", daemon=True)
        self._ready, self._end = threading.Event(), asyncio.Event()
        self._loop: asyncio.AbstractEventLoop | None = None

    def __enter__(self) -> Self:
        """Listens, from now on."""
        self._thread.start()
        self._ready.wait(_PATIENCE_S)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, where: TracebackType | None
    ) -> None:
        """Says good-bye to all."""
        if self._loop is not None and self._thread.is_alive():
            self._loop.call_soon_threadsafe(self._end.set)
            self._thread.join(_PATIENCE_S)

    @property
    def serves(self) -> bool:
        """Whether it has begun and not ended."""
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
        # What fails of the group ends the server, whose watchers are told so; a picture that stands still would tell them nothing.
        async with server, self._desk, asyncio.TaskGroup() as tasks:
            works = [tasks.create_task(work) for work in (_every(1 / RATE_HZ, self._desk.tick), *self._desk.works())]
            self._ready.set()
            await self._end.wait()
            for work in works:
                work.cancel()

    # HTTP.

    def _request(self, connection: ServerConnection, request: Request) -> Response | None:
        """Serves a file, or lets a WebSocket in by answering nothing."""
        path = urlsplit(request.path).path
        try:
            role = self.admission.role(request.path, request.headers)
            if path == SOCKET:
                self.admission.check_origin(request.headers)
                if len(self._desk.watchers) >= MOST:
                    raise Refused(HTTPStatus.SERVICE_UNAVAILABLE, f"{MOST} watchers are there already")
                connection.forcefeel_role = role  # type: ignore[attr-defined]  # for the handler
                return None
        except Refused as refused:
            return answer(refused.status, f"forcefeel: {refused}\n".encode())
        if token := self.admission.token_of(request.path):
            # From the address into a cookie, so that the token does not stay in view and in the history.
            cookie = f"{self.admission.cookie}={token}; Path=/; HttpOnly; SameSite=Lax"
            return answer(HTTPStatus.SEE_OTHER, b"", Location="/", Set_Cookie=cookie)
        if path not in page_files():
            return answer(HTTPStatus.NOT_FOUND, b"forcefeel: no such file\n")
        kind, body = page_files()[path]
        return answer(HTTPStatus.OK, body, kind)

    # The WebSocket.

    async def _watch(self, connection: ServerConnection) -> None:
        role: Role = connection.forcefeel_role  # type: ignore[attr-defined]
        at = connection.transport.get_extra_info("socket")
        at.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, _SEND_BYTES)
        watcher = self._desk.join(connection, role)
        try:
            async for message in connection:
                if watcher.floods():
                    await connection.close(1008, "too many commands")
                    break
                refusal = self._respond(watcher, message)
                if refusal and watcher.is_refused():
                    await connection.close(1008, "too many commands that are none")
                    break
                if refusal and not watcher.behind:
                    await connection.send(json.dumps({"kind": "refused", "reason": refusal}))
        except ConnectionClosed:
            pass
        finally:
            self._desk.leave(watcher)

    def _respond(self, watcher: Watcher, message: str | bytes) -> str:
        """Carries out a command; tells why not, if not."""
        try:
            self._desk.carry_out(watcher, command_of(message))
        except InputError as error:
            return str(error)
        return ""


async def _every(period_s: float, do: Callable[[], Any]) -> None:
    """Does something so often; what it is late for is left out."""
    following = time.monotonic()
    while True:
        do()
        following = max(following + period_s, time.monotonic())
        await asyncio.sleep(following - time.monotonic())


class Console(Server):
    """The console of a running loop, served by a thread of this process; a context manager, which leaves the loop as it is.

    Args:
        running: The loop.
        port: Where it listens; 0 for any free one.
        bind: The address that it listens at; only this machine reaches the usual one.
        token: Whether it asks for a token.
        setup: How the rule's tests are judged, and in which units all is shown.

    Raises:
        InputError: If the port is taken or the address is none of this machine's; if without a token others could reach it.

    Example:
        >>> import forcefeel as ff
        >>> with ff.live.start(ff.digital_elevator(), "robust") as running, ff.live.Console(running, port=0) as console:
        ...     console.address.partition("?token=")[1]
        '?token='
    """

    def __init__(
        self,
        running: LiveSession,
        *,
        port: int = DEFAULT_PORT,
        bind: str = "127.0.0.1",
        token: bool = True,
        setup: QualificationSetup | None = None,
    ) -> None:
        super().__init__(running, Listener.at(port, bind, token=token), setup or QualificationSetup())

    @property
    def address(self) -> str:
        """What to open to control; it holds the token."""
        return self.door.address

    @property
    def watch_address(self) -> str:
        """What to open to look on."""
        return self.door.watch_address
