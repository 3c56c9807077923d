"""X-Plane 11 and 12 by their UDP interface.

A request for a dataref is ``RREF`` and a zero byte, frequency and index (int32), the dataref in 400 bytes. The answers are ``RREF``
and a byte, then index (int32) and value (float32) of each. ``DREF`` and a zero byte, a value (float32) and the dataref in 500 bytes
set it. Little-endian.

Source: Laminar Research, X-Plane, "Exchanging Data with X-Plane" (folder ``Instructions``), and the list of datarefs at
developer.x-plane.com; article "Flight Control Splits": the torque tube carries a jam of the right side to the left control until it
splits.
"""

import socket
import struct
import time
from contextlib import suppress
from math import radians

from forcefeel.bridge.simulator import Axis, SimulatorState

PORT = 49000
RATE_HZ = 60
RENEWED_S = 5.0
"""X-Plane that was started anew has forgotten what was asked for."""

FAILED = 6.0
"""Value of ``sim/operation/failures``: inoperative."""

_SPLITS = 0.5
"""Between a joined torque tube, 0, and a split one, 1."""

_POSITION = "sim/flightmodel/position"
_NUMBERS = (
    f"{_POSITION}/true_airspeed",
    "sim/weather/rho",
    f"{_POSITION}/alpha",
    f"{_POSITION}/beta",
    f"{_POSITION}/P",
    f"{_POSITION}/Q",
    f"{_POSITION}/R",
    "sim/flightmodel/forces/g_nrml",
    "sim/flightmodel/misc/machno",
    "sim/time/paused",
    "sim/cockpit2/annunciators/stall_warning",
)
_TRIM = {Axis.PITCH: "elevator_trim", Axis.ROLL: "aileron_trim", Axis.YAW: "rudder_trim"}
_SURFACE = {Axis.PITCH: "elv", Axis.ROLL: "ail", Axis.YAW: "rud"}
_SPLIT = {Axis.PITCH: "torque_tube_split_pitch", Axis.ROLL: "torque_tube_split_roll"}
_RATIO = {Axis.PITCH: "yoke_pitch_ratio", Axis.ROLL: "yoke_roll_ratio", Axis.YAW: "yoke_heading_ratio"}
_OVERRIDE = {Axis.PITCH: "pitch", Axis.ROLL: "roll", Axis.YAW: "heading"}


class XPlane:
    """X-Plane at an address.

    Example:
        >>> x_plane = ff.bridge.XPlane(("127.0.0.1", 49000), ff.bridge.Axis.PITCH)
        >>> x_plane.receive() is None
        True
        >>> x_plane.close()
    """

    def __init__(self, address: tuple[str, int], axis: Axis) -> None:
        self._address = address
        self._datarefs: tuple[str, ...] = (
            *_NUMBERS,
            f"sim/flightmodel2/controls/{_TRIM[axis]}",
            f"sim/operation/failures/rel_{_SURFACE[axis]}_L_jam",
        )
        self._required = range(len(self._datarefs))
        if axis in _SPLIT:  # an X-Plane that has no torque tube does not answer these
            self._datarefs += (
                f"sim/operation/failures/rel_{_SURFACE[axis]}_R_jam",
                f"sim/cockpit2/controls/{_SPLIT[axis]}",
            )
        self._ratio = f"sim/joystick/{_RATIO[axis]}"
        self._override = f"sim/operation/override/override_joystick_{_OVERRIDE[axis]}"
        self._values: dict[int, float] = {}
        self._asked_s = -RENEWED_S
        self._wire = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._wire.setblocking(False)

    def receive(self) -> SimulatorState | None:
        """The newest state; asks X-Plane for its datarefs every 5 s."""
        if time.monotonic() - self._asked_s >= RENEWED_S:
            self._ask(RATE_HZ)
        new = False
        with suppress(BlockingIOError, ConnectionRefusedError):
            while True:
                new = self._take(self._wire.recv(4096)) or new
        if not new or any(k not in self._values for k in self._required):
            return None
        speed, density, alpha, beta, p, q, r, load_factor, mach, paused, stalls, trim, jam = (
            self._values[k] for k in self._required
        )
        other_jam, split = (self._values.get(len(self._required) + k, 0.0) for k in range(2))
        jammed = jam >= FAILED or (other_jam >= FAILED and split < _SPLITS)
        numbers = {
            "dynamic_pressure": 0.5 * density * speed**2,
            "true_airspeed": speed,
            "angle_of_attack": radians(alpha),
            "sideslip": radians(beta),
            "roll_rate": radians(p),
            "pitch_rate": radians(q),
            "yaw_rate": radians(r),
            "load_factor": load_factor,
            "mach": mach,
            "tab": trim,
        }
        return SimulatorState(numbers, frozen=paused != 0, jammed=jammed, shaken=stalls != 0)

    def move(self, share: float) -> None:
        """Takes the control from X-Plane's joystick and sets it."""
        self._set(self._override, 1.0)
        self._set(self._ratio, min(1.0, max(-1.0, share)))

    def close(self) -> None:
        """Gives the control back and asks for nothing more."""
        self._set(self._override, 0.0)
        self._ask(0)
        self._wire.close()

    def _ask(self, rate_hz: int) -> None:
        self._asked_s = time.monotonic()
        for index, dataref in enumerate(self._datarefs):
            self._send(struct.pack("<5sii400s", b"RREF\0", rate_hz, index, dataref.encode()))

    def _set(self, dataref: str, value: float) -> None:
        self._send(struct.pack("<5sf500s", b"DREF\0", value, dataref.encode()))

    def _send(self, packet: bytes) -> None:
        with suppress(OSError):  # a simulator that is not there yet
            self._wire.sendto(packet, self._address)

    def _take(self, packet: bytes) -> bool:
        """Takes an answer; whether it is one, all its values numbers."""
        if packet[:4] != b"RREF" or len(packet) < 5 or (len(packet) - 5) % 8:
            return False
        values = dict(struct.iter_unpack("<if", packet[5:]))
        if not all(0 <= index < len(self._datarefs) and abs(value) < _MOST for index, value in values.items()):
            return False
        self._values.update(values)
        return True


_MOST = 1e6
"""Beyond any of these quantities; no number is not below it either."""
