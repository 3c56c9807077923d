"""Session of a console: commands from watchers to the loop, frames and notices to watchers.

A change of the feel and a test of the rule take longer and run in threads; all other commands are executed at once. Of feels
requested during a change, only the newest follows.
"""

import asyncio
import json
import time
from collections.abc import Awaitable, Callable, Coroutine
from contextlib import suppress
from threading import Event
from types import TracebackType
from typing import Any, Self

from websockets.asyncio.server import ServerConnection

from forcefeel.errors import InputError
from forcefeel.live.console.admission import Role
from forcefeel.live.console.commands import (
    FOR_ALL,
    Around,
    Break,
    Command,
    FeelChange,
    Hand,
    MoveLever,
    Plain,
    RuleTest,
)
from forcefeel.live.console.description import description, feel_json, host_json
from forcefeel.live.console.ipc import LAPSES_S
from forcefeel.live.console.programmed import Programmed
from forcefeel.live.console.simulated_pilot import Aborted, SimulatedPilot
from forcefeel.live.console.telemetry import Telemetry, channels
from forcefeel.live.console.timing import timing_json
from forcefeel.live.console.verdict_json import verdict_json
from forcefeel.live.console.watchers import Watcher, Watchers
from forcefeel.live.flight_controls import FlightControls
from forcefeel.live.live_session import LiveSession
from forcefeel.qualification.plan.run import QualificationSetup
from forcefeel.qualification.throw import Throw
from forcefeel.units import Json

HAND_LAPSES_S = LAPSES_S
"""A hand without a command for this long is released: its page or network is gone."""

HELD_UP_S = 1.5
"""A server that was blocked for this long discards all commands of that time except a stop."""

_STATUS_EACH, _TIMING_EACH = 6, 30
"""Ticks between two notices."""


