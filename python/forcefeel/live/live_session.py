"""A loop under way."""

import time
from collections.abc import Mapping
from dataclasses import replace
from threading import Lock, RLock
from types import MappingProxyType, TracebackType
from typing import Literal, Self

import numpy as np
from numpy.typing import NDArray

from forcefeel.errors import InputError, expect_number
from forcefeel.laws.law import Law
from forcefeel.live.loop_settings import Loop, LoopSettings
from forcefeel.live.setup import checked_feel, feel_numbers, feel_rows
from forcefeel.live.state import COLUMNS, STATES, HostState, State, Timing, Trip, timing_of, trips_of
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import TABLE
from forcefeel.units import show

Sensor = Literal["load_cell", "drive", "column", "grip"]
SENSORS: tuple[Sensor, ...] = ("load_cell", "drive", "column", "grip")
"""The sensors, in the order of a sample."""

Fault = Literal["no_samples", "stuck", "not_a_number", "jump", "ignores_command"]
FAULTS: tuple[Fault, ...] = ("no_samples", "stuck", "not_a_number", "jump", "ignores_command")
"""What may break of a simulated machine: no samples come, a sensor stays where it is, gives no number, jumps; commands are lost."""

FADE_S = 0.5
"""Over how long a feel is faded in."""

_NAP_S = 1e-3


