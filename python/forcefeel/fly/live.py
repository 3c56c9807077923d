"""A flight in real time beside a running loop, whose host is the aircraft.

The aircraft is flown in frames of 2 ms up to the time of the clock; the packets of ``docs/reference/host.md`` carry its state to
the loop and the control's angle back, at 60 Hz.
"""

import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from math import radians

from forcefeel.bridge import BridgeReport, BridgeSettings, SimulatorState, bridge
from forcefeel.errors import InputError
from forcefeel.fly.aircraft import FRAME_S, Aircraft
from forcefeel.live.flight_controls import READINGS, Lever
from forcefeel.live.live_session import LiveSession
from forcefeel.units import ANGLE, PERCENT

_SETTINGS = BridgeSettings(travel_rad=1.0, tab_rad=1.0)
"""Control and tab pass as angles in rad."""

_TAB_RAD = radians(20.0)
_TRIM_SHARE = 0.3
_LONGEST_S = 0.1
"""Time that a flight makes up for after a busy machine held it up; the rest is lost."""

_FROZEN_S, _STANDS_S = 0.2, 1.5
"""After a return to the trimmed flight the loader is frozen (ARINC 610), takes up its feel there in a second, and is flown on."""


class LiveFlight:
    """An aircraft in real time: the simulator of a bridge, and the flight of a console.

    Args:
        trimmed: Makes the aircraft in its trimmed flight.

    Attributes:
        report: What its bridge did.

    Example:
        >>> flight = ff.fly.LiveFlight(lambda: ff.fly.Aircraft("c172p", 51.4, 900.0))
        >>> sorted(flight.levers)
        ['tab', 'throttle']
        >>> flight.set_lever("tab", 0.02)
    """

    def __init__(self, trimmed: Callable[[], Aircraft]) -> None:
        self._trimmed, self.report = trimmed, BridgeReport()
        aircraft = self._aircraft = trimmed()
        self.levers: Mapping[str, Lever] = _levers(aircraft)
        self._positions = {"throttle": aircraft.throttle}
        self._angle, self._flown_s, self._frozen_until = 0.0, time.monotonic(), 0.0
        self._restarts = threading.Event()
        self._seen = aircraft.state() | aircraft.attitude()

    # For the console, from any thread.

    def readings(self) -> dict[str, float]:
        """Quantities of ``READINGS`` and positions of the levers, SI units; ``refused``: 1 where the loader refused the flight."""
        seen = self._seen
        positions = {name: self._positions.get(name, 0.0) for name in self.levers}
        return {name: seen[name] for name in READINGS} | positions | {"refused": float(self.report.refused)}

    def set_lever(self, name: str, position: float) -> None:
        """Move a lever of ``levers``.

        Raises:
            InputError: If the aircraft has no such lever, or the position is out of its range.
        """
        lever = self.levers.get(name)
        if lever is None:
            raise InputError(f"lever: {self._aircraft.name} has {', '.join(self.levers)}, got {name!r}")
        if not lever.low <= position <= lever.high:
            raise InputError(f"{name}: expected {lever.low:.4g} to {lever.high:.4g}, got {position:.4g}")
        self._positions = self._positions | {name: position}

    def restart(self) -> None:
        """Return to the trimmed flight, levers included."""
        self._restarts.set()

    # For the bridge, from its thread.

    def receive(self) -> SimulatorState | None:
        """The state of the flight now."""
        if self._restarts.is_set():
            self._restarts.clear()
            self._return()
        now = time.monotonic()
        self._flown_s = max(self._flown_s, now - _LONGEST_S)
        try:
            while self._flown_s + FRAME_S <= now:
                self._flown_s += FRAME_S
                self._frame()
            state = self._aircraft.state()
        except InputError:  # the aircraft is beyond its model: on the ground, or torn apart
            self._return()
            state = self._aircraft.state()
        self._seen = state | self._aircraft.attitude()
        return SimulatorState(state, frozen=now < self._frozen_until)

    def move(self, share: float) -> None:
        """Take the control's angle, rad."""
        self._angle = share

    def close(self) -> None:
        """The flight ends with its bridge."""

    def _frame(self) -> None:
        aircraft, positions = self._aircraft, self._positions
        aircraft.set_throttle(positions["throttle"])
        aircraft.tab_rad = positions.get("tab", 0.0)
        if aircraft.axis == "pitch":
            aircraft.set_bank(0.0)
        aircraft.fly(aircraft.trimmed + positions.get("trim", 0.0) + aircraft.per_angle * self._angle)

    def _return(self) -> None:
        self._aircraft = self._trimmed()
        self._positions = {"throttle": self._aircraft.throttle}
        now = time.monotonic()
        self._frozen_until, self._flown_s = now + _FROZEN_S, now + _STANDS_S


def _levers(aircraft: Aircraft) -> dict[str, Lever]:
    """Trim tab of a surface, trim of a command, throttle."""
    reversible = aircraft.data.full_travel_rad is None
    trim = {} if reversible else {"trim": Lever("trim of the command", PERCENT, -_TRIM_SHARE, _TRIM_SHARE)}
    if "per_tab" in aircraft.data.surface:
        trim = {"tab": Lever("trim tab", ANGLE, -_TAB_RAD, _TAB_RAD)}
    return {**trim, "throttle": Lever("throttle", PERCENT, 0.0, 1.0)}


@contextmanager
def fly_live(session: LiveSession, flight: LiveFlight) -> Iterator[None]:
    """Fly an aircraft as the host of a running loop, which shows it on its console.

    Args:
        session: The loop, with a host port; its loader is that of ``with_surface``.
        flight: The flight.

    Raises:
        InputError: If the loop has no host port.

    Example:
        >>> flight = ff.fly.LiveFlight(lambda: ff.fly.Aircraft("c172p", 51.4, 900.0))
        >>> loader = ff.fly.with_surface(ff.digital_elevator(), ff.fly.Aircraft("c172p", 51.4, 900.0))
        >>> with ff.live.start(loader, "robust", host=0) as session, ff.fly.fly_live(session, flight):
        ...     session.wait(400)
        >>> flight.report.states > 0
        True
    """
    if session.host is None:
        raise InputError("session: has no port for an aircraft; start it with host=0")
    address, _, port = session.host.listens.rpartition(":")
    ends = threading.Event()
    arguments = (flight, (address, int(port)), _SETTINGS, ends.is_set, flight.report)
    thread = threading.Thread(target=bridge, args=arguments, name="forcefeel flight", daemon=True)
    session.flight = flight
    thread.start()
    try:
        yield
    finally:
        ends.set()
        thread.join()
        session.flight = None
