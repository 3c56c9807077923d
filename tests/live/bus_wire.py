"""A wire of a serial bus that a test looks at: what passes between a client and an emulator, line by line."""

import os
import select
import threading
import tty
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def tapped(port) -> Iterator[tuple[str, list[bytes]]]:
    """A port of its own that leads to ``port``, and the lines that a client writes to it."""
    near, client = os.openpty()
    far = os.open(port, os.O_RDWR | os.O_NOCTTY)
    for end in (near, client, far):
        tty.setraw(end)
    lines, ended = [b""], threading.Event()

    def pass_on():
        while not ended.is_set():
            for end in select.select([near, far], [], [], 0.05)[0]:
                data = os.read(end, 4096)
                os.write(far if end == near else near, data)
                if end == near:
                    *whole, rest = (lines.pop() + data).replace(b"\r", b"\n").split(b"\n")
                    lines.extend([*(line for line in whole if line), rest])

    thread = threading.Thread(target=pass_on)
    thread.start()
    try:
        yield os.ttyname(client), lines
    finally:
        ended.set()
        thread.join()
        for end in (near, client, far):
            os.close(end)
