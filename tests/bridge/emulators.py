"""Simulators that speak the real bytes."""

import socket
import struct
import threading
import time


class XPlaneEmulator:
    """X-Plane's UDP interface: answers what is asked for, at 60 Hz, and takes what is set."""

    def __init__(self, values: dict[str, float]) -> None:
        self.values, self.set, self.asked = values, {}, {}
        self._client = None
        self._wire = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._wire.bind(("127.0.0.1", 0))
        self._wire.settimeout(1 / 60)
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run)

    @property
    def address(self) -> tuple[str, int]:
        return self._wire.getsockname()

    def __enter__(self) -> "XPlaneEmulator":
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ended.set()
        self._thread.join()
        self._wire.close()

    def _run(self) -> None:
        sent = 0.0
        while not self._ended.is_set():
            try:
                packet, sender = self._wire.recvfrom(2048)
                self._take(packet, sender)
            except TimeoutError:
                pass
            if self._client and time.monotonic() - sent >= 1 / 60:
                sent = time.monotonic()
                asked = {k: name for k, (rate, name) in self.asked.items() if rate and name in self.values}
                body = b"".join(struct.pack("<if", k, self.values[name]) for k, name in asked.items())
                self._wire.sendto(b"RREF," + body, self._client)

    def _take(self, packet: bytes, sender: tuple[str, int]) -> None:
        if packet[:5] == b"RREF\0":
            assert len(packet) == 413
            rate, index, name = struct.unpack("<ii400s", packet[5:])
            self.asked[index], self._client = (rate, name.split(b"\0")[0].decode()), sender
        else:
            assert packet[:5] == b"DREF\0"
            assert len(packet) == 509
            value, name = struct.unpack("<f500s", packet[5:])
            self.set[name.split(b"\0")[0].decode()] = value
