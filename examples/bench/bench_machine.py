"""The report's loader as a differential equation, many machines side by side, in U.S. customary units: lb, in, s, mA, V, rad.

The machine behind the synthetic bench. It shares no line and no number with forcefeel, so a record of it shows what is wrong
there. Load pressure is a state, with the oil's own pole near -3e4 1/s.

``x`` piston · ``p`` load pressure · ``q_i`` valve · ``theta``, ``w`` column and its rate · ``s`` stretch of the link
``delta`` programmed displacement · ``e`` command · ``M`` torque on the column without dry friction · ``h`` step

    s = x - alpha R_b theta,    A p = k s + c s',                                                     eq. (9)
    V_E / (4 beta) p' = q - A x',    q = q_i - C_p p,                                                 eqs. (5), (4)
    q_i'' = w_n^2 (C_i i - q_i) - 2 zeta w_n q_i',    i = K_2 e within the amplifier's limit,         eq. (3)
    J w' = M - F_c R_p sgn w,    M = alpha R_b A p + R_p F_p,                                         eqs. (6), (7)
    I delta'' + B delta' + G delta = -G_max K_1 A p,    e = delta - K_3 x + e_T                       eqs. (12), (13)

At rest the column sticks while |M| <= F_s R_p. Servo alone: delta = 0; open: e = e_T.

Apart from switches all of this is linear, and `exact_steps` makes exact steps of it, with inputs that run straight through each.
Every channel is right to 1e-7 of its largest value (``tests/bench/test_bench_machine.py``).
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from itertools import product

import numpy as np
from exact_steps import ExactSteps, Modes, mode

X, P, QI, QI_RATE, THETA, W, DELTA, DELTA_RATE = range(8)
E, FORCE, TORQUE, ONE, E_RATE, FORCE_RATE = range(8, 14)
"""Places in the vector that a mode moves on: states, then what enters at the amplifier, at the grip and into a sampled feel
computer, one, and how fast the first two of these change."""
SIZE = 14
KEPT = [X, P, QI, THETA, W]

SMALLEST_S = 1e-6
"""Parts of a step that a switch is in are no smaller: inside one it is taken to second order."""

LOOPS = ("servo-open", "servo-closed", "loader")

LBF, INCH = 4.4482216152605, 0.0254  # N, m
SI = {
    "column_angle": 1.0,
    "column_velocity": 1.0,
    "piston_position": INCH,
    "load_cell_force": LBF,
    "load_pressure": LBF / INCH**2,
    "actuator_flow": INCH**3,
    "valve_current": 1e-3,
    "potentiometer": 1.0,
    "load_cell": 1.0,
}
"""Channels, and what their values are multiplied by to be in SI units."""


@dataclass(frozen=True, kw_only=True)
class Machine:
    """Numbers of the machines: each one for all of them, or (machines,). The defaults are the report's appendix."""

    area: float | np.ndarray = 2.36
    oil_volume: float | np.ndarray = 11.7
    bulk_modulus: float | np.ndarray = 250000.0
    link_stiffness: float | np.ndarray = 6107.86
    link_damping: float | np.ndarray = 16.2016
    ratio: float | np.ndarray = 0.59
    base_arm: float | np.ndarray = 10.0
    grip_arm: float | np.ndarray = 31.375
    inertia: float | np.ndarray = 37.4
    coulomb_friction: float | np.ndarray = 0.0
    """F_c at the grip, lb."""
    static_friction: float | np.ndarray = 0.0
    """F_s at the grip, lb; at least F_c."""
    admittance: float | np.ndarray = 1.56
    current_limit: float | np.ndarray = np.inf
    current_gain: float | np.ndarray = 5.45
    pressure_gain: float | np.ndarray = 0.0102
    valve_frequency: float | np.ndarray = 377.0
    valve_damping: float | np.ndarray = 0.9
    potentiometer_gain: float | np.ndarray = 7.632
    load_cell_gain: float | np.ndarray = 0.005
    maximum_stiffness: float | np.ndarray = 28800.0
    feel_inertia: float | np.ndarray = 60.0
    feel_damping: float | np.ndarray = 304.0
    feel_stiffness: float | np.ndarray = 9600.0

    def each(self):
        """The same with (machines,) in every place."""
        values = np.broadcast_arrays(
            *(np.atleast_1d(np.asarray(getattr(self, field.name), float)) for field in fields(self))
        )
        return Machine(**{field.name: value for field, value in zip(fields(self), values, strict=True)})


@dataclass(frozen=True)
class Controller:
    """A digital controller with ideal sensors that keeps its command between two samples."""

    period_s: float
    delay: int = 0
    """Periods from a sample to its command."""


