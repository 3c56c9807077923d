"""How soon a column that is let go falls through a level, whatever the law: before its drive can follow, the link throws it.

``theta`` angle of the column · ``tau`` from the release to the first command that can know of it · ``q`` flow into the actuator,
``p`` load pressure, ``p_s`` supply's · ``q_s``, ``q_i`` largest flow at no load by spool and by current · ``i``, ``e``, ``u``
current, its command and the voltage of a phase, ``i_0`` the current that held

    x' = A x + b q + friction,   q = min(q_s, q_i int_0^t |g|) sqrt(1 - p / p_s)        of a valve, eq. (1); g its answer, eq. (9)
    x' = A x + b i + friction,   i = min(e + (i_0 - e) exp(-w_c (t - tau)), f + u int_0^t |g|)                        of a motor

``A``, ``b`` are the model's own matrices of column, link and drive. What the column does after a motion or force of the drive's end
is never negative, so that none takes it less far down than the largest at every moment: the drive runs after the column with all
that it has.

Of a motor no current is larger than the lesser of two: what the largest command asks of the current loop, and what the largest
voltage, of whatever sign at each moment, brings about in winding, rotor, link and column; ``g`` is the current's answer to an
impulse of voltage, ``f`` the current without one. With dry friction of the column, which stirs the rotor too, the first alone.

Of a valve the largest motion is the one with equality. Suppose that another has let in as much oil for the first time: up to there
it had let in less, hence the piston was behind as long as what an impulse of oil does to piston and column is nowhere negative,
hence the load pressure helped it less, and it goes on no faster. That holds for about half a swing of the column on link and oil;
nothing is told beyond.

The hand lets go as the controller samples. Load cell and encoders see nothing of it then, since what they measure goes on without a
jump, so that ``tau`` is period and delay; with a sensor at the grip, which sees the force jump, the delay alone.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel._core import GainLaw
from forcefeel.linear.electric import BASE, BASE_RATE, CURRENT, OUTPUTS, POSITION, RATE, ElectricPlant
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ELECTRIC, INDEX, OFF
from forcefeel.loader.sensors import has_grip_sensor
from forcefeel.sizing.fastest import Fastest
from forcefeel.sizing.valve import Valve

_Matrix = NDArray[np.float64]

_MOMENTS = 2400
"""Into which a swing of the column on its link is cut."""

_LEAST_DAMPING = 5e-4
"""Damping ratio of the column on its link: without any the oil's spring has no state."""


def falls_through_s(
    loader: Loader, angle_rad: float, stiffness: NDArray[np.float64], level: float
) -> NDArray[np.float64]:
    """By when at the latest the column falls through a share of the angle; infinite where its first swing on the link need not.

    Args:
        loader: The loader. Nothing is told of one whose drive has no limit, whose valve follows no orifice, whose motor or
            transmission has friction, whose link has play, whose column is not balanced, or at whose grip there is an arm.
        angle_rad: Where it is let go.
        stiffness: G in N m/rad, one for each time.
        level: The share.
    """
    latest = np.full(len(stiffness), np.inf)
    if not _applies(loader):
        return latest
    drive = (_motor if loader.drive == ELECTRIC else _valve)(loader)
    friction = drive.by_force * _column_friction(loader)
    step = scipy.linalg.expm(_driven(drive.matrix, friction, drive.by_input) * drive.time[1])
    torque = stiffness * angle_rad
    state = np.vstack([drive.held(angle_rad, torque), np.ones_like(torque), np.zeros_like(torque)])
    gives = drive.gives(state[:-2])
    for moment in range(1, drive.ordered(step)):
        # The load helps less and less as the link lets go: its value at the step's begin is the more generous one.
        state[-1] = gives[:, moment] * np.sqrt(np.maximum(1 - drive.load @ state[:-2], 0.0))
        state = step @ state
        first = (drive.angle @ state[:-2] < level * angle_rad) & np.isinf(latest)
        latest[first] = drive.time[moment]
    return latest


def _driven(matrix: _Matrix, *columns: _Matrix) -> _Matrix:
    """A linear system with inputs that stay as states of their own."""
    size = len(matrix)
    whole = np.zeros((size + len(columns), size + len(columns)))
    whole[:size] = np.column_stack([matrix, *columns])
    return whole


