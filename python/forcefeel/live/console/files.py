"""The page's files, and the headers that they go with."""

from functools import cache
from http import HTTPStatus
from importlib import resources

from websockets.datastructures import Headers
from websockets.http11 import Response

_KINDS = {
    "html": "text/html; charset=utf-8",
    "css": "text/css; charset=utf-8",
    "js": "text/javascript; charset=utf-8",
}

_HEADERS = {
    # Nothing but this server's own files, and no frame of another site around them.
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cache-Control": "no-store",
    "Connection": "close",
}


@cache
def page_files() -> dict[str, tuple[str, bytes]]:
    """Each file by the path that it is asked for by: its kind and its bytes."""
    folder = resources.files("forcefeel.live.console") / "page"
    shared = (
        resources.files("forcefeel.page") / "style.css.j2"
    )  # palette and type of all pages; nothing in it is filled in
    answers = {"/style.css": (_KINDS["css"], shared.read_bytes())}
    for path in folder.iterdir():
        kind = _KINDS.get(path.name.rpartition(".")[2])
        if kind:
            answers["/" if path.name == "index.html" else f"/{path.name}"] = kind, path.read_bytes()
    return answers


def answer(status: int, body: bytes, kind: str = "text/plain; charset=utf-8", **more: str) -> Response:
    """A response with the headers that all have."""
    headers = Headers({**_HEADERS, "Content-Type": kind, "Content-Length": str(len(body))})
    for name, value in more.items():
        headers[name.replace("_", "-")] = value
    return Response(status, HTTPStatus(status).phrase, headers, body)
