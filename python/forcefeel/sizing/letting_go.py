"""Latest time at which a released column falls through a level, for any law: the link moves it before the drive can follow.

``theta`` angle of the column · ``tau`` from the release to the first command that can know of it · ``q`` flow into the actuator,
``p`` load pressure, ``p_s`` supply's · ``q_s``, ``q_i`` largest flow at no load by spool and by current · ``i``, ``e``, ``u``
current, its command and the voltage of a phase, ``i_0`` the current that held

    x' = A x + b q + friction,   q = min(q_s, q_i int_0^t |g|) sqrt(1 - p / p_s)        of a valve, eq. (1); g its answer, eq. (9)
    x' = A x + b i + friction,   i = min(e + (i_0 - e) exp(-w_c (t - tau)), f + u int_0^t |g|)                        of a motor

``A``, ``b`` are the model's matrices of column, link and drive. The response of the column to a motion or force of the drive's end
is never negative. So the largest drive input at every time gives the slowest fall.

The current of a motor has two bounds: the response of the current loop to the largest command, and the response of winding, rotor,
link and column to the largest voltage of either sign. ``g`` is the impulse response of the current to the voltage, ``f`` the free
current. With dry friction of the column only the first bound applies.

For a valve the largest motion satisfies the equality. Suppose another motion reaches the same oil volume for the first time. Before
that its volume was smaller, so its piston was behind while the impulse response of piston and column is not negative. The load
pressure then helped it less, and it is no faster. This holds for about half a swing of the column on link and oil; later times are
not evaluated.

The release coincides with a sample of the controller. Signals of load cell and encoders do not jump, so ``tau`` is period plus
delay; with a force sensor at the grip it is the delay.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel._core import GainLaw, exponential
from forcefeel.linear.electric import BASE, BASE_RATE, CURRENT, OUTPUTS, POSITION, RATE, ElectricPlant
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ELECTRIC, INDEX, OFF
from forcefeel.loader.sensors import has_grip_sensor
from forcefeel.sizing.fastest import Fastest
from forcefeel.sizing.valve import Valve

_Matrix = NDArray[np.float64]

_MOMENTS = 2400
"""Time samples of a swing of the column on its link."""

_LEAST_DAMPING = 5e-4
"""Least damping ratio of the column on its link; without damping the oil's spring has no state."""


def falls_through_s(
    loader: Loader, angle_rad: float, stiffness: NDArray[np.float64], level: float
) -> NDArray[np.float64]:
    """Latest time at which the column falls through a share of the angle, s; infinite if its first swing need not reach it.

    Args:
        loader: The loader. The time is infinite without a limit of the drive or an orifice of the valve. It is also infinite
            with friction of motor or transmission, backlash of the link, an unbalanced column, or an arm.
        angle_rad: Angle of the release.
        stiffness: G in N m/rad, one for each result.
        level: The share.
    """
    latest = np.full(len(stiffness), np.inf)
    if not _applies(loader):
        return latest
    drive = (_motor if loader.drive == ELECTRIC else _valve)(loader)
    friction = drive.by_force * _column_friction(loader)
    step = exponential(_driven(drive.matrix, friction, drive.by_input) * drive.time[1])
    torque = stiffness * angle_rad
    state = np.vstack([drive.held(angle_rad, torque), np.ones_like(torque), np.zeros_like(torque)])
    gives = drive.gives(state[:-2])
    for moment in range(1, drive.ordered(step)):
        # The load helps less as the link relaxes; its value at the start of the step is the upper bound.
        state[-1] = gives[:, moment] * np.sqrt(np.maximum(1 - drive.load @ state[:-2], 0.0))
        state = step @ state
        first = (drive.angle @ state[:-2] < level * angle_rad) & np.isinf(latest)
        latest[first] = drive.time[moment]
    return latest


