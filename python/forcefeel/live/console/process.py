"""A console in a process of its own: nothing that holds or ends it reaches the loop.

The loop's process keeps what outlives a server: the door, which goes on listening, so that address and tokens stay; and what was
asked for. It answers the server in a thread, and starts a new one where one has ended.
"""

import pickle
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from types import TracebackType
from typing import Self

from forcefeel.live.console.admission import Admission
from forcefeel.live.console.ipc import LoopProxy, LoopServer, pair
from forcefeel.live.console.listener import Listener
from forcefeel.live.console.server import Server
from forcefeel.live.live_session import LiveSession
from forcefeel.live.loop_settings import LoopSettings
from forcefeel.live.setup import live_law
from forcefeel.qualification.plan.run import QualificationSetup

_SHORT_LIFE_S = 5.0
"""A server that ends so soon is not started again: the next would end too."""
_PATIENCE_S = 2.0
"""For a server's end."""


@dataclass(frozen=True)
class _Begins:
    """What a server is told at its beginning."""

    settings: LoopSettings
    admission: Admission
    setup: QualificationSetup


class ConsoleProcess:
    """The console of a running loop in a process of its own, a context manager that ends it.

    Args:
        running: The loop.
        door: Where it listens, and who gets in.
        setup: How the rule's tests are judged, and in which units all is shown.
        tell: Is told, in a sentence, that a server has ended by itself.
    """

    def __init__(
        self, running: LiveSession, door: Listener, setup: QualificationSetup, tell: Callable[[str], None]
    ) -> None:
        self._running, self._door, self._setup, self._tell = running, door, setup, tell
        self._process: subprocess.Popen[bytes] | None = None
        self._lock, self._ends = threading.Lock(), False
        self._thread = threading.Thread(target=self._keep, name="forcefeel console", daemon=True)

    @property
    def process_id(self) -> int | None:
        """Of the server; ``None`` where there is none."""
        return None if self._process is None else self._process.pid

    def __enter__(self) -> Self:
        """Starts a server."""
        self._process, self._wire = self._start_server()
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, where: TracebackType | None
    ) -> None:
        """Ends it: in good order, or else, where it is stopped, all the same."""
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
        """Answers server after server, until the end."""
        while self._process is not None:
            began = time.monotonic()
            with self._wire:
                LoopServer(self._running, self._wire).until_gone()
            how = _how(self._process.wait())
            again = time.monotonic() - began >= _SHORT_LIFE_S
            with self._lock:
                if self._ends:
                    return
                self._process = None
                if again:
                    self._process, self._wire = self._start_server()
            self._tell(
                f"the console's server ended ({how}); the loop goes on, and who had its hand on the column let go. "
                + ("Another one serves at the same address" if again else "It ended too soon to be started again")
            )
        self._door.listening.close()  # who comes is refused, and does not wait

    def _start_server(self) -> tuple[subprocess.Popen[bytes], socket.socket]:
        wire, child_wire = pair()
        with child_wire:
            handed = (child_wire.fileno(), self._door.listening.fileno())
            # -P: no file of the folder that it is started in counts as a module. A group of its own: Ctrl-C is the loop's.
            process = subprocess.Popen(
                [sys.executable, "-P", "-m", __name__, *map(str, handed)],
                stdin=subprocess.PIPE,
                pass_fds=handed,
                process_group=0,
            )
        begins = _Begins(self._running.settings, self._door.admission, self._setup)
        try:
            with process.stdin:  # type: ignore[union-attr]  # it is a pipe
                pickle.dump(begins, process.stdin)  # type: ignore[arg-type]
        except OSError:
            pass  # it has ended, which is seen at once
        return process, wire


def _how(status: int) -> str:
    return f"by signal {signal.Signals(-status).name}" if status < 0 else f"exit status {status}"


def serve() -> None:
    """What the process of the server does, until it is told to end or the loop's process is gone."""
    ends = threading.Event()
    signal.signal(signal.SIGTERM, lambda *_: ends.set())
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    wire, listening = (socket.socket(fileno=int(descriptor)) for descriptor in sys.argv[1:3])
    begins: _Begins = pickle.load(sys.stdin.buffer)
    settings = begins.settings
    running = LiveSession(LoopProxy(wire), settings, live_law(settings.law, settings.loader))
    with Server(running, Listener(listening, begins.admission), begins.setup) as server:
        while not ends.wait(_LOOKS_S):
            running.loop.status()  # ends this process where there is no loop
            if not server.serves:
                sys.exit(1)


_LOOKS_S = 0.2

if __name__ == "__main__":
    serve()
