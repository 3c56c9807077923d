"""A console in its own process: a blocked or crashed console does not affect the loop.

The loop's process keeps the state that survives a server: the listening socket, so that address and tokens stay, and the settings.
It answers the server in a thread and restarts a server that ended.
"""

import pickle
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from dataclasses import dataclass
from types import TracebackType
from typing import Self

from forcefeel.live.console.admission import Admission
from forcefeel.live.console.ipc import FlightProxy, LoopProxy, LoopServer, pair
from forcefeel.live.console.listener import Listener
from forcefeel.live.console.server import Server
from forcefeel.live.flight_controls import Lever
from forcefeel.live.live_session import LiveSession
from forcefeel.live.loop_settings import LoopSettings
from forcefeel.live.setup import live_law
from forcefeel.qualification.plan.run import QualificationSetup

_SHORT_LIFE_S = 5.0
"""A server that ends sooner is not restarted, because the next would end too."""
_PATIENCE_S = 2.0
"""Timeout for the end of a server."""


@dataclass(frozen=True)
class _Begins:
    """Initial data of a server: settings of each axis by its name, empty for a single loader; levers of the flights beside them."""

    settings: dict[str, LoopSettings]
    levers: dict[str, Mapping[str, Lever]]
    admission: Admission
    setup: QualificationSetup


class ConsoleProcess:
    """The console of a running loop in its own process, a context manager that ends it.

    Args:
        axes: The running axes by name; the name of a single loader is empty.
        door: Socket and access control.
        setup: Rule of the tests, and displayed units.
        tell: Called with a sentence if a server ends by itself.
    """

    def __init__(
        self, axes: Mapping[str, LiveSession], door: Listener, setup: QualificationSetup, tell: Callable[[str], None]
    ) -> None:
        self._axes, self._door, self._setup, self._tell = axes, door, setup, tell
        self._process: subprocess.Popen[bytes] | None = None
        self._lock, self._ends = threading.Lock(), False
        self._thread = threading.Thread(target=self._keep, name="forcefeel console", daemon=True)

    @property
    def process_id(self) -> int | None:
        """Process id of the server; ``None`` without a server."""
        return None if self._process is None else self._process.pid

    def __enter__(self) -> Self:
        """Start a server."""
        self._process, self._wires = self._start_server()
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, where: TracebackType | None
    ) -> None:
        """Terminate the server, and kill it if it does not end in time."""
        with self._lock:
            self._ends = True
            process = self._process
        if process is not None:
            process.terminate()
            self._thread.join(_PATIENCE_S)
            process.kill()
        self._thread.join(_PATIENCE_S)
        self._door.listening.close()

    def _keep(self) -> None:
        """Answer servers and restart them until the end."""
        while self._process is not None:
            began = time.monotonic()
            self._answer()
            how = _how(self._process.wait())
            again = time.monotonic() - began >= _SHORT_LIFE_S
            with self._lock:
                if self._ends:
                    return
                self._process = None
                if again:
                    self._process, self._wires = self._start_server()
            self._tell(
                f"the console's server ended ({how}); the loop continues, and the console's hand on the column is released. "
                + ("A new server runs at the same address" if again else "It ended too soon to be restarted")
            )
        self._door.listening.close()  # new connections are refused instead of waiting

    def _answer(self) -> None:
        """Answer a server on behalf of each axis until it is gone."""
        servers = [
            threading.Thread(target=LoopServer(running, wire).until_gone, name="forcefeel console", daemon=True)
            for running, wire in zip(self._axes.values(), self._wires, strict=True)
        ]
        for server in servers:
            server.start()
        for server in servers:
            server.join()
        for wire in self._wires:
            wire.close()

    def _start_server(self) -> tuple[subprocess.Popen[bytes], list[socket.socket]]:
        wires, child_wires = zip(*(pair() for _ in self._axes), strict=True)
        with ExitStack() as closed:
            handed = [self._door.listening.fileno(), *(closed.enter_context(wire).fileno() for wire in child_wires)]
            # -P: modules are not imported from the current folder. Own process group: Ctrl-C reaches only the loop.
            process = subprocess.Popen(
                [sys.executable, "-P", "-m", __name__, *map(str, handed)],
                stdin=subprocess.PIPE,
                pass_fds=handed,
                process_group=0,
            )
        settings = {axis: running.settings for axis, running in self._axes.items()}
        levers = {axis: running.flight.levers for axis, running in self._axes.items() if running.flight}
        begins = _Begins(settings, levers, self._door.admission, self._setup)
        try:
            with process.stdin:  # type: ignore[union-attr]  # it is a pipe
                pickle.dump(begins, process.stdin)  # type: ignore[arg-type]
        except OSError:
            pass  # it has ended, which `_keep` detects
        return process, list(wires)


def _how(status: int) -> str:
    return f"by signal {signal.Signals(-status).name}" if status < 0 else f"exit status {status}"


def serve() -> None:
    """Run the server's process until it is terminated or the loop's process is gone."""
    ends = threading.Event()
    signal.signal(signal.SIGTERM, lambda *_: ends.set())
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    listening, *wires = (socket.socket(fileno=int(descriptor)) for descriptor in sys.argv[1:])
    begins: _Begins = pickle.load(sys.stdin.buffer)
    axes = {}
    for (axis, settings), wire in zip(begins.settings.items(), wires, strict=True):
        loop = LoopProxy(wire)
        axes[axis] = LiveSession(loop, settings, live_law(settings.law, settings.loader))
        if axis in begins.levers:
            axes[axis].flight = FlightProxy(loop, begins.levers[axis])
    with Server(axes, Listener(listening, begins.admission), begins.setup) as server:
        while not ends.wait(_LOOKS_S):
            next(iter(axes.values())).loop.status()  # ends this process without a loop
            if not server.serves:
                sys.exit(1)


_LOOKS_S = 0.2

if __name__ == "__main__":
    serve()
