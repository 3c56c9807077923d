"""A flight: hand, loader and aircraft in lock step.

Each frame of the aircraft is a packet to the loader (``docs/reference/host.md``), then the loader's cycles of that time, then the
elevator where the column is. The loader is the supervised live loop on its simulated machine, with its law, sensors, friction and
delay.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel.bridge.run import REFUSED
from forcefeel.errors import InputError
from forcefeel.fly.aircraft import FRAME_S, Aircraft, hinge_moment, with_elevator
from forcefeel.laws.law import LawLike
from forcefeel.live.setup import live_law, made_of
from forcefeel.live.state import COLUMNS, STATES
from forcefeel.loader.loader import Loader
from forcefeel.simulation.inputs.flight import FLIGHT_UNITS

SETTLES_S = 3.0
"""Time before the flight in which the loader is switched on and its feel fades in; the aircraft waits in its trimmed state."""

SUFFIXES = {name: unit and f"_{unit.replace('/', '_per_').lower()}" for name, unit in FLIGHT_UNITS.items()}
"""Units of the states, as suffixes of their names."""

_SWITCHES = sum(_core.host_switches()[name] for name in ("active", "flight"))
_ANGLE, _STATE = COLUMNS.index("column_angle_rad"), COLUMNS.index("state")


@dataclass(frozen=True, eq=False)
class Flown:
    """A flight.

    Attributes:
        time_s: Time of each frame.
        force_n: Force of the hand.
        angle_rad: Angle of the column from its trimmed position.
        states: Flight state by name, a row for each frame.
        loader: The loader with the aircraft's surface.

    Example:
        >>> aircraft = ff.fly.Aircraft("c172p", 51.4, 900.0)
        >>> flown = ff.fly.fly(ff.digital_elevator(), aircraft, np.zeros(25), "robust")
        >>> f"{flown.time_s[-1]:.3f} s"
        '0.192 s'
    """

    time_s: NDArray[np.float64] = field(repr=False)
    force_n: NDArray[np.float64] = field(repr=False)
    angle_rad: NDArray[np.float64] = field(repr=False)
    states: dict[str, NDArray[np.float64]] = field(repr=False)
    loader: Loader


def fly(loader: Loader, aircraft: Aircraft, force_n: NDArray[np.float64], law: LawLike = None) -> Flown:
    """Flies an aircraft by the force of a hand on the loader's grip.

    Args:
        loader: The loader, with a digital controller; its feel and surface become the aircraft's.
        aircraft: The aircraft, trimmed; it is flown on from there.
        force_n: Force of the hand, a number for each frame of 8 ms; positive towards positive angles of the column.
        law: The law, as in ``Law.of``.

    Raises:
        InputError: If the loader has no digital controller whose period divides the frame, it is stopped by its supervisor, or the
            aircraft leaves the range of its model.

    Example:
        >>> flown = ff.fly.fly(ff.digital_elevator(), ff.fly.Aircraft("c172p", 51.4, 900.0), np.zeros(5), "robust")
        >>> len(flown.angle_rad)
        5
    """
    loader = with_elevator(loader, aircraft)
    driven_by = live_law(law, loader)
    setup, _ = made_of(loader, driven_by, host=True)
    cycles = FRAME_S / loader["controller.period"]
    if abs(cycles - round(cycles)) > _ROUNDING:
        raise InputError(
            f"controller.period: expected a period that divides {1e3 * FRAME_S:g} ms, got {1e3 * loader['controller.period']:g} ms"
        )
    loop, cycles = _core.LockStep(setup), round(cycles)
    loop.request("on", [])
    settling, state = round(SETTLES_S / FRAME_S), aircraft.state()
    for k in range(settling):
        _frame(loop, k, cycles, state)
    rows: list[dict[str, float]] = []
    angles = np.empty(len(force_n))
    hand = np.array(force_n, dtype=np.float64)
    for k, force in enumerate(hand.tolist()):
        loop.disturb("force", number=force)
        last = _frame(loop, settling + k, cycles, state)
        if STATES[int(last[_STATE])] != "active":
            raise InputError(
                f"loader: the supervisor stopped it after {k * FRAME_S:.2f} s of flight; give a smaller force"
            )
        angles[k] = last[_ANGLE]
        rows.append(state)
        aircraft.fly(aircraft.trimmed_rad + loader["surface.gearing"] * angles[k])
        state = aircraft.state()
    states = {name: np.array([row[name] for row in rows]) for name in rows[0]} if rows else {}
    times = np.arange(len(hand), dtype=np.float64) * FRAME_S
    return Flown(times, hand, angles, states, loader)


_ROUNDING = 1e-9


def _frame(loop: _core.LockStep, sequence: int, cycles: int, state: dict[str, float]) -> NDArray[np.float64]:
    """The last row of the cycles of a frame, in a flight state.

    Raises:
        InputError: If the loader refuses the state.
    """
    rows = loop.run(cycles, _core.host_packet(sequence, _SWITCHES, state))
    answer = _core.host_answer(loop.answer or b"")
    if answer is not None and answer[1] & REFUSED:
        raise InputError(
            f"loader: cannot render the hinge moment at {state['dynamic_pressure']:.4g} Pa and "
            f"{state['true_airspeed']:.4g} m/s; take another loader, law or speed"
        )
    last: NDArray[np.float64] = rows[-1]
    return last


def held_force(loader: Loader, state: dict[str, float], angle_rad: float) -> float:
    """Force at the grip, N, that holds the column at an angle in a flight state: ``F = ((G + G_s) theta) / R_p - F_s``.

    Args:
        loader: With the aircraft's surface, as ``Flown.loader``.
        state: Flight state by the names of a host's packet.
        angle_rad: Angle of the column.

    Example:
        >>> aircraft = ff.fly.Aircraft("c172p", 51.4, 900.0)
        >>> loader = ff.fly.with_elevator(ff.digital_elevator(), aircraft)
        >>> round(ff.fly.held_force(loader, aircraft.state(), 0.0), 6) + 0
        0.0
    """
    force, stiffness, _ = hinge_moment(loader, state, angle_rad)
    return (loader["feel.stiffness"] + stiffness) * angle_rad / loader["column.grip_arm"] - force


def force_per_g(loader: Loader, aircraft: str, speed_m_per_s: float, altitude_m: float) -> float:
    """Force at the grip per load factor, N, between pull-ups of 1.2 and 1.4 g that JSBSim trims, for the feel without the loader.

    Example:
        >>> aircraft = ff.fly.Aircraft("c172p", 51.4, 900.0)
        >>> loader = ff.fly.with_elevator(ff.digital_elevator(), aircraft)
        >>> round(ff.fly.force_per_g(loader, "c172p", 51.4, 900.0))
        -35
    """
    trimmed = Aircraft(aircraft, speed_m_per_s, altitude_m).trimmed_rad
    points = []
    for load_factor in (1.2, 1.4):
        pulls = Aircraft(aircraft, speed_m_per_s, altitude_m, load_factor)
        state, angle = pulls.state(), (pulls.trimmed_rad - trimmed) / loader["surface.gearing"]
        points.append((state["load_factor"], held_force(loader, state, angle)))
    (n_1, force_1), (n_2, force_2) = points
    return (force_2 - force_1) / (n_2 - n_1)
