"""Where a console listens, and who gets in there: both outlive a server that ends."""

import socket
from dataclasses import dataclass
from typing import Self

from forcefeel.errors import InputError
from forcefeel.live.console.admission import Admission, is_loopback

DEFAULT_PORT = 8731

_WAITING = 64
"""Who may wait to be let in."""


@dataclass(frozen=True, eq=False)
class Listener:
    """A socket that listens, with the tokens that it is opened by.

    Attributes:
        listening: The socket.
        admission: Who gets in.
    """

    listening: socket.socket
    admission: Admission

    @classmethod
    def at(cls, port: int, bind: str, *, token: bool) -> Self:
        """A new one.

        Args:
            port: Where it listens; 0 for any free one.
            bind: The address that it listens at.
            token: Whether it asks for a token.

        Raises:
            InputError: If the port is taken or the address is none of this machine's; if without a token others could reach it.
        """
        if not token and not is_loopback(bind):
            raise InputError(
                f"--no-token: whoever reaches {bind} could move the column; leave --no-token or --bind out, or reach this "
                "machine by a tunnel: ssh -L"
            )
        listening = _listening(bind, port)
        return cls(listening, Admission(listening.getsockname()[1], bind, token))

    @property
    def address(self) -> str:
        """What to open to control; it holds the token."""
        return self._address(self.admission.control)

    @property
    def watch_address(self) -> str:
        """What to open to look on."""
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
            f"--port {port}, --bind {bind}: cannot listen there ({error}); give another --port, 0 for any that is free"
        ) from error
