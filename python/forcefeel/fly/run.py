"""A flight: hand, loader and aircraft in lock step.

Each frame of the aircraft is a packet to the loader (``docs/reference/host.md``), then the loader's cycles of that time, then the
elevator where the column is. The loader is the supervised live loop on its simulated machine, with its law, sensors, friction and
delay; without a loader in between the hand is on the programmed feel itself.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel.bridge.run import REFUSED
from forcefeel.errors import InputError
from forcefeel.fly.aircraft import FRAME_S, Aircraft, flight_row, silent, with_surface
from forcefeel.fly.trims import held_force
from forcefeel.laws.law import Law, LawLike
from forcefeel.live.setup import live_law, made_of
from forcefeel.live.state import COLUMNS, STATES
from forcefeel.loader.loader import Loader
from forcefeel.simulation.inputs.flight import FLIGHT_UNITS

SETTLES_S = 3.0
"""Time before the flight in which the loader is switched on and its feel fades in; the aircraft waits in its trimmed state."""

SUFFIXES = {name: unit and f"_{unit.replace('/', '_per_').lower()}" for name, unit in FLIGHT_UNITS.items()}
SUFFIXES |= {
    "pitch_attitude": "_rad",
    "bank": "_rad",
    "climb_angle": "_rad",
    "calibrated_airspeed": "_m_per_s",
    "altitude": "_m",
}
"""Units of the states, as suffixes of their names."""

Pilot = Callable[[float, Mapping[str, float]], float]
"""Force at the grip, N, from the time and what the pilot sees: the flight state and attitude."""

_SWITCHES = sum(_core.host_switches()[name] for name in ("active", "flight"))
_ANGLE, _STATE = COLUMNS.index("column_angle_rad"), COLUMNS.index("state")
_FEEL_STEPS = 4
"""Steps of the programmed feel alone in a frame: 0.5 ms."""


@dataclass(frozen=True, kw_only=True)
class FlightOptions:
    """How an aircraft is flown.

    Attributes:
        law: The law, as in ``Law.of``.
        trim: The trimmed flight in which tab and column are zero; the flown aircraft's own unless given. It begins held by a hand.
        alone: Whether the hand is on the programmed feel itself, without a loader in between.
        levers: Sets throttle, flaps or ailerons before each frame, from the time and the flown aircraft.
        ends: Whether the flight ends, from what the pilot sees.

    Example:
        >>> ff.fly.FlightOptions(law="robust").alone
        False
    """

    law: LawLike = None
    trim: Aircraft | None = None
    alone: bool = False
    levers: Callable[[float, Aircraft], None] | None = None
    ends: Callable[[Mapping[str, float]], bool] = lambda _: False


@dataclass(frozen=True, eq=False)
class Flown:
    """A flight.

    Attributes:
        time_s: Time of each frame.
        force_n: Force of the hand.
        angle_rad: Angle of the column from its trimmed position.
        states: Flight state and attitude by name, a row for each frame.
        loader: The loader with the aircraft's surface.

    Example:
        >>> aircraft = ff.fly.Aircraft("c172p", 51.4, 900.0)
        >>> flown = ff.fly.fly(ff.digital_elevator(), aircraft, np.zeros(25), ff.fly.FlightOptions(law="robust"))
        >>> f"{flown.time_s[-1]:.3f} s"
        '0.048 s'
    """

    time_s: NDArray[np.float64] = field(repr=False)
    force_n: NDArray[np.float64] = field(repr=False)
    angle_rad: NDArray[np.float64] = field(repr=False)
    states: dict[str, NDArray[np.float64]] = field(repr=False)
    loader: Loader


def fly(
    loader: Loader,
    aircraft: Aircraft,
    hand: NDArray[np.float64] | Pilot,
    options: FlightOptions = FlightOptions(),
    *,
    duration_s: float | None = None,
) -> Flown:
    """Flies an aircraft by a hand on the loader's grip.

    Args:
        loader: The loader, with a digital controller; its feel and surface become the aircraft's.
        aircraft: The aircraft, trimmed; it is flown on from there.
        hand: A force for each frame of 2 ms, N, or a pilot; positive towards positive angles of the column.
        options: How it is flown.
        duration_s: Length of a pilot's flight.

    Raises:
        InputError: If the loader has no digital controller whose period divides the frame, it is stopped by its supervisor, a force
            is not finite, or the aircraft leaves the range of its model.

    Example:
        >>> aircraft = ff.fly.Aircraft("c172p", 51.4, 900.0)
        >>> flown = ff.fly.fly(ff.digital_elevator(), aircraft, np.zeros(5), ff.fly.FlightOptions(law="robust"))
        >>> len(flown.angle_rad)
        5
    """
    trim = options.trim or aircraft
    loader = with_surface(loader, trim)
    frames = len(hand) if isinstance(hand, np.ndarray) else round((duration_s or 0.0) / FRAME_S)
    pilot: Pilot = hand if callable(hand) else (lambda time, _: float(hand[round(time / FRAME_S)]))
    begins, state = aircraft.angle_from(trim), aircraft.state()
    held = held_force(loader, state, begins)
    stick: _Stick = (_Feel if options.alone else _Loop)(loader, options.law)
    stick.begin(state, held, begins)
    rows: list[dict[str, float]] = []
    forces, angles = np.empty(frames), np.empty(frames)
    with silent():
        for k in range(frames):
            time = k * FRAME_S
            seen = state | aircraft.attitude()
            if options.ends(seen):
                break
            forces[k] = pilot(time, seen)
            if not np.isfinite(forces[k]):
                raise InputError(f"hand: expected a finite force, got {forces[k]} at {time:.2f} s")
            angles[k] = stick.frame(forces[k], state, time)
            rows.append(seen)
            if options.levers is not None:
                options.levers(time, aircraft)
            aircraft.fly(trim.trimmed + trim.per_angle * angles[k])
            state = aircraft.state()
    states = {name: np.array([row[name] for row in rows]) for name in rows[0]} if rows else {}
    flown = len(rows)
    return Flown(np.arange(flown, dtype=np.float64) * FRAME_S, forces[:flown], angles[:flown], states, loader)


class _Stick(Protocol):
    """What the hand is on."""

    def begin(self, state: dict[str, float], held_n: float, angle_rad: float) -> None: ...
    def frame(self, force_n: float, state: dict[str, float], time_s: float) -> float: ...


class _Feel:
    """The programmed feel itself."""

    def __init__(self, loader: Loader, law: LawLike) -> None:
        self._loader = loader

    def begin(self, state: dict[str, float], held_n: float, angle_rad: float) -> None:
        self._feel = _core.FlownFeel(self._loader.si_values, angle_rad)

    def frame(self, force_n: float, state: dict[str, float], time_s: float) -> float:
        return self._feel.run(force_n, np.array(flight_row(state)), _FEEL_STEPS, FRAME_S / _FEEL_STEPS)


class _Loop:
    """The loader's supervised loop.

    Raises:
        InputError: If the loader's period does not divide the frame.
    """

    def __init__(self, loader: Loader, law: LawLike) -> None:
        setup = _setup(loader, live_law(law, loader))
        cycles = FRAME_S / loader["controller.period"]
        if abs(cycles - round(cycles)) > _ROUNDING:
            raise InputError(
                f"controller.period: expected a period that divides {1e3 * FRAME_S:g} ms, "
                f"got {1e3 * loader['controller.period']:g} ms"
            )
        self._loop, self._cycles, self._sequence = _core.LockStep(setup), round(cycles), 0

    def begin(self, state: dict[str, float], held_n: float, angle_rad: float) -> None:
        """Switched on, its feel faded in, the hand's force come in the second half of the time.

        Where friction holds the column back, the hand pushes on until the column is there.

        Raises:
            InputError: If the column does not come there.
        """
        self._loop.request("on", [])
        frames, pushes, k = round(SETTLES_S / FRAME_S), 0.0, 0
        close = _THERE * abs(angle_rad) + _LEAST_RAD
        while True:
            self._loop.disturb("force", number=pushes + held_n * min(1.0, max(0.0, 3 * k / frames - 1)))
            off = angle_rad - float(self._frame(state)[_ANGLE])
            k += 1
            if k < frames:
                continue
            if abs(off) <= close:
                return
            pushes += np.copysign(_PUSH_N_PER_S * FRAME_S, off)
            if k > _MOST_SETTLES * frames:
                raise InputError(
                    f"loader: the column stays {np.degrees(abs(off)):.2g} deg from where the flight begins, with "
                    f"{abs(held_n + pushes):.3g} N at the grip; take another loader, law or flight"
                )

    def frame(self, force_n: float, state: dict[str, float], time_s: float) -> float:
        self._loop.disturb("force", number=force_n)
        last = self._frame(state)
        if STATES[int(last[_STATE])] != "active":
            raise InputError(f"loader: the supervisor stopped it after {time_s:.2f} s of flight; give a smaller force")
        return float(last[_ANGLE])

    def _frame(self, state: dict[str, float]) -> NDArray[np.float64]:
        """The last row of the cycles of a frame, in a flight state.

        Raises:
            InputError: If the state is out of the range of a packet, or the loader refuses it.
        """
        try:
            packet = _core.host_packet(self._sequence, _SWITCHES, state)
        except _core.ArgumentError as error:
            raise InputError(f"aircraft: its flight left the range of a host's packet ({error})") from error
        rows = self._loop.run(self._cycles, packet)
        self._sequence += 1
        answer = _core.host_answer(self._loop.answer or b"")
        if answer is not None and answer[1] & REFUSED:
            raise InputError(
                f"loader: cannot render the hinge moment at {state['dynamic_pressure']:.4g} Pa and "
                f"{state['true_airspeed']:.4g} m/s; take another loader, law or speed"
            )
        last: NDArray[np.float64] = rows[-1]
        return last


_ROUNDING = 1e-9
_THERE, _LEAST_RAD = 0.05, 1e-3
"""Share of its angle, and angle, by which the column may begin elsewhere: compliance, noise of the sensors."""
_PUSH_N_PER_S = 15.0
_MOST_SETTLES = 6
"""Times ``SETTLES_S``: the hand comes to 250 N more than the feel asks for."""


@lru_cache(maxsize=1)
def _setup(loader: Loader, law: Law) -> _core.LiveSetup:
    """Of several flights with one loader and law the table of rendered springs is worked out once."""
    return made_of(loader, law, host=True)[0]