class LiveSession:
    """A loop under way; ``start`` makes one. Any thread may call anything of it.

    Attributes:
        columns: Names of the columns of ``history``, with their SI units at the end.
        period_s: The loop's period.
        asked: What is asked of it.
        law: The law, as it is now; of a feel that a console in another process asked for it is that process's to know.
        fade_s: Over how long a feel that is set from now on is faded in.

    Example:
        >>> import forcefeel as ff
        >>> with ff.live.start(ff.digital_elevator(), real_time=False) as running:
        ...     running.wait(100)
        ...     running.feel["feel.stiffness"] == ff.digital_elevator()["feel.stiffness"]
        True
    """

    columns = COLUMNS

    def __init__(self, loop: Loop, asked: LoopSettings, law: Law) -> None:
        self.loop = loop
        self.asked = asked
        self._designs, self._lock = Lock(), RLock()  # a stop waits for no design
        self._hand: dict[str, float | None] = {"force": 0.0, "hold_at": None}
        self.law = law
        self.period_s: float = asked.loader["controller.period"]
        self.fade_s = FADE_S

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.end()

    def end(self) -> None:
        """Ends the loop, its drive off, and closes the record; once more does nothing."""
        self.loop.end()

    # What is asked of the loop.

    def on(self) -> None:
        """Asks for power and feel; the supervisor brings the feel up."""
        self._request("on")

    def passive(self) -> None:
        """Asks for power without feel: a command of zero."""
        self._request("passive")

    def off(self) -> None:
        """Asks for no power. After a trip it must be asked for once before anything starts again."""
        self._request("off")

    def stop(self) -> None:
        """Stops, now, as an emergency stop does; ``acknowledge``, ``off`` and ``on`` start again."""
        self._request("stop")

    def acknowledge(self) -> None:
        """Clears what is latched, if it is over."""
        self._request("acknowledge")

    @property
    def loader(self) -> Loader:
        """The loader with the feel as programmed now."""
        return self.asked.loader

    @property
    def feel(self) -> Mapping[str, float]:
        """The rows of the feel as programmed now, in SI units.

        What is set is added to what there is, with values as ``Loader.replace`` takes them: numbers in SI units or text with a
        unit. The law that goes with the new feel is designed here, in the caller's thread, and both are faded in over ``fade_s``
        without a bump. Of feels that are set while one fades in, the newest comes next.

        Raises:
            InputError: If a row is none of the feel, or there is no law for it.
        """
        return MappingProxyType({key: self.loader[key] for key in TABLE if key.startswith("feel.")})

    @feel.setter
    def feel(self, rows: Mapping[str, str | float | bool | None]) -> None:
        checked_feel(rows)
        with self._designs:
            loader = self.loader.replace(rows, si=True)
            law = Law.of(self.asked.law, loader) if self.law.sampled is not None else None
            if law is not None and law.sampled is not None and self.law.sampled is not None:
                came, had = law.sampled.states, self.law.sampled.states
                if came != had:
                    raise InputError(
                        f"feel: its law has {came} states, the one of before {had}; start anew with this feel"
                    )
            observer = None if law is None or law.sampled is None else law.sampled.rows()[0]
            self._request("feel", feel_numbers(loader.si_values, observer, max(1, round(self.fade_s / self.period_s))))
            self.law = law or self.law

    @property
    def trim_rad(self) -> float:
        """Commanded neutral of the feel, rad; it goes there at ``feel.trim_rate``, at most 0.1 rad/s."""
        return self.asked.around["trim_rad"]

    @trim_rad.setter
    def trim_rad(self, angle: float) -> None:
        self._set_around("trim_rad", angle, (-np.pi, np.pi))

    @property
    def stiffness_factor(self) -> float:
        """Factor on the feel's spring, such as that of a dynamic pressure."""
        return self.asked.around["stiffness_factor"]

    @stiffness_factor.setter
    def stiffness_factor(self, factor: float) -> None:
        self._set_around("stiffness_factor", factor, (0.0, 100.0))

    @property
    def shaker(self) -> float:
        """How far the stick shaker is on, 0 to 1."""
        return self.asked.around["shaker"]

    @shaker.setter
    def shaker(self, share: float) -> None:
        self._set_around("shaker", share, (0.0, 1.0))

    def _set_around(self, name: str, value: float, within: tuple[float, float]) -> None:
        expect_number(name, value)
        low, high = within
        if not low <= value <= high:
            raise InputError(f"{name}: expected {low:g} to {high:g}, got {value:g}")
        with self._lock:
            self._request("around", list({**self.asked.around, name: float(value)}.values()))

    # What is done to a simulated machine.

    @property
    def hand_force_n(self) -> float:
        """Force of the simulated hand at the grip, N, beside the one that holds an angle."""
        return self._hand["force"] or 0.0

    @hand_force_n.setter
    def hand_force_n(self, force: float) -> None:
        expect_number("hand_force_n", force)
        if not abs(force) <= _MOST_FORCE_N:
            raise InputError(f"hand_force_n: expected at most {_MOST_FORCE_N:g} N either way, got {force:g}")
        self._disturb("force", number=float(force))

    @property
    def hand_angle_rad(self) -> float | None:
        """Angle that the simulated hand takes the grip to and holds, rad; ``None``: it lets go."""
        return self._hand["hold_at"]

    @hand_angle_rad.setter
    def hand_angle_rad(self, angle: float | None) -> None:
        if angle is not None:
            expect_number("hand_angle_rad", angle)
            if not abs(angle) <= _MOST_ANGLE_RAD:
                raise InputError(f"hand_angle_rad: expected at most {_MOST_ANGLE_RAD:g} rad either way, got {angle:g}")
        self._disturb("hold_at", number=angle)

    def inject_fault(self, fault: Fault, sensor: Sensor | None = None, by: float = 0.0) -> None:
        """Breaks something of a simulated machine.

        Args:
            fault: One of ``FAULTS``.
            sensor: Which of ``SENSORS``, for ``stuck``, ``not_a_number`` and ``jump``.
            by: By how much a sensor jumps: N, m of the drive's end, rad of the column.

        Raises:
            InputError: If the machine is not simulated, or there is no such fault.
        """
        if fault not in FAULTS or (sensor or SENSORS[0]) not in SENSORS:
            raise InputError(
                f"fault: expected one of {', '.join(FAULTS)}, of a sensor out of {', '.join(SENSORS)}, got {show(fault)} of "
                f"{show(sensor)}"
            )
        if (sensor is None) != (fault in ("no_samples", "ignores_command")):
            raise InputError(
                f"sensor: {fault} is of {'no' if sensor else 'one'} sensor; give {'none' if sensor else 'which'}"
            )
        expect_number("by", by)
        # A sample has the column's angle as the displacement of its base.
        scale = self.loader["column.base_arm"] if sensor == "column" else 1.0
        self._disturb(fault, SENSORS.index(sensor or SENSORS[0]), float(by) * scale)

    def clear_faults(self) -> None:
        """All of a simulated machine is well again."""
        self._disturb("repair")

    @property
    def fault(self) -> str:
        """What is broken of a simulated machine, the last of it; empty if nothing is."""
        return self.asked.fault

    # What was asked for, here or by a console in another process.

    def take_request(self, name: str, numbers: list[float]) -> bool:
        """Passes a request to the loop by name and numbers; whether the loop had room for it."""
        with self._lock:
            taken = self.loop.request(name, numbers)
            if taken and name == "feel":
                self.asked = replace(self.asked, loader=self.loader.replace(feel_rows(numbers, self.loader), si=True))
            elif taken and name == "around":
                self.asked = replace(self.asked, around=dict(zip(self.asked.around, numbers, strict=True)))
        return taken

    def take_disturbance(self, name: str, sensor: int, number: float | None) -> bool:
        """The same with what is done to a simulated machine."""
        with self._lock:
            taken = self.loop.disturb(name, sensor, number)
            if taken and name in self._hand:
                self._hand[name] = number
            elif taken:
                self.asked = replace(self.asked, fault="" if name == "repair" else name)
        return taken

    # What is seen of it.

    @property
    def state(self) -> State:
        """How it does."""
        cycles, beats, missed, silent, lost, state, trips, ended = self.loop.status()
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
        )

    @property
    def trips(self) -> tuple[Trip, ...]:
        """The trips that are there or latched, with what happened and what to do."""
        return trips_of(self.loop.status()[6])

    @property
    def host(self) -> HostState | None:
        """The aircraft simulator as it is heard; ``None`` where none is listened to."""
        if (status := self.loop.host_status()) is None:
            return None
        listens, packets, refused, last = status
        newest = self.loop.history(-1.0, 1)
        share = float(newest[0, COLUMNS.index("host_share")]) if len(newest) else 0.0
        address, silent_s = last or ("", None)
        return HostState(listens, address, packets, refused, silent_s, share)

    def history(self, since: float = -1, most: int | None = None) -> NDArray[np.float64]:
        """A row for each cycle after cycle ``since`` that is still kept, the newest ``most`` of them; (rows, columns).

        To go on where the last call ended, give the ``cycle`` of its last row.
        """
        return self.loop.history(float(since), _ALL if most is None else max(0, int(most)))

    @property
    def timing(self) -> Timing:
        """When the loop's thread did its work, since the start."""
        return timing_of(*self.loop.timing(), self.period_s)

    @property
    def realtime_status(self) -> tuple[str, ...]:
        """What the system gave the loop's thread, a sentence each; nothing in virtual time."""
        if (refused := self.loop.refused()) is None:
            return ()
        return tuple(
            given if why is None else f"{not_given} ({why}): {remedy}, or run as root"
            for why, (given, not_given, remedy) in zip(refused, _GRANTS, strict=True)
        )

    def wait(self, cycles: int, timeout_s: float = 60.0) -> None:
        """Waits until so many more cycles are in the history, or the loop has ended.

        Raises:
            InputError: If that takes longer than ``timeout_s``.
        """
        # From where the loop is, which may be ahead of its history: what was asked for just now is within the cycles waited for.
        goal = self.loop.status()[0] - 1 + cycles
        until = time.monotonic() + timeout_s
        while self._last_cycle() < goal:
            if self.loop.status()[-1]:
                self.end()  # the last rows are there when its threads are done
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
        if not self.asked.simulated:
            raise InputError(
                f"{name}: only a simulated machine has a hand and faults; this one is real, or is another process's"
            )
        if not self.take_disturbance(name, sensor, number):
            raise InputError(
                "the loop takes no disturbances: its ring is full; the loop has ended, or 64 came within a cycle"
            )


_ALL = 2**62
_GRANTS = (
    ("runs first in, first out, at real-time priority", "runs without priority", "give the user an rtprio limit"),
    ("its memory is locked", "its memory is not locked", "give the user a larger memlock limit"),
    (
        "the processor stays awake between cycles",
        "the processor may sleep between cycles and wake late",
        "let the user write /dev/cpu_dma_latency",
    ),
)
"""What the loop asks of the system: the sentence where it is given, where it is not, and the remedy."""

_MOST_FORCE_N = 2000.0
_MOST_ANGLE_RAD = 1.5
