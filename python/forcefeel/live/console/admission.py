"""Who gets in, and what they may: a token, the Host header, the Origin header.

Two tokens, 24 random bytes each: one to move the column, one to look on. The address that is printed holds one; the page then goes
by a cookie, and a program by ``Authorization: Bearer TOKEN``. The habits are those of Jupyter Server (its documentation, "Security
in the Jupyter Server").

* Host: a page of another site whose name was pointed at this machine (DNS rebinding) sends that name, and is refused. An address in
  digits cannot be pointed elsewhere.
* Origin: a browser names the page that opens a WebSocket; only our own may. A program sends none, and shows its token by
  ``Authorization``, which no page of another site can.
"""

import hmac
import ipaddress
import secrets
import socket
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from http.cookies import CookieError, SimpleCookie
from urllib.parse import parse_qs, urlsplit

_TOKEN_BYTES = 24


class Role(Enum):
    """What somebody who got in may."""

    CONTROL = "control"
    """Move the column, one at a time."""
    WATCH = "watch"
    """Look on, and stop."""


class Refused(Exception):  # noqa: N818  no fault of the program
    """Why somebody does not get in, with the status of HTTP."""

    def __init__(self, status: int, reason: str) -> None:
        super().__init__(reason)
        self.status = status


def _token() -> str:
    return secrets.token_urlsafe(_TOKEN_BYTES)


@dataclass(frozen=True)
class Admission:
    """Who gets in.

    Attributes:
        port: Where the server listens; cookies know no ports, so its name holds it.
        bind: The address that it is bound to.
        token_required: Whether a request needs a token; without one, every user of this machine may control.
        control, watch: The tokens.
    """

    port: int
    bind: str = "127.0.0.1"
    token_required: bool = True
    control: str = field(default_factory=_token, repr=False)
    watch: str = field(default_factory=_token, repr=False)

    @property
    def cookie(self) -> str:
        """The cookie's name."""
        return f"forcefeel-{self.port}"

    def role(self, path: str, headers: Mapping[str, str]) -> Role:
        """What a request may.

        Args:
            path: Of the request, with its query.
            headers: Of the request.

        Raises:
            Refused: If it may nothing: another Host, no token or a wrong one.
        """
        self._check_host(headers.get("Host", ""))
        if not self.token_required:
            return Role.CONTROL
        token_sent = self.token_of(path) or _bearer(headers) or self._of_cookie(headers)
        if not token_sent:
            raise Refused(403, "no token: open the address that forcefeel run printed, token and all")
        for token, role in ((self.control, Role.CONTROL), (self.watch, Role.WATCH)):
            if hmac.compare_digest(token_sent.encode(), token.encode()):
                return role
        raise Refused(403, "wrong token: open the address that forcefeel run printed last")

    def check_origin(self, headers: Mapping[str, str]) -> None:
        """Refuses a WebSocket that a page of another site opens.

        Raises:
            Refused: If the Origin is not that of our page, or is missing without an ``Authorization``.
        """
        origin = headers.get("Origin")
        if origin is None:
            if self.token_required and not _bearer(headers):
                raise Refused(403, "no Origin: a program shows its token by Authorization: Bearer TOKEN")
            return
        if origin not in {f"{scheme}://{headers.get('Host', '')}" for scheme in ("http", "https")}:
            raise Refused(403, "another site's page may not open this connection")

    @staticmethod
    def token_of(path: str) -> str:
        """The token in the address; empty if there is none."""
        return parse_qs(urlsplit(path).query).get("token", [""])[0]

    def _of_cookie(self, headers: Mapping[str, str]) -> str:
        try:
            morsel = SimpleCookie(headers.get("Cookie", "")).get(self.cookie)
        except CookieError:
            return ""
        return morsel.value if morsel else ""

    def _check_host(self, host: str) -> None:
        try:
            named = urlsplit(f"//{host}")
            name, port = named.hostname or "", named.port
        except ValueError:
            raise Refused(400, "the Host header is no address") from None
        # Through a tunnel the page has another port, so that of a loopback name is free.
        if name == "localhost" or _in_digits(name):
            return
        if self.bind in ("127.0.0.1", "::1") or name != socket.gethostname().lower() or port != self.port:
            raise Refused(403, "this server does not answer to that name; use its address in digits, or localhost")


def _bearer(headers: Mapping[str, str]) -> str:
    kind, _, token = headers.get("Authorization", "").partition(" ")
    return token.strip() if kind.lower() in ("bearer", "token") else ""


def _in_digits(name: str) -> bool:
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True


def is_loopback(bind: str) -> bool:
    """Whether only this machine reaches an address."""
    try:
        return ipaddress.ip_address(bind).is_loopback
    except ValueError:
        return bind == "localhost"
