"""Files of the page and their headers."""

import json
from functools import cache
from http import HTTPStatus
from importlib import resources

from websockets.datastructures import Headers
from websockets.http11 import Response

_KINDS = {
    "html": "text/html; charset=utf-8",
    "css": "text/css; charset=utf-8",
    "js": "text/javascript; charset=utf-8",
    "json": "application/json",
}

_HEADERS = {
    # Only this server's own files, and no frame of another site; the page of a cockpit has those of its axes.
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; "
    "connect-src 'self'; frame-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'self'",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cache-Control": "no-store",
    "Connection": "close",
}


@cache
def page_files(axes: tuple[str, ...]) -> dict[str, tuple[str, bytes]]:
    """Content type and bytes of each file, by request path, for the axes of a cockpit, or for a single loader without a name."""
    folder = resources.files("forcefeel.live.console") / "page"
    shared = (
        resources.files("forcefeel.page") / "style.css.j2"
    )  # palette and fonts of all pages; it has no template fields
    answers = {"/style.css": (_KINDS["css"], shared.read_bytes())}
    for path in folder.iterdir():
        kind = _KINDS.get(path.name.rpartition(".")[2])
        if kind:
            answers[f"/{path.name}"] = kind, path.read_bytes()
    of_axis, of_cockpit = answers.pop("/index.html"), answers.pop("/cockpit.html")
    if axes == ("",):
        return {**answers, "/": of_axis}
    names = json.dumps(axes).encode()
    return {
        **answers,
        "/": of_cockpit,
        "/axes.json": (_KINDS["json"], names),
        **{f"/axis/{axis}/": of_axis for axis in axes},
    }


def answer(status: int, body: bytes, kind: str = "text/plain; charset=utf-8", **more: str) -> Response:
    """A response with the common headers."""
    headers = Headers({**_HEADERS, "Content-Type": kind, "Content-Length": str(len(body))})
    for name, value in more.items():
        headers[name.replace("_", "-")] = value
    return Response(status, HTTPStatus(status).phrase, headers, body)