_UNKNOWN = (
    "motor.coulomb_friction",
    "motor.static_friction",
    "motor.cogging_torque",
    "motor.cogging_torque_2",
    "brake.engaged",
    "transmission.backlash",
    "transmission.efficiency",
    "transmission.backdriving_efficiency",
    "linkage.backlash",
    "column.gravity_torque",
    "pilot.arm_mass",
    "pilot.arm_damping",
    "pilot.arm_stiffness",
)
_UNKNOWN_OF_VALVE = ("column.viscous_friction",)
"""Eq. (17) has none."""


def _applies(loader: Loader) -> bool:
    electric = loader.drive == ELECTRIC
    if electric:
        current, volts = (np.isfinite(loader[f"current_loop.{name}_limit"]) for name in ("current", "voltage"))
        limited = current or (volts and not _column_friction(loader))
    else:
        limited = bool(loader["valve.orifice"]) and Fastest.of(loader).speed_m_per_s < np.inf
    unknown = _UNKNOWN if electric else (*_UNKNOWN, *_UNKNOWN_OF_VALVE)
    return limited and all(loader[key] in {OFF.get(key), 0.0} for key in unknown)


@dataclass(frozen=True, eq=False)
class _Drive:
    """Column and link with what drives them, ``x' = A x + b u``.

    Attributes:
        matrix, by_input, by_force: A, b, and what a force at the grip does.
        angle: theta of the states.
        load: p / p_s of them; none of a motor.
        rising: States whose answer to a step of the input has to rise; none of a motor.
        held: The states before the release, (states, torques), from the angle and the torques that were held.
        gives: The input without a load, (torques, moments), from these states.
        time: The moments of one swing.
    """

    matrix: _Matrix
    by_input: _Matrix
    by_force: _Matrix
    angle: _Matrix
    load: _Matrix
    rising: list[int]
    held: Callable[[float, _Matrix], _Matrix]
    gives: Callable[[_Matrix], _Matrix]
    time: _Matrix

    def ordered(self, step: _Matrix) -> int:
        """For how many moments nothing answers to an impulse of the input negatively: while the answers to a step of it rise."""
        answer = np.append(self.by_input / np.linalg.norm(self.by_input), [0.0, 0.0])
        largest = np.zeros(len(self.rising))
        for moment in range(1, len(self.time) if self.rising else 0):
            before, answer = answer[self.rising], step @ answer
            largest = np.maximum(largest, np.abs(answer[self.rising]))
            if (answer[self.rising] < before - _ROUNDING * largest).any():
                return moment
        return len(self.time)


_ROUNDING = 1e-12
"""Of the largest answer so far."""


def _valve(loader: Loader) -> _Drive:
    """Column, link and piston, eq. (17): states ``x_p, p, x_b, x_b'``, driven by the flow into the actuator."""
    values = loader.si_values.copy()
    # What the flow depends on stands beside the matrix.
    values[INDEX["valve.pressure_gain"]] = 0.0
    per_square, _ = _core.linkage_from_resonance(values, 1.0, 0.0)
    w = np.sqrt(loader["linkage.stiffness"] / per_square)
    _, least = _core.linkage_from_resonance(values, w, _LEAST_DAMPING)
    values[INDEX["linkage.damping"]] = max(loader["linkage.damping"], least)
    a, b, c, _ = _core.compliant(values, GainLaw.none(values))
    own, time = np.array([0, 1, 6, 7]), np.linspace(0.0, 2 * np.pi / w, _MOMENTS)
    valve, angle, flow = Valve(loader), c[0, own], _valve_flow(loader, a[2:4, 2:4], time)

    def held(angle_rad: float, torque: _Matrix) -> _Matrix:
        base = np.full_like(torque, angle_rad / angle[2])
        pressure = -torque / (valve.force_per_pressure * loader["column.grip_arm"])
        # At rest the piston's velocity of eq. (9) is none.
        piston = -(a[0, 1] * pressure + a[0, 6] * base) / a[0, 0]
        return np.array([piston, pressure, base, np.zeros_like(torque)])

    return _Drive(
        matrix=a[np.ix_(own, own)],
        by_input=a[own, 2],
        by_force=b[own, 0],
        angle=angle,
        load=np.array([0.0, 1 / loader["valve.supply_pressure"], 0.0, 0.0]),
        rising=[0, 2],
        held=held,
        gives=lambda states: np.tile(flow, (states.shape[1], 1)),
        time=time,
    )


