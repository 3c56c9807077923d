"""Socket and access control of a console; both survive a restart of the server."""

import socket
from dataclasses import dataclass
from typing import Self

from forcefeel.errors import InputError
from forcefeel.live.console.admission import Admission, is_loopback

DEFAULT_PORT = 8731

_WAITING = 64
"""Backlog of connections."""


@dataclass(frozen=True, eq=False)
class Listener:
    """A listening socket with its access control.

    Attributes:
        listening: The socket.
        admission: Access control.
    """

    listening: socket.socket
    admission: Admission

    @classmethod
    def at(cls, port: int, bind: str, *, token: bool) -> Self:
        """Open a socket; port 0 takes a free one.

        Raises:
            InputError: If the port is in use, the address does not belong to this machine, or it is public without a token.
        """
        if not token and not is_loopback(bind):
            raise InputError(
                f"--no-token: any host that reaches {bind} could move the column; omit --no-token or --bind, or reach this "
                "machine through a tunnel: ssh -L"
            )
        listening = _listening(bind, port)
        return cls(listening, Admission(listening.getsockname()[1], bind, token))

    @property
    def address(self) -> str:
        """Address for control, with its token."""
        return self._address(self.admission.control)

    @property
    def watch_address(self) -> str:
        """Address for watching, with its token."""
        return self._address(self.admission.watch)

    def _address(self, token: str) -> str:
        bind = self.admission.bind
        name = socket.gethostname() if bind in ("0.0.0.0", "::") else f"[{bind}]" if ":" in bind else bind
        return f"http://{name}:{self.admission.port}/" + (f"?token={token}" if self.admission.token_required else "")


def _listening(bind: str, port: int) -> socket.socket:
    family = socket.AF_INET6 if ":" in bind else socket.AF_INET
    try:
        return socket.create_server((bind, port), family=family, backlog=_WAITING)
    except (OSError, OverflowError) as error:
        raise InputError(
            f"--port {port}, --bind {bind}: cannot listen there ({error}); use another --port, 0 for a free one"
        ) from error
