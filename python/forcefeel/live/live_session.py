"""A running loop."""

import time
from collections.abc import Mapping
from dataclasses import replace
from threading import Lock, RLock
from types import MappingProxyType
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel.envelope.forbidden import REASONS
from forcefeel.envelope.softening import soften
from forcefeel.errors import InputError, expect_number
from forcefeel.laws.law import Law
from forcefeel.live.ending import EndsWithBlock
from forcefeel.live.flight_controls import FlightControls
from forcefeel.live.loop_settings import Loop, LoopSettings
from forcefeel.live.setup import checked_feel, feel_numbers, feel_rows
from forcefeel.live.state import COLUMNS, STATES, HostState, State, Timing, Trip, timing_of, trips_of
from forcefeel.loader.links import LinkKind
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import TABLE
from forcefeel.loader.softened_feel import SoftenedFeel
from forcefeel.units import show

Sensor = Literal["load_cell", "drive", "column", "grip"]
SENSORS: tuple[Sensor, ...] = ("load_cell", "drive", "column", "grip")
"""Sensors in the order of a sample."""

Fault = Literal[
    "no_samples", "late", "stuck", "not_a_number", "jump", "spike", "reversed", "ignores_command", "hardover"
]
FAULTS: tuple[Fault, ...] = get_args(Fault)
"""Faults of a simulated machine: no samples, late ones; a sensor that is stuck, returns NaN, jumps, for one
sample or for good, or has its sign reversed; lost commands; a drive that has one command for good."""

OF_A_SENSOR: tuple[Fault, ...] = ("stuck", "not_a_number", "jump", "spike", "reversed")
"""Faults of a sensor."""

FADE_S = 0.5
"""Default fade time of a feel."""

_NAP_S = 1e-3


def programmed(softened: SoftenedFeel) -> tuple[float, int]:
    """``LoopSettings.programmed`` of a feel."""
    return softened.requested_n_m_per_rad, REASONS.index(softened.reason) if softened.reason else -1