def _driven(matrix: _Matrix, *columns: _Matrix) -> _Matrix:
    """A linear system with constant inputs as additional states."""
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
_UNKNOWN_OF_VALVE = ("column.viscous_friction", "actuator.seal_friction")
"""Eq. (17) has neither."""


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
    """Column and link with their drive, ``x' = A x + b u``.

    Attributes:
        matrix, by_input, by_force: A, b, and the input vector of a force at the grip.
        angle: Output row of theta.
        load: Output row of p / p_s; zero for a motor.
        rising: States whose step response must increase; empty for a motor.
        held: Function of angle and torques that returns the states before the release, (states, torques).
        gives: Function of these states that returns the input without load, (torques, times).
        time: Times of one swing.
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
        """Number of times for which no impulse response is negative: the step responses increase."""
        answer = np.append(self.by_input / np.linalg.norm(self.by_input), [0.0, 0.0])
        largest = np.zeros(len(self.rising))
        for moment in range(1, len(self.time) if self.rising else 0):
            before, answer = answer[self.rising], step @ answer
            largest = np.maximum(largest, np.abs(answer[self.rising]))
            if (answer[self.rising] < before - _ROUNDING * largest).any():
                return moment
        return len(self.time)


_ROUNDING = 1e-12
"""Rounding, as a share of the largest response so far."""


def _valve(loader: Loader) -> _Drive:
    """Column, link and piston, eq. (17): states ``x_p, p, x_b, x_b'``, driven by the flow into the actuator."""
    values = loader.si_values.copy()
    # The pressure dependence of the flow is not part of the matrix.
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
        # At rest the piston's velocity of eq. (9) is zero.
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
    """Largest flow without load after the release: limits of the spool, and of the current with the valve's response.

    ``answers`` is the matrix of flow and its rate, eq. (3).
    """
    since, flow = np.maximum(time - _unseen_s(loader), 0.0), Valve(loader).flow_by_current_m3_per_s
    step = exponential(answers * time[1])
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
    """Largest current after the release from the states ``x_m, x_m', x_b, x_b'``, by the command and by the voltage."""
    most, volts = (loader[f"current_loop.{name}_limit"] for name in ("current", "voltage"))
    unseen, period = _unseen_s(loader), time[1]
    end, _, base, _ = held
    before = (end - plant.ratio * base) * plant.stiffness / plant.force_per_ampere
    since = np.maximum(time - unseen, 0.0)
    lag = np.exp(plant.a[CURRENT, CURRENT] * since)
    by_command = most - (most - before) * lag if np.isfinite(most) else np.where(since > 0, np.inf, before)
    if not np.isfinite(volts) or _column_friction(loader):
        return np.asarray(by_command)
    # u = c x + d e, solved for the command e: effect of the voltage on the states.
    voltage, direct = plant.c[_VOLTAGE], plant.d[_VOLTAGE, 1]
    by_voltage = plant.b[:, 1] / direct
    under = plant.a - np.outer(by_voltage, voltage)
    state = np.array([end, 0.0, before, base, 0.0])
    # Until then the old command holds the current.
    state = exponential(_driven(plant.a, plant.b[:, 1] * before) * unseen)[:-1] @ np.append(state, 1.0)
    step = exponential(under * period)
    free, pulse, swings = state, by_voltage, 0.0
    largest = np.full(len(time), before)
    for moment, at in enumerate(time):
        if at <= unseen:
            continue
        # The value at the end of this step is the upper bound.
        before, free = free[CURRENT], step @ free
        swings += volts * period * max(abs(pulse[CURRENT]), abs((pulse := step @ pulse)[CURRENT]))
        largest[moment] = min(by_command[moment], max(before, free[CURRENT]) + swings)
    return largest


_VOLTAGE = OUTPUTS.index("motor_voltage_v")


def _column_friction(loader: Loader) -> float:
    """Largest dry friction of the column, N at the grip."""
    level = max(loader["column.coulomb_friction"], loader["column.static_friction"])
    return level * (1 + abs(loader["column.friction_asymmetry"]))


def _unseen_s(loader: Loader) -> float:
    """Time from the release to the first command that depends on it."""
    return loader["controller.delay"] + (0.0 if has_grip_sensor(loader) else loader["controller.period"])
