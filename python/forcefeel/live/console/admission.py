"""Access control by token, Host header and Origin header.

There are two tokens of 24 random bytes: one for control, one for watching. The printed address contains one. The page then uses a
cookie, a program ``Authorization: Bearer TOKEN``. Source of the rules: Jupyter Server, "Security in the Jupyter Server".

* Host: a page of another site with a name that resolves to this machine (DNS rebinding) sends that name and is refused. A numeric
  address cannot be redirected.
* Origin: a browser sends the origin of the page that opens a WebSocket; only the console's own page is accepted. A program sends no
  Origin and uses ``Authorization``, which a page of another site cannot.
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
    """Rights of a client."""

    CONTROL = "control"
    """Move the column; one client at a time."""
    WATCH = "watch"
    """Watch and stop."""


class Refused(Exception):  # noqa: N818  not a program error
    """A refused request, with its HTTP status."""

    def __init__(self, status: int, reason: str) -> None:
        super().__init__(reason)
        self.status = status


def _token() -> str:
    return secrets.token_urlsafe(_TOKEN_BYTES)


@dataclass(frozen=True)
class Admission:
    """Access control of a server.

    Attributes:
        port: Port of the server; part of the cookie's name, because cookies have no ports.
        bind: Address of the server.
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
        """Role of a request by its path, with its query, and its headers.

        Raises:
            Refused: With another Host, or without a valid token.
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
        """Refuse a WebSocket from a page of another site.

        Raises:
            Refused: If the Origin is not that of the console's page, or is missing without ``Authorization``.
        """
        origin = headers.get("Origin")
        if origin is None:
            if self.token_required and not _bearer(headers):
                raise Refused(403, "no Origin: a program must send Authorization: Bearer TOKEN")
            return
        if origin not in {f"{scheme}://{headers.get('Host', '')}" for scheme in ("http", "https")}:
            raise Refused(403, "another site's page may not open this connection")

    @staticmethod
    def token_of(path: str) -> str:
        """The token in the address, or an empty text."""
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
            raise Refused(400, "the Host header is not an address") from None
        # A tunnel changes the port, so any port is accepted for a loopback name.
        if name == "localhost" or _in_digits(name):
            return
        if self.bind in ("127.0.0.1", "::1") or name != socket.gethostname().lower() or port != self.port:
            raise Refused(403, "unknown name of this server; use its numeric address or localhost")


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
    """Whether only this machine can reach an address."""
    try:
        return ipaddress.ip_address(bind).is_loopback
    except ValueError:
        return bind == "localhost"
