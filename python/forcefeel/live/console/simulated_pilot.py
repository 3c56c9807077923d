"""Tests of the rule on a running loop with the simulated hand: a release and a slow sweep, recorded and judged.

For the release the hand pulls the column slowly to the angle, waits until it is at rest, and releases it. For the sweep it applies
the force that moves the programmed feel from neutral to both sides and back. Time is that of the simulated machine, one period for
each cycle; missed periods of the clock do not count.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from math import ceil, cos, pi
from threading import Event
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from forcefeel.errors import InputError
from forcefeel.live.console.programmed import Programmed
from forcefeel.live.live_session import LiveSession
from forcefeel.qualification import Qualification, Record, load_rules, qualify_loader
from forcefeel.qualification.plan.motions import release_duration_s
from forcefeel.qualification.plan.plan import STATIC
from forcefeel.qualification.plan.run import QualificationSetup
from forcefeel.units import FORCE, to_text

Side = Literal["positive", "negative"]

_PULL_S, _SETTLE_S, _HELD_S = 2.5, 1.5, 0.4
"""Durations of pulling, settling and holding at rest."""
_STEP_S = 0.005
"""Time between two forces of a pulling hand."""
_LATE = 20.0
"""A loop that is slower than real time by this factor counts as stopped."""


class Aborted(Exception):  # noqa: N818  not a program error
    """Reason of an aborted test."""


@dataclass(eq=False)
class SimulatedPilot:
    """Tests with the simulated hand.

    Attributes:
        running: The loop.
        setup: Rule, axis, throw and units of the tests.
        programmed: Sweep of the feel alone.
        tell: Called with the action of the hand and the completed share of the test.
        ended: Set to abort a test.
    """

    running: LiveSession
    setup: QualificationSetup
    programmed: Programmed
    tell: Callable[[str, float], None]
    ended: Event = field(default_factory=Event)
    _rows: list[NDArray[np.float64]] = field(default_factory=list)
    _seen: int = -1

    def release(self, side: Side) -> Qualification:
        """Release from the rule's largest share of the throw.

        Raises:
            Aborted: If the test was aborted, with the reason.
            InputError: If the record cannot be measured.
        """
        rules = load_rules(self.setup.rule)
        share = rules.release.deflection[1]
        angle = share * self.programmed.throw.end(1 if side == "positive" else -1)
        force, lasts = self.programmed.force_at(angle), release_duration_s(self.running.loader)
        whole = _PULL_S + _SETTLE_S + _HELD_S + lasts
        try:
            self._check()
            self._pull(lambda s: force * (1 - cos(pi * s)) / 2, _PULL_S, "pulls", (0.0, _PULL_S / whole))
            self._wait("pulls", _SETTLE_S, (_PULL_S / whole, (_PULL_S + _SETTLE_S) / whole))
            self._collect(anew=True)
            self._wait("holds", _HELD_S, (1 - (lasts + _HELD_S) / whole, 1 - lasts / whole))
            self.running.hand_force_n = 0.0
            self._wait("let go", lasts, (1 - lasts / whole, 1.0))
        finally:
            self._let_go()
        return self._judge(f"release-{100 * share:g}-{side}")

    def sweep(self) -> Qualification:
        """Slow sweep to both sides.

        Raises:
            Aborted: If the test was aborted, with the reason.
            InputError: If the supervisor does not allow the force, or the record cannot be measured.
        """
        force, record = self.programmed.record.force_n, self.programmed.record
        assert force is not None  # it was swept
        self._expect_force(record.time_s, force)
        try:
            self._check()
            self._collect(anew=True)
            at = record.time_s - record.time_s[0]
            self._pull(lambda s: float(np.interp(s * at[-1], at, force)), float(at[-1]), "sweeps", (0.0, 1.0))
        finally:
            self._let_go()
        return self._judge(STATIC)

    def _expect_force(self, time_s: NDArray[np.float64], force_n: NDArray[np.float64]) -> None:
        """Refuse a sweep with a grip force above the limit for longer than the supervisor allows."""
        limit, lasts_s = (self.running.loader[f"safety.{row}"] for row in ("force_limit", "force_time"))
        ends = np.flatnonzero(np.diff(np.concatenate([[False], np.abs(force_n) > limit, [False]])))
        longest_s = max((float(time_s[end - 1] - time_s[begin]) for begin, end in ends.reshape(-1, 2)), default=0.0)
        if longest_s >= lasts_s:
            system = self.setup.system
            most, limit_text = (
                f"{to_text(FORCE.from_si(value, system), 3)} {FORCE.shown(system)}"
                for value in (float(np.abs(force_n).max()), limit)
            )
            raise InputError(
                f"sweep: requires up to {most} at the grip, above safety.force_limit of {limit_text} for {longest_s:.0f} s; the "
                f"supervisor stops the loader after {lasts_s:g} s. Raise the limit in the loader file for this test"
            )

    def _pull(self, force: Callable[[float], float], lasts_s: float, what: str, shares: tuple[float, float]) -> None:
        """Apply a force that depends on the elapsed share of a duration."""
        start = self._clock_s()
        while (gone := (self._clock_s() - start) / lasts_s) < 1:
            self.running.hand_force_n = force(gone)
            self._go_on(_STEP_S, what, shares[0] + gone * (shares[1] - shares[0]))
        self.running.hand_force_n = force(1.0)

    def _wait(self, what: str, lasts_s: float, shares: tuple[float, float]) -> None:
        start = self._clock_s()
        while (gone := (self._clock_s() - start) / lasts_s) < 1:
            self._go_on(10 * _STEP_S, what, shares[0] + gone * (shares[1] - shares[0]))

    def _clock_s(self) -> float:
        return self.running.state.cycle * self.running.period_s

    def _go_on(self, for_s: float, what: str, share: float) -> None:
        self.tell(what, min(share, 1.0))
        self.running.wait(ceil(for_s / self.running.period_s), _LATE * for_s + 1.0)
        self._collect()
        self._check()

    def _check(self) -> None:
        state = self.running.state
        if self.ended.is_set():
            raise Aborted("aborted")
        if state.ended:
            raise Aborted("the loop has ended")
        if state.name != "active":
            raise Aborted(f"the law is not active: the loop is {state.name}; switch it on and start again")

    def _collect(self, *, anew: bool = False) -> None:
        if anew:
            self._rows, self._seen = [], self.running.state.cycle
        elif self._seen >= 0 and len(rows := self.running.history(self._seen)):
            self._rows.append(rows)
            self._seen = int(rows[-1, self._place("cycle")])

    def _let_go(self) -> None:
        self.running.hand_angle_rad = None
        self.running.hand_force_n = 0.0

    def _place(self, column: str) -> int:
        return list(self.running.columns).index(column)

    def _judge(self, key: str) -> Qualification:
        """Judge the record by the rule."""
        self.tell("judges", 1.0)
        rows = np.concatenate(self._rows)
        cycle, angle, force = (rows[:, self._place(c)] for c in ("cycle", "column_angle_rad", "pilot_force_n"))
        time = (cycle - cycle[0]) * self.running.period_s
        record = Record(time, angle, force if np.all(np.isfinite(force)) else None, name="running loader")
        return qualify_loader(self.running.loader, replace(self.setup, records={key: record}, tests=(key,)))
