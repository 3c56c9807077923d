"""A console of the stand-in, and what a program needs to speak to it."""

import json
from urllib.parse import urlsplit

import pytest
from websockets.sync.client import connect

from forcefeel.live import Console
from tests.live.console.stand_in import StandIn

PATIENCE_S = 30.0


class Talk:
    """A program's connection: notices by their kind, frames in between."""

    def __init__(self, console, token=None, **more):
        self.console = console
        shown = console.admission.control if token is None else token
        headers = {"Authorization": f"Bearer {shown}"} if shown else {}
        self._opening = connect(
            address(console, "ws") + "/live", additional_headers=headers, compression=None, proxy=None, **more
        )

    def __enter__(self):
        self.socket = self._opening.__enter__()
        return self

    def __exit__(self, *error):
        self._opening.__exit__(*error)

    def send(self, **command):
        self.socket.send(json.dumps(command))

    def notice(self, kind, when=lambda notice: True):
        """The next notice of a kind for which something holds."""
        while True:
            message = self.socket.recv(timeout=PATIENCE_S)
            if isinstance(message, str):
                found = json.loads(message)
                if found["kind"] == kind and when(found):
                    return found

    def status(self, **wanted):
        return self.notice("status", lambda it: all(it[key] == value for key, value in wanted.items()))

    def frame(self):
        while True:
            message = self.socket.recv(timeout=PATIENCE_S)
            if isinstance(message, bytes):
                return message


def address(console, scheme="http"):
    return f"{scheme}://{urlsplit(console.address).netloc}"


@pytest.fixture
def running():
    with StandIn() as loop:
        loop.on()
        yield loop


@pytest.fixture
def console(running):
    with Console(running, port=0) as found:
        yield found


@pytest.fixture
def talk(console):
    with Talk(console) as found:
        yield found
