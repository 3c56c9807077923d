"""Who gets in: token, cookie, Host, Origin; and what is refused of those who did."""

import http.client
import json
import socket

import pytest
from websockets.exceptions import ConnectionClosedError, InvalidStatus
from websockets.sync.client import connect

from forcefeel.errors import InputError
from forcefeel.live import Console
from forcefeel.live.console.admission import Admission, Refused, Role
from tests.live.console.conftest import Talk, address


def asked(console, path="/", **headers):
    """Status, headers and body of a request."""
    connection = http.client.HTTPConnection("127.0.0.1", console.admission.port, timeout=10)
    connection.request("GET", path, headers={name.replace("_", "-"): value for name, value in headers.items()})
    response = connection.getresponse()
    body = response.read().decode()
    connection.close()
    return response.status, response.headers, body


def test_tokens_are_long_and_unique():
    first, second = Admission(1), Admission(1)
    tokens = {first.control, first.watch, second.control, second.watch}
    assert len(tokens) == 4
    assert min(map(len, tokens)) >= 32  # 24 bytes, six bits a letter
    assert first.control not in repr(first)


def test_missing_or_wrong_token_returns_403(console):
    for path, headers in (("/", {}), ("/?token=x", {}), ("/console.js", {}), ("/", {"Authorization": "Bearer é"})):
        status, _, body = asked(console, path, **headers)
        assert status == 403
        assert "token" in body
        assert console.admission.control not in body


def test_address_token_sets_cookie(console):
    path = console.address.partition(address(console))[2]
    status, headers, _ = asked(console, path)
    cookie = headers["Set-Cookie"]
    assert (status, headers["Location"]) == (303, "/")
    assert "HttpOnly" in cookie
    assert "SameSite" in cookie
    status, headers, body = asked(console, "/", Cookie=cookie.partition(";")[0])
    assert status == 200
    assert body.startswith("<!DOCTYPE html>")
    assert "script-src 'self'" in headers["Content-Security-Policy"]
    assert "unsafe" not in headers["Content-Security-Policy"]


def test_server_serves_only_page_files(console):
    shown = {"Authorization": f"Bearer {console.admission.watch}"}
    for name in ("console.js", "console.css", "style.css", "uplot.js", "uplot.css"):
        assert asked(console, f"/{name}", **shown)[0] == 200
    for name in ("/uplot.LICENSE/..", "/../server.py", "/%2e%2e/server.py", "/index.html"):
        assert asked(console, name, **shown)[0] == 404


@pytest.mark.parametrize("host", ["evil.example", "evil.example:80", "localhost.evil.example", "[", ""])
def test_another_host_is_refused(console, host):
    assert asked(console, Host=host, Authorization=f"Bearer {console.admission.control}")[0] in (400, 403)


@pytest.mark.parametrize("host", ["localhost:9999", "127.0.0.1:80", "[::1]:8731"])
def test_tunnel_with_another_port_is_accepted(host):
    admission = Admission(8731)
    assert admission.role(f"/?token={admission.watch}", {"Host": host}) is Role.WATCH


@pytest.mark.parametrize("origin", ["http://evil.example", "null", "http://127.0.0.1:1"])
def test_connection_from_another_site_is_refused(console, origin):
    with pytest.raises(InvalidStatus, match="403"), Talk(console, origin=origin):
        pass


def test_cookie_without_origin_is_refused(console):
    cookie = f"{console.admission.cookie}={console.admission.control}"
    url = address(console, "ws") + "/live"
    with pytest.raises(InvalidStatus, match="403"), connect(url, additional_headers={"Cookie": cookie}, proxy=None):
        pass
    with connect(url, additional_headers={"Cookie": cookie}, origin=address(console), proxy=None) as socket_:
        assert json.loads(socket_.recv(timeout=10))["kind"] == "hello"


def test_connection_with_wrong_token_is_refused(console):
    for token in ("", "wrong", console.admission.control[:-1]):
        with pytest.raises(InvalidStatus, match="403"), Talk(console, token):
            pass


def test_numeric_origin_is_checked():
    admission = Admission(8731, token_required=False)
    admission.check_origin({"Host": "127.0.0.1:8731", "Origin": "http://127.0.0.1:8731"})
    with pytest.raises(Refused, match="another site"):
        admission.check_origin({"Host": "127.0.0.1:8731", "Origin": "http://localhost:8731"})


def test_no_token_is_allowed_only_on_this_machine(running):
    with pytest.raises(InputError, match=r"--no-token: any host that reaches 0\.0\.0\.0"):
        Console(running, port=0, bind="0.0.0.0", token=False)
    with Console(running, port=0, token=False) as console:
        assert "token" not in console.address
        assert asked(console)[0] == 200


def test_port_in_use_raises_input_error(running, console):
    with pytest.raises(InputError, match=f"--port {console.admission.port}.*use another"):
        Console(running, port=console.admission.port)


@pytest.mark.parametrize(
    "message",
    [
        "{",
        "[]",
        "null",
        '{"do": "fly"}',
        '{"do": "stop", "more": 1}',
        '{"do": "hand", "force_n": 1e9}',
        '{"do": "hand", "force_n": NaN}',
        '{"do": "hand", "force_n": "20"}',
        '{"do": "feel", "rows": {}}',
        '{"do": "feel", "rows": {"valve.orifice": 1}}',
        '{"do": "feel", "rows": {"feel.__class__": 1}}',
        '{"do": "break", "fault": "explode"}',
        '{"do": "break", "fault": "stuck", "sensor": "nose"}',
        "[" * 2000,
        b"\xff\x00",
    ],
)
def test_invalid_command_is_refused_without_effect(talk, running, message):
    before = list(running.calls)
    talk.socket.send(message)
    assert talk.notice("refused")["reason"]
    assert running.calls == before
    assert running.hand_force_n == 0


def test_an_oversized_message_ends_the_connection(talk):
    talk.socket.send("x" * 5000)
    with pytest.raises(ConnectionClosedError) as closed:
        talk.notice("never")
    assert closed.value.rcvd.code == 1009


def flooded(talk, message):
    for _ in range(600):
        talk.socket.send(message)
    talk.notice("never")


def test_invalid_messages_and_floods_end_the_connection(console, running):
    """A client that writes and does not read waits for the end of its own connection: here a second, by default five."""
    for message in ('{"do": "rubbish"}', '{"do": "hand"}'):
        with Talk(console, close_timeout=1) as bad, pytest.raises(ConnectionClosedError) as closed:
            flooded(bad, message)
        assert closed.value.rcvd is None or closed.value.rcvd.code == 1008
    with Talk(console) as good:
        assert good.frame()


def test_non_http_bytes_do_not_disturb_the_server(console):
    with socket.create_connection(("127.0.0.1", console.admission.port)) as raw:
        raw.sendall(b"\x16\x03\x01" + b"\x00" * 300 + b"\r\n\r\n")
        raw.settimeout(10)
        assert raw.recv(1000)[:4] in (b"", b"HTTP")
    assert asked(console, Authorization=f"Bearer {console.admission.watch}")[0] == 200