class LiveSession(EndsWithBlock):
    """A running loop, from ``start``; thread-safe.

    Attributes:
        columns: Column names of ``history``, with SI units as suffix.
        period_s: Period of the loop, s.
        settings: Requested settings of the loop.
        law: The current law; it does not follow a feel that a console in another process requests.
        fade_s: Fade time of feels set later, s.
        flight: The flight that its console shows, as of ``fly.fly_live``; ``None`` without one.

    Example:
        >>> with ff.live.start(ff.digital_elevator(), real_time=False) as running:
        ...     running.wait(100)
        ...     running.feel["feel.stiffness"] == ff.digital_elevator()["feel.stiffness"]
        True
    """

    columns = COLUMNS

    def __init__(self, loop: Loop, settings: LoopSettings, law: Law) -> None:
        self.loop = loop
        self.settings = settings
        self._designs, self._lock = Lock(), RLock()  # separate locks, so that a stop never waits for a design
        self._hand: dict[str, float | None] = {"force": 0.0, "hold_at": None}
        self.law = law
        self.period_s: float = settings.loader["controller.period"]
        self.fade_s = FADE_S
        self.flight: FlightControls | None = None

    def end(self) -> None:
        """End the loop with the drive off and close the record; further calls do nothing."""
        self.loop.end()

    # Requests to the loop.

    def on(self) -> None:
        """Request power and feel; the supervisor fades the feel in."""
        self._request("on")

    def passive(self) -> None:
        """Request power without feel: a command of zero."""
        self._request("passive")

    def off(self) -> None:
        """Request no power. After a trip, a restart requires this first."""
        self._request("off")

    def stop(self) -> None:
        """Stop immediately, like an emergency stop; ``acknowledge``, ``off`` and ``on`` restart."""
        self._request("stop")

    def acknowledge(self) -> None:
        """Clear latched trips whose cause is gone."""
        self._request("acknowledge")

    def accept_host(self) -> None:
        """Let the sender in ``host.waiting`` take over from the silent aircraft simulator.

        Raises:
            InputError: If no other sender waits.
        """
        if not self.loop.request("accept_host", []):
            raise InputError(
                "host: expected another sender after the simulator's silence of 1 s, got none; see session.host"
            )

    @property
    def loader(self) -> Loader:
        """The loader with the current feel."""
        return self.settings.loader

    @property
    def feel(self) -> Mapping[str, float]:
        """Rows of the current feel, in SI units.

        New rows are merged with the current ones; values are as in ``Loader.replace``: numbers in SI units or text with a unit.
        The law for the new feel is designed in the caller's thread. Both are faded in over ``fade_s`` without a bump. Of feels set
        during a fade, only the newest follows.

        Raises:
            InputError: If a row does not belong to the feel, or the law cannot be designed for it.
        """
        return MappingProxyType({key: self.loader[key] for key in TABLE if key.startswith("feel.")})

    @feel.setter
    def feel(self, rows: Mapping[str, str | float | bool | None]) -> None:
        checked_feel(rows)
        with self._designs:
            loader = self.loader.replace(rows, si=True)
            softened = soften(loader) if self.settings.soften else None
            loader = softened.loader if softened else loader
            had = self.law.sampled
            law = self.law if had is None else Law.of(self.settings.law, loader)
            if had is not None and law.sampled is not None and law.sampled.states != had.states:
                raise InputError(
                    f"feel: expected a law with {had.states} states, as before, got {law.sampled.states}; restart with this feel"
                )
            observer = None if law.sampled is None else law.sampled.rows()[0]
            if softened:
                self._request("softened", list(programmed(softened)))
            self._request("feel", feel_numbers(loader.si_values, observer, max(1, round(self.fade_s / self.period_s))))
            self.law = law

    @property
    def softened(self) -> SoftenedFeel | None:
        """What became of the programmed feel where the loop softens it; ``None`` where it does not."""
        stiffness, reason = self.settings.programmed
        return (
            SoftenedFeel(self.loader, stiffness, "" if reason < 0 else REASONS[reason])
            if self.settings.soften
            else None
        )

    @property
    def trim_rad(self) -> float:
        """Commanded neutral of the feel, rad; approached at ``feel.trim_rate``, at most 0.1 rad/s."""
        return self.settings.around["trim_rad"]

    @trim_rad.setter
    def trim_rad(self, angle: float) -> None:
        self._set_around("trim_rad", angle, (-np.pi, np.pi))

    @property
    def stiffness_factor(self) -> float:
        """Factor on the feel's spring, for example from dynamic pressure."""
        return self.settings.around["stiffness_factor"]

    @stiffness_factor.setter
    def stiffness_factor(self, factor: float) -> None:
        self._set_around("stiffness_factor", factor, (0.0, 100.0))

    @property
    def shaker(self) -> float:
        """Amplitude of the stick shaker, 0 to 1."""
        return self.settings.around["shaker"]

    @shaker.setter
    def shaker(self, share: float) -> None:
        self._set_around("shaker", share, (0.0, 1.0))

    def _set_around(self, name: str, value: float, within: tuple[float, float]) -> None:
        expect_number(name, value)
        low, high = within
        if not low <= value <= high:
            raise InputError(f"{name}: expected {low:g} to {high:g}, got {value:g}")
        with self._lock:
            self._request("around", list({**self.settings.around, name: float(value)}.values()))

    # Inputs of a simulated machine.

    @property
    def hand_force_n(self) -> float:
        """Force of the simulated hand at the grip, N, in addition to the one that holds an angle."""
        return self._hand["force"] or 0.0

    @hand_force_n.setter
    def hand_force_n(self, force: float) -> None:
        expect_number("hand_force_n", force)
        if not abs(force) <= _MOST_FORCE_N:
            raise InputError(f"hand_force_n: expected at most {_MOST_FORCE_N:g} N either way, got {force:g}")
        self._disturb("force", number=float(force))

    @property
    def hand_angle_rad(self) -> float | None:
        """Angle to which the simulated hand moves and holds the grip, rad; ``None``: released."""
        return self._hand["hold_at"]

    @hand_angle_rad.setter
    def hand_angle_rad(self, angle: float | None) -> None:
        if angle is not None:
            expect_number("hand_angle_rad", angle)
            if not abs(angle) <= _MOST_ANGLE_RAD:
                raise InputError(f"hand_angle_rad: expected at most {_MOST_ANGLE_RAD:g} rad either way, got {angle:g}")
        self._disturb("hold_at", number=angle)

    def inject_fault(self, fault: Fault, sensor: Sensor | None = None, by: float = 0.0) -> None:
        """Inject a fault into a simulated machine.

        Args:
            fault: One of ``FAULTS``.
            sensor: One of ``SENSORS``, for ``OF_A_SENSOR``.
            by: Jump or spike of the sensor: N, m at the drive's end, rad of the column; of ``late`` cycles, of ``hardover`` the
                command, V or A.

        Raises:
            InputError: If the machine is not simulated, or the fault is unknown.
        """
        if fault not in FAULTS or (sensor or SENSORS[0]) not in SENSORS:
            raise InputError(
                f"fault: expected one of {', '.join(FAULTS)}, of a sensor out of {', '.join(SENSORS)}, got {show(fault)} of "
                f"{show(sensor)}"
            )
        if (sensor is None) != (fault not in OF_A_SENSOR):
            raise InputError(
                f"sensor: {fault} requires {'no' if sensor else 'a'} sensor; {'omit it' if sensor else 'add one'}"
            )
        expect_number("by", by)
        # A sample contains the column's angle as displacement of its base.
        scale = self.loader["column.base_arm"] if sensor == "column" else 1.0
        self._disturb(fault, SENSORS.index(sensor or SENSORS[0]), float(by) * scale)

    def clear_faults(self) -> None:
        """Clear all faults of a simulated machine."""
        self._disturb("repair")

    @property
    def fault(self) -> str:
        """The last fault of a simulated machine; empty without a fault."""
        return self.settings.fault

    # The link to another axis.

    def disconnect(self) -> None:
        """Open the link of this axis: an electronic one, or the shaft between two simulated machines.

        Raises:
            InputError: If the axis has no link, or the shaft belongs to real machines.
        """
        self._set_link(0.0)

    def connect(self) -> None:
        """Close the link of this axis that was opened or has uncoupled.

        Raises:
            InputError: As ``disconnect``.
        """
        self._set_link(1.0)

    @property
    def priority(self) -> bool:
        """Whether the priority button of this axis is pressed. While it is, the other side of an electronic link follows."""
        return self.settings.priority

    @priority.setter
    def priority(self, pressed: bool) -> None:
        link = self.settings.link
        if link is None or link.kind is not LinkKind.ELECTRONIC:
            raise InputError("priority: is of an electronic link between two pilots, and this axis has none")
        self._request("priority", [float(pressed)])

    def _set_link(self, holds: float) -> None:
        link = self.settings.link
        if link is None:
            raise InputError("link: this axis has none; add one to the table [links] of a project file")
        if link.kind is LinkKind.ELECTRONIC:
            self._request("link", [holds])
        else:
            self._disturb("link", number=holds)

    # Requests from here or from a console in another process.

    def take_request(self, name: str, numbers: list[float]) -> bool:
        """Pass a request to the loop by name and numbers; return whether its ring had space."""
        with self._lock:
            if name == "softened":  # of the feel that follows
                self.settings = replace(self.settings, programmed=(numbers[0], int(numbers[1])))
            taken = self.loop.request(name, numbers)
            if taken and name == "feel":
                self.settings = replace(
                    self.settings, loader=self.loader.replace(feel_rows(numbers, self.loader), si=True)
                )
            elif taken and name == "around":
                self.settings = replace(self.settings, around=dict(zip(self.settings.around, numbers, strict=True)))
            elif taken and name == "link":
                self.settings = replace(self.settings, link_holds=bool(numbers[0]))
            elif taken and name == "priority":
                self.settings = replace(self.settings, priority=bool(numbers[0]))
        return taken

    def take_disturbance(self, name: str, sensor: int, number: float | None) -> bool:
        """Pass an input to a simulated machine; return whether the ring had space."""
        with self._lock:
            taken = self.loop.disturb(name, sensor, number)
            if taken and name in self._hand:
                self._hand[name] = number
            elif taken and name == "link":
                self.settings = replace(self.settings, link_holds=bool(number))
            elif taken:
                self.settings = replace(self.settings, fault="" if name == "repair" else name)
        return taken

    # Observed state.

    @property
    def state(self) -> State:
        """Snapshot of the loop."""
        cycles, beats, missed, silent, lost, state, trips, fault, ended = self.loop.status()
        recorded, unrecorded, record_ended = self.loop.recorded()
        return State(
            cycle=cycles,
            time_s=beats * self.period_s,
            name=STATES[state],
            trips=tuple(trip.name for trip in trips_of(trips)),
            missed=missed,
            silent=silent,
            lost_rows=lost,
            recorded=recorded,
            unrecorded_rows=unrecorded,
            record_ended=record_ended or "",
            ended=ended,
            drive_fault="; ".join(_core.drive_fault(fault) or ()),
        )

    @property
    def trips(self) -> tuple[Trip, ...]:
        """Active and latched trips, with cause and remedy."""
        return trips_of(self.loop.status()[6])

    @property
    def host(self) -> HostState | None:
        """State of the aircraft simulator; ``None`` without a host port."""
        if (status := self.loop.host_status()) is None:
            return None
        listens, (packets, refused, softened), last, waiting = status
        newest = self.loop.history(-1.0, 1)
        share = float(newest[0, COLUMNS.index("host_share")]) if len(newest) else 0.0
        address, silent_s = last or ("", None)
        return HostState(listens, address, packets, refused, silent_s, share, waiting or "", softened)

    def history(self, since: float = -1, most: int | None = None) -> NDArray[np.float64]:
        """A row for each stored cycle after cycle ``since``, at most the newest ``most``; (rows, columns).

        To continue after the last call, pass the ``cycle`` of its last row.
        """
        return self.loop.history(float(since), _ALL if most is None else max(0, int(most)))

    @property
    def timing(self) -> Timing:
        """Timing of the loop's thread since the start."""
        return timing_of(*self.loop.timing(), self.period_s)

    @property
    def realtime_status(self) -> tuple[str, ...]:
        """A sentence on each real-time property of the loop's thread; empty in virtual time."""
        if (refused := self.loop.refused()) is None:
            return ()
        return tuple(
            granted if why is None else f"{not_given} ({why}): {remedy}"
            for why, (granted, not_given, remedy) in zip(refused, _GRANTS, strict=True)
        )

    def wait(self, cycles: int, timeout_s: float = 60.0) -> None:
        """Wait until the history has ``cycles`` further cycles, or the loop has ended.

        Raises:
            InputError: If that takes longer than ``timeout_s``.
        """
        # Counted from the loop, which may be ahead of its history, so that the cycles include the effect of the last request.
        goal = self.loop.status()[0] - 1 + cycles
        until = time.monotonic() + timeout_s
        while self._last_cycle() < goal:
            if self.loop.status()[-1]:
                self.end()  # the last rows are complete when its threads have ended
                return
            if time.monotonic() > until:
                raise InputError(
                    f"cycles: {cycles} took longer than the {timeout_s:g} s of timeout_s; the loop is stuck or slow"
                )
            time.sleep(_NAP_S)

    def _last_cycle(self) -> int:
        newest = self.loop.history(-1.0, 1)
        return int(newest[0, COLUMNS.index("cycle")]) if len(newest) else -1

    def _request(self, name: str, numbers: list[float] | None = None) -> None:
        if not self.take_request(name, numbers or []):
            raise InputError(
                "the loop takes no requests: its ring is full; the loop has ended, or 64 came within a cycle"
            )

    def _disturb(self, name: str, sensor: int = 0, number: float | None = None) -> None:
        if not self.settings.simulated:
            raise InputError(
                f"{name}: requires a simulated machine in this process; this one is real or belongs to another process"
            )
        if not self.take_disturbance(name, sensor, number):
            raise InputError(
                "the loop takes no disturbances: its ring is full; the loop has ended, or 64 came within a cycle"
            )


_ALL = 2**62
_GRANTS = (
    (
        "runs first in, first out, at real-time priority",
        "runs without priority",
        "give the user an rtprio limit, or run as root",
    ),
    ("its memory is locked", "its memory is not locked", "give the user a larger memlock limit, or run as root"),
    (
        "the processor stays awake between cycles",
        "the processor may sleep between cycles and wake late",
        "let the user write /dev/cpu_dma_latency, or run as root",
    ),
    (
        "stays on an isolated processor",
        "shares its processors with other work",
        "add isolcpus=1 nohz_full=1 to the kernel's command line",
    ),
)
"""Real-time properties: sentence if granted, sentence if refused, and remedy."""

_MOST_FORCE_N = 2000.0
_MOST_ANGLE_RAD = 1.5