class ConsoleSession:
    """Session of one loop.

    Args:
        running: The loop.
        setup: Rule of the tests, and displayed units.
        watchers: Connected clients.
    """

    def __init__(self, running: LiveSession, setup: QualificationSetup, watchers: Watchers) -> None:
        self.watchers = watchers
        self._running, self._setup, self._ticks = running, setup, 0
        loader, displayed = running.loader, channels(running, running.loader, running.settings.link)
        throw = Throw.of(loader, setup.throw_rad)
        self._telemetry = Telemetry(running, displayed, setup.system)
        self._description = description(running, displayed, (throw.low_rad, throw.high_rad), setup.system)
        self._has_hand = _has_hand(running)
        self._description["hand"] = self._has_hand
        self._hand_until, self._ticked = 0.0, time.monotonic()
        self._rows: dict[str, float | None] = {}
        self._feel_asked, self._curve_asked = asyncio.Event(), asyncio.Event()
        self._programmed: Programmed | None = None
        self._test: asyncio.Task[None] | None = None
        self._test_ended = Event()
        self._progress: dict[str, Json] = {}

    async def __aenter__(self) -> Self:
        """Open the session."""
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, where: TracebackType | None
    ) -> None:
        """Close the session, abort a test and release the hand."""
        self._break_off()
        self._let_go()

    def works(self) -> tuple[Coroutine[None, None, None], ...]:
        """Background tasks for the time that the session is open."""
        return (_whenever(self._feel_asked, self._change_feel), _whenever(self._curve_asked, self._draw_curve))

    # Watchers connect and disconnect.

    def join(self, connection: ServerConnection, role: Role) -> Watcher:
        """Add a watcher and send it the description."""
        watcher = self.watchers.add(connection, role)
        if self._programmed is None:
            self._curve_asked.set()
        self.watchers.post_to(
            watcher, {"kind": "hello", "you": watcher.number, "role": role.value, **self._description}
        )
        self._post_status()
        return watcher

    def leave(self, watcher: Watcher) -> None:
        """Remove a watcher; if it held control, release the hand and abort a test."""
        if self.watchers.remove(watcher):
            self._freed()

    # Commands.

    def carry_out(self, watcher: Watcher, command: Command) -> None:
        """Execute a command.

        Raises:
            InputError: If the watcher has no right, or the command cannot be executed, with the reason.
        """
        self._look_back()
        if watcher.outdated and command.do != "stop":
            raise InputError("the console was blocked and discards commands of that time; send it again")
        if command.do not in FOR_ALL and self.watchers.holder is not watcher:
            self.watchers.take(watcher)  # free control goes to the first command
        match command:
            case Plain():
                self._plain(watcher, command.do)
            case FeelChange():
                self._rows |= command.rows
                self._feel_asked.set()
            case Around():
                for name in ("trim_rad", "stiffness_factor", "shaker"):
                    if (value := getattr(command, name)) is not None:
                        setattr(self._running, name, value)
            case MoveLever():
                self._flight().set_lever(command.name, command.position)
            case Hand():
                self._hand(command)
            case Break():
                self._running.inject_fault(command.fault, command.sensor, command.by)
            case RuleTest():
                self._begin(command)
        if not isinstance(command, Hand):
            self._post_status()

    def _plain(self, watcher: Watcher, what: str) -> None:
        match what:
            case "take":
                self.watchers.take(watcher)
            case "give":
                if self.watchers.give(watcher):
                    self._freed()
            case "stop":
                self._running.stop()
                self._break_off()
                self._let_go()
            case "off":
                self._break_off()
                self._running.off()
            case "abort":
                self._break_off()
            case "repair":
                self._running.clear_faults()
            case "restart_flight":
                self._flight().restart()
            case "take_priority" | "give_priority":
                self._running.priority = what == "take_priority"
            case "on" | "acknowledge" | "accept_host" | "connect" | "disconnect":
                getattr(self._running, what)()

    def _flight(self) -> FlightControls:
        if self._running.flight is None:
            raise InputError("no aircraft is flown beside this loop; start forcefeel run with --aircraft")
        return self._running.flight

    def _hand(self, hand: Hand) -> None:
        if self._test is not None:
            raise InputError("a test is running and uses the hand; abort it first")
        self._running.hand_angle_rad = hand.angle_rad
        self._running.hand_force_n = hand.force_n or 0.0
        holds = hand.force_n is not None or hand.angle_rad is not None
        self._hand_until = time.monotonic() + HAND_LAPSES_S if holds else 0.0

    def _let_go(self) -> None:
        self._hand_until = 0.0
        with suppress(InputError):  # the loop has ended, or the machine is real
            self._running.hand_angle_rad = None
            self._running.hand_force_n = 0.0

    def _freed(self) -> None:
        self._break_off()
        if self._hand_until:
            self._let_go()
        self._post_status()

    # Background tasks.

    async def _change_feel(self) -> None:
        rows, self._rows = self._rows, {}

        def change() -> None:
            self._running.feel = rows

        try:
            await asyncio.to_thread(change)
        except InputError as error:
            self.watchers.post("feel", _text(kind="refused", reason=str(error), number=self._ticks))
        self._curve_asked.set()
        self._post_status()

    async def _draw_curve(self) -> None:
        try:
            self._programmed = await asyncio.to_thread(Programmed.of, self._running.loader, self._setup)
            text = _text(kind="curve", curve=self._programmed.as_json(self._setup.system))
        except InputError as error:
            self._programmed = None
            text = _text(kind="curve", curve=None, reason=str(error))
        self.watchers.post("curve", text)

    def _begin(self, test: RuleTest) -> None:
        if not self._has_hand:
            raise InputError(
                "only a simulated machine has a hand; record a manual test and pass it to qualify --record"
            )
        if self._test is not None:
            raise InputError("a test is running; abort it first")
        self._test_ended = Event()
        self._test = asyncio.create_task(self._make(test, self._test_ended))

    async def _make(self, test: RuleTest, ended: Event) -> None:
        self._let_go()
        result: dict[str, Json] = {"test": test.test}
        loop = asyncio.get_running_loop()

        def tell(what: str, share: float) -> None:
            loop.call_soon_threadsafe(self._progressed, test.test, what, share)

        try:
            programmed = await asyncio.to_thread(Programmed.of, self._running.loader, self._setup)
            by_hand = SimulatedPilot(self._running, self._setup, programmed, tell, ended)
            make = by_hand.sweep if test.test == "sweep" else lambda: by_hand.release(test.side)
            qualification = await asyncio.to_thread(make)
            result["judged"] = await asyncio.to_thread(verdict_json, qualification)
        except (Aborted, InputError) as error:
            result["reason"] = str(error)
        finally:
            self._test, self._progress = None, {}
        self.watchers.post("test", _text(kind="test", at=self._running.state.time_s, **result))
        self._post_status()

    def _progressed(self, test: str, what: str, share: float) -> None:
        if self._test is not None:
            self._progress = {"test": test, "what": what, "share": round(share, 3)}

    def _break_off(self) -> None:
        self._test_ended.set()

    def _look_back(self) -> None:
        """After a blocked time, abort the test, release the hand and reconnect all watchers, so that no command runs late."""
        before, self._ticked = self._ticked, time.monotonic()
        if self._ticked - before > HELD_UP_S:
            self._break_off()
            self._let_go()
            self.watchers.turn_out()

    # Frames and notices.

    def tick(self) -> None:
        """Send new data to all watchers."""
        self._look_back()
        self._ticks += 1
        if self._hand_until and time.monotonic() > self._hand_until:
            self._let_go()
        if not len(self.watchers):
            return
        if self._ticks % _STATUS_EACH == 0:
            self._post_status()
        if self._ticks % _TIMING_EACH == 0:
            self.watchers.post("timing", _text(kind="timing", **timing_json(self._running.timing)))
        self.watchers.send(self._telemetry.frame())

    def _post_status(self) -> None:
        running, holder = self._running, self.watchers.holder
        state = running.state
        self.watchers.post(
            "status",
            _text(
                kind="status",
                state=state.name,
                missed=state.missed,
                record_ended=state.record_ended,
                ended=state.ended,
                drive_fault=state.drive_fault,
                trips=[{"name": trip.name, "sentence": trip.sentence} for trip in running.trips],
                holder=holder and holder.number,
                watchers=len(self.watchers),
                feel=feel_json(running),
                trim_rad=running.trim_rad,
                stiffness_factor=running.stiffness_factor,
                shaker=running.shaker,
                fault=running.fault,
                softened=running.softened.sentence(self._setup.system) if running.softened else "",
                host=host_json(running),
                flight=running.flight and running.flight.readings(),
                link_holds=running.settings.link_holds,
                priority=running.settings.priority,
                test=self._progress or None,
            ),
        )


def _has_hand(running: LiveSession) -> bool:
    """Whether the machine is simulated in this loop."""
    try:
        running.hand_force_n = 0.0
    except InputError:
        return False
    return True


def _text(**fields: Any) -> str:
    return json.dumps(fields, allow_nan=False)


async def _whenever(event: asyncio.Event, work: Callable[[], Awaitable[None]]) -> None:
    """Run a task on each event; events during a run cause one further run."""
    while True:
        await event.wait()
        event.clear()
        await work()