def run(  # noqa: PLR0913  what a bench has
    machine: Machine,
    loop: str,
    rate_hz: float,
    *,
    test_signal=None,
    command_signal=None,
    force=None,
    staircase: bool = False,
    controller: Controller | None = None,
    start: np.ndarray | None = None,
    smallest_s: float = SMALLEST_S,
) -> Mapping[str, np.ndarray]:
    """Channels (machines, samples) in lb, in, s, mA, V, rad of machines that are driven by what is given at the samples.

    Args:
        machine: The machines.
        loop: One of `LOOPS`.
        rate_hz: Samples per second. The controller's period is a whole part or a whole multiple of the time between two.
        test_signal: At the amplifier, V at the samples, (samples,) or (machines, samples).
        command_signal: What the law adds to its command, likewise: a digital controller samples it and sends it on late.
        force: At the grip, lb, likewise.
        staircase: Whether the two signals keep each value until the next; otherwise they, and the force always, run straight.
        controller: The digital controller; None: analog.
        start: States (machines, 8), see `held`; None: all zero.
        smallest_s: Length within which a switch is taken to second order.
    """
    per_sample = 1 if controller is None else max(1, round(1 / (rate_hz * controller.period_s)))
    step = 1 / (rate_hz * per_sample)
    many, samples = (
        machine.each(),
        next(np.shape(signal)[-1] for signal in (test_signal, command_signal, force) if signal is not None),
    )
    e, e_rate = _on_steps(test_signal, samples, per_sample, staircase)
    added, added_rate = _on_steps(command_signal, samples, per_sample, staircase)
    f, f_rate = _on_steps(force, samples, per_sample, staircase=False)
    if controller is None:  # one place for both
        e, e_rate = e + added, e_rate + added_rate
    modes = _modes(many, loop, digital=controller is not None)
    march = ExactSteps(modes, step, smallest_s)
    z = np.zeros((len(many.area), SIZE))
    z[:, :8] = 0.0 if start is None else start
    z[:, ONE] = 1.0
    sampled = None if controller is None else _Sampled(many, loop, controller, (step, z))
    kept = np.empty((samples, len(KEPT) + 1, len(z)))
    for k in range(e.shape[1]):
        z[:, E], z[:, E_RATE] = e[:, k], e_rate[:, k] / step
        z[:, FORCE], z[:, FORCE_RATE] = f[:, k], f_rate[:, k] / step
        if sampled is not None:
            sampled.act(k, z, added[:, k])
        if k == 0:
            march.begin(z)
        elif staircase or sampled is not None:
            march.jump(z)
        if k % per_sample == 0:
            kept[k // per_sample, :-1] = z[:, KEPT].T
            kept[k // per_sample, -1] = np.einsum("mj,mj->m", modes.rows[:, 2], z)
        z = march.advance(z)
    return _channels(many, kept)


def _on_steps(values, samples, per_sample, staircase):
    """A drive at the start of each step and its change over the step, (1 or machines, steps)."""
    values = np.zeros((1, samples)) if values is None else np.atleast_2d(values)
    steps = np.arange((samples - 1) * per_sample + 1)
    at, part = steps // per_sample, steps % per_sample / per_sample
    if staircase:
        return values[:, at], 0.0 * values[:, at]
    change = np.diff(values, axis=1, append=values[:, -1:])[:, at]
    return values[:, at] + part * change, change / per_sample


def held(machine: Machine, loop: str, angle: float) -> np.ndarray:
    """States (machines, 8) at rest with the grip held at an angle: start of a release."""
    if loop == "servo-open":
        raise ValueError("loop: the open servo has no rest to be held in; close its position loop")
    many = machine.each()
    free = [X, P, QI, QI_RATE] + ([DELTA, DELTA_RATE] if loop == "loader" else [])
    stuck = _modes(many, loop, digital=False).rates[mode(0, 0)]
    states = np.zeros((len(many.area), 8))
    states[:, THETA] = angle
    right = -angle * stuck[:, free, THETA]
    states[:, free] = np.linalg.solve(stuck[np.ix_(range(len(states)), free, free)], right[..., np.newaxis])[..., 0]
    return states


def poles(machine: Machine, loop: str) -> np.ndarray:
    """Poles (machines, states) in 1/s while the column moves and no limit is reached, under an analog law."""
    many = machine.each()
    states = 8 if loop == "loader" else 6
    return np.linalg.eigvals(_modes(many, loop, digital=False).rates[mode(1, 0), :, :states, :states])


def _rows(m, loop, digital):
    """Rows on the vector that are watched: w, M and the current that is asked of the amplifier, (machines, 3, SIZE)."""
    rows = np.zeros((len(m.area), 3, SIZE))
    rows[:, 0, W] = 1.0
    rows[:, 1, P], rows[:, 1, FORCE] = m.ratio * m.base_arm * m.area, m.grip_arm
    rows[:, 2, E] = m.admittance
    if not digital and loop != "servo-open":
        rows[:, 2, X] = -m.admittance * m.potentiometer_gain
        rows[:, 2, DELTA] = m.admittance if loop == "loader" else 0.0
    return rows


def _modes(m, loop, digital):
    """Rate of change of the vector in each mode, and what is watched."""
    if loop not in LOOPS:
        raise ValueError(f"loop: expected {', '.join(LOOPS)}, got {loop!r}")
    rows = _rows(m, loop, digital)
    lever = m.ratio * m.base_arm
    modes = np.zeros((9, len(m.area), SIZE, SIZE))
    for motion, current in product((-1, 0, 1), repeat=2):
        a = modes[mode(motion, current)]
        # x' = (A p - k s) / c + alpha R_b w                                                               eq. (9)
        a[:, X, P], a[:, X, X] = m.area / m.link_damping, -m.link_stiffness / m.link_damping
        a[:, X, THETA], a[:, X, W] = lever * m.link_stiffness / m.link_damping, lever
        compressed = -m.area[:, np.newaxis] * a[:, X]
        compressed[:, QI] += 1.0
        compressed[:, P] -= m.pressure_gain
        a[:, P] = (4 * m.bulk_modulus / m.oil_volume)[:, np.newaxis] * compressed  # eqs. (4), (5)
        a[:, QI, QI_RATE] = 1.0
        gain = (m.current_gain * m.valve_frequency**2)[:, np.newaxis]
        if current:
            a[:, QI_RATE, ONE] = current * gain[:, 0] * np.where(np.isinf(m.current_limit), 0.0, m.current_limit)
        else:
            a[:, QI_RATE] = gain * rows[:, 2]
        a[:, QI_RATE, QI] -= m.valve_frequency**2
        a[:, QI_RATE, QI_RATE] -= 2 * m.valve_damping * m.valve_frequency
        if motion:
            a[:, THETA, W] = 1.0
            a[:, W] = rows[:, 1] / m.inertia[:, np.newaxis]
            a[:, W, ONE] = -motion * m.grip_arm * m.coulomb_friction / m.inertia
        if loop == "loader":
            a[:, DELTA, DELTA_RATE] = 1.0
            a[:, DELTA_RATE, DELTA] = -m.feel_stiffness / m.feel_inertia
            a[:, DELTA_RATE, DELTA_RATE] = -m.feel_damping / m.feel_inertia
            a[:, DELTA_RATE, TORQUE] = 1.0 / m.feel_inertia
            if not digital:
                a[:, DELTA_RATE, P] = -m.maximum_stiffness * m.load_cell_gain * m.area / m.feel_inertia
        a[:, E, E_RATE] = a[:, FORCE, FORCE_RATE] = 1.0
    return Modes(modes, rows, W, m.grip_arm * np.maximum(m.static_friction, m.coulomb_friction), m.current_limit)


class _Sampled:
    """The digital controller at work."""

    def __init__(self, m, loop, controller, start):
        step, z = start
        self.m, self.loop, self.controller = m, loop, controller
        self.every = max(1, round(controller.period_s / step))
        if abs(self.every * step / controller.period_s - 1) > 1e-9:
            raise ValueError(
                f"period: {controller.period_s} s is no whole part or multiple of the time between two samples"
            )
        self.waiting = [self.command(z)] * (controller.delay + 1)

    def command(self, z):
        """What the law makes of the state."""
        if self.loop == "servo-open":
            return np.zeros(len(z))
        return z[:, DELTA] - self.m.potentiometer_gain * z[:, X]

    def act(self, step, z, added):
        """Adds the command to what is at the amplifier, and gives the feel computer its torque."""
        if step % self.every == 0:
            self.waiting = [*self.waiting[1:], self.command(z) + added]
            self.torque = -self.m.maximum_stiffness * self.m.load_cell_gain * self.m.area * z[:, P]
        z[:, TORQUE] = self.torque
        z[:, E] += self.waiting[0]


def _channels(m, kept):
    """What sensors without fault would show, (machines, samples), of `KEPT` and the current that was asked at each sample."""
    x, p, q_i, theta, w, command = np.moveaxis(kept, 0, 2)
    each = {field.name: getattr(m, field.name)[:, np.newaxis] for field in fields(m)}
    force = each["area"] * p
    return {
        "column_angle": theta,
        "column_velocity": w,
        "piston_position": x,
        "load_cell_force": force,
        "load_pressure": p,
        "actuator_flow": q_i - each["pressure_gain"] * p,
        "valve_current": np.clip(command, -each["current_limit"], each["current_limit"]),
        "potentiometer": each["potentiometer_gain"] * x,
        # Positive when the pilot pushes, which loads the link backwards, eq. (6).
        "load_cell": -each["load_cell_gain"] * force,
    }