def _valve_flow(loader: Loader, answers: _Matrix, time: _Matrix) -> _Matrix:
    """Largest flow at no load at moments after the release: of the spool, and of the largest current through the valve's answer.

    ``answers`` is the matrix of flow and its rate, eq. (3).
    """
    since, flow = np.maximum(time - _unseen_s(loader), 0.0), Valve(loader).flow_by_current_m3_per_s
    step = scipy.linalg.expm(answers * time[1])
    state, impulse = np.array([0.0, -answers[1, 0]]), np.zeros(len(time))
    for moment in range(1, len(time)):
        state = step @ state
        impulse[moment] = state[0]
    answered = np.interp(since, time, np.cumsum(np.abs(impulse)) * time[1])
    by_current = flow * answered if np.isfinite(flow) else np.where(since > 0, np.inf, 0.0)
    return np.minimum(loader["valve.flow_limit"], by_current)


def _motor(loader: Loader) -> _Drive:
    """Rotor, link and column: states ``x_m, x_m', x_b, x_b'``, driven by the current."""
    plant = ElectricPlant.of(loader)
    own = np.array([POSITION, RATE, BASE, BASE_RATE])
    time = np.linspace(0.0, 2 * np.pi * np.sqrt(plant.column_mass / plant.stiffness), _MOMENTS)
    matrix, angle = plant.a[np.ix_(own, own)], plant.c[0, own]

    def held(angle_rad: float, torque: _Matrix) -> _Matrix:
        base, still = np.full_like(torque, angle_rad / angle[2]), np.zeros_like(torque)
        end = plant.ratio * base - torque / plant.lever / plant.stiffness
        return np.array([end, still, base, still])

    def gives(states: _Matrix) -> _Matrix:
        return np.array([_largest_current(loader, plant, state, time) for state in states.T])

    return _Drive(
        matrix=matrix,
        by_input=plant.a[own, CURRENT],
        by_force=plant.b[own, 0],
        angle=angle,
        load=np.zeros(4),
        rising=[],
        held=held,
        gives=gives,
        time=time,
    )


def _largest_current(loader: Loader, plant: ElectricPlant, held: _Matrix, time: _Matrix) -> _Matrix:
    """Largest current at moments after the release from the states ``x_m, x_m', x_b, x_b'``, by the command and by the voltage."""
    most, volts = (loader[f"current_loop.{name}_limit"] for name in ("current", "voltage"))
    unseen, period = _unseen_s(loader), time[1]
    end, _, base, _ = held
    before = (end - plant.ratio * base) * plant.stiffness / plant.force_per_ampere
    since = np.maximum(time - unseen, 0.0)
    lag = np.exp(plant.a[CURRENT, CURRENT] * since)
    by_command = most - (most - before) * lag if np.isfinite(most) else np.where(since > 0, np.inf, before)
    if not np.isfinite(volts) or _column_friction(loader):
        return np.asarray(by_command)
    # u = c x + d e, solved for the command e: what the voltage does to the states.
    voltage, direct = plant.c[_VOLTAGE], plant.d[_VOLTAGE, 1]
    by_voltage = plant.b[:, 1] / direct
    under = plant.a - np.outer(by_voltage, voltage)
    state = np.array([end, 0.0, before, base, 0.0])
    # The old command until then; it holds the current.
    state = scipy.linalg.expm(_driven(plant.a, plant.b[:, 1] * before) * unseen)[:-1] @ np.append(state, 1.0)
    step = scipy.linalg.expm(under * period)
    free, pulse, swings = state, by_voltage, 0.0
    largest = np.full(len(time), before)
    for moment, at in enumerate(time):
        if at <= unseen:
            continue
        # By the end of this moment, a step ahead of what has come about: the more generous one.
        before, free = free[CURRENT], step @ free
        swings += volts * period * max(abs(pulse[CURRENT]), abs((pulse := step @ pulse)[CURRENT]))
        largest[moment] = min(by_command[moment], max(before, free[CURRENT]) + swings)
    return largest


_VOLTAGE = OUTPUTS.index("motor_voltage_v")


def _column_friction(loader: Loader) -> float:
    """At the grip, N."""
    return max(loader["column.coulomb_friction"], loader["column.static_friction"])


def _unseen_s(loader: Loader) -> float:
    """From the release to the first command that can know of it."""
    return loader["controller.delay"] + (0.0 if has_grip_sensor(loader) else loader["controller.period"])
