"""Hydraulic machines, nonlinear, many side by side: the integrator of ``commission.py``, which shares no line with the engine.

U.S. customary units: lb, in, s, mA, V, rad; the servo alone, its position loop closed by a digital controller.

``x`` piston · ``p`` load pressure · ``q_i`` valve · ``theta``, ``w`` column and its rate · ``i`` current · ``e`` command

    x' = (A p - k s - F) / c + alpha R_b w,    s = x - alpha R_b theta                                eq. (9)
    p' = 4 beta / V_E (q - A x'),          q = q_i sqrt(1 - sgn(q_i) p / p_s)                         eqs. (5), (1)
    q_i'' = w_n^2 (q_c - q_i) - 2 zeta w_n q_i',    q_c = (q_r / i_r) i,    i = K_2 e                 eq. (3)
    (J + m) w' = alpha R_b (A p - F) - d w - k_a theta - F_c R_p sgn w                                eqs. (6), (7), and an arm
    e = - K_3 x  of the last sample but one, through its sensor, and the test signal                  eq. (13)

``F`` friction of the seals: what pushes the piston, ``A p - k s + c alpha R_b w``, as far as it is no more than they hold. At rest
the column sticks while ``|alpha R_b (A p - F) - k_a theta| <= F_s R_p``; for Stribeck and asymmetry see ``rubbing_column.py``.
All that is linear takes the exact steps of ``rubbing_column.py``; what the orifice takes from the flow, ``q - q_i``, is carried on
straight from the last two (second order).
Angle, piston, force and current are within 1e-4 of the engine's r.m.s., friction and all.
"""

from dataclasses import dataclass, fields

import numpy as np
from rubbing_column import Friction, OnLink, Places, Rubbing

STEP_S, PERIOD_S = 1e-4, 5e-4
LBF, INCH = 4.4482216152605, 0.0254  # N, m
SI = {
    "column_angle": 1.0,
    "piston_position": INCH,
    "load_cell_force": LBF,
    "load_pressure": LBF / INCH**2,
    "valve_current": 1e-3,
}
OF_FILE = {
    "admittance": ("amplifier.admittance", 1e3),
    "rated_flow": ("valve.rated_flow", INCH**-3),
    "supply_pressure": ("valve.supply_pressure", INCH**2 / LBF),
    "valve_frequency": ("valve.natural_frequency", 1.0),
    "valve_damping": ("valve.damping_ratio", 1.0),
    "area": ("actuator.area", INCH**-2),
    "oil_volume": ("actuator.oil_volume", INCH**-3),
    "bulk_modulus": ("actuator.bulk_modulus", INCH**2 / LBF),
    "ratio": ("linkage.ratio", 1.0),
    "link_stiffness": ("linkage.stiffness", INCH / LBF),
    "link_damping": ("linkage.damping", INCH / LBF),
    "inertia": ("column.inertia", 1 / LBF / INCH),
    "base_arm": ("column.base_arm", 1 / INCH),
    "grip_arm": ("column.grip_arm", 1 / INCH),
    "coulomb_friction": ("column.coulomb_friction", 1 / LBF),
    "static_friction": ("column.static_friction", 1 / LBF),
    "stribeck_velocity": ("column.stribeck_velocity", 1.0),
    "friction_asymmetry": ("column.friction_asymmetry", 1.0),
    "seal_friction": ("actuator.seal_friction", 1 / LBF),
}
"""The file's row for each number of a machine, and its unit there in the SI one."""
X, P, QI, QI_RATE, THETA, W, COMMAND, DEFICIT, DRY, SEALS = range(10)
"""Places in the vector: states, then what is constant over a step: commanded flow, ``q - q_i``, the torque of friction, F."""
PLACES = Places(THETA, W, DRY, states=6)


@dataclass(frozen=True)
class Machines(OnLink):
    """Numbers of the machines, (machines,) each."""

    admittance: np.ndarray
    rated_flow: np.ndarray
    supply_pressure: np.ndarray
    valve_frequency: np.ndarray
    valve_damping: np.ndarray
    area: np.ndarray
    oil_volume: np.ndarray
    bulk_modulus: np.ndarray
    ratio: np.ndarray
    link_stiffness: np.ndarray
    link_damping: np.ndarray
    inertia: np.ndarray
    base_arm: np.ndarray
    grip_arm: np.ndarray
    coulomb_friction: np.ndarray
    static_friction: np.ndarray
    stribeck_velocity: np.ndarray | float = 0.0
    friction_asymmetry: np.ndarray | float = 0.0
    seal_friction: np.ndarray | float = 0.0
    rated_current: float = 15.0
    current_limit: float = 15.0
    flow_limit: float = 100.0
    potentiometer_gain: float = 7.632
    arm_inertia: float | np.ndarray = 0.0
    arm_damping: float | np.ndarray = 0.0
    arm_stiffness: float | np.ndarray = 0.0
    """Of a pilot's arm, about the column's pivot."""

    @classmethod
    def of(cls, **values):
        """Machines of numbers or arrays."""
        return cls(**{name: np.atleast_1d(np.asarray(value, float)) for name, value in values.items()})

    @property
    def held_by(self):
        """Command that holds a force: none, the valve is shut."""
        return 0.0 * self.area

    @property
    def command_limit(self):
        """Largest command that the amplifier follows, V."""
        return self.current_limit / self.admittance


@dataclass(frozen=True)
class Sensors:
    """What shows the piston to the controller: bandwidth in rad/s, noise and step in in."""

    bandwidth: float
    noise: float
    step: float


def _rates(m):
    """Matrix of rates on the vector, the column moving, (machines, 10, 10)."""
    a = np.zeros((len(m.area), 10, 10))
    a[:, X, P], a[:, X, X] = m.area / m.link_damping, -m.link_stiffness / m.link_damping
    a[:, X, SEALS] = -1 / m.link_damping
    a[:, X, THETA], a[:, X, W] = m.lever * m.link_stiffness / m.link_damping, m.lever
    a[:, P] = -m.area[:, None] * a[:, X]
    a[:, P, QI] += 1.0
    a[:, P, DEFICIT] = 1.0
    a[:, P] *= (4 * m.bulk_modulus / m.oil_volume)[:, None]
    a[:, QI, QI_RATE] = 1.0
    a[:, QI_RATE, COMMAND], a[:, QI_RATE, QI] = m.valve_frequency**2, -(m.valve_frequency**2)
    a[:, QI_RATE, QI_RATE] = -2 * m.valve_damping * m.valve_frequency
    a[:, THETA, W] = 1.0
    a[:, W, P], a[:, W, DRY] = m.lever * m.area / m.turned, 1 / m.turned
    a[:, W, SEALS] = -m.lever / m.turned
    a[:, W, THETA], a[:, W, W] = -m.arm_stiffness / m.turned, -m.arm_damping / m.turned
    return a


class Motion(Rubbing):
    """Machines on their way from rest at zero, ``z`` (machines, 10)."""

    def __init__(self, m):
        levels = (m.grip_arm * m.coulomb_friction, m.grip_arm * m.static_friction)
        friction = Friction(*levels, m.stribeck_velocity, m.friction_asymmetry)
        super().__init__(_rates(m), PLACES, STEP_S, friction)
        self.machines, self.deficit, self.seals = m, *np.zeros((2, len(m.area)))

    def current(self, command):
        """What the amplifier gives, mA, of a command in V."""
        return np.clip(self.machines.admittance * command, -self.machines.current_limit, self.machines.current_limit)

    def torque(self, z):
        """Torque on the column beside friction."""
        m = self.machines
        return m.lever * (m.area * z[:, P] - self.seals) - m.arm_stiffness * z[:, THETA] - m.arm_damping * z[:, W]

    def step(self, current):
        """A step of ``STEP_S``."""
        m, z = self.machines, self.z
        z[:, COMMAND] = np.clip(m.rated_flow / m.rated_current * current, -m.flow_limit, m.flow_limit)
        left = np.maximum(1 - np.sign(z[:, QI]) * z[:, P] / m.supply_pressure, 0.0)
        before, self.deficit = self.deficit, z[:, QI] * (np.sqrt(left) - 1)
        z[:, DEFICIT] = 1.5 * self.deficit - 0.5 * before
        stretch = z[:, X] - m.lever * z[:, THETA]
        push = m.area * z[:, P] - m.link_stiffness * stretch + m.link_damping * m.lever * z[:, W]
        z[:, SEALS] = self.seals = np.clip(push, -m.seal_friction, m.seal_friction)
        self.advance()


def run(m, signal, rate_hz, sensors, noise):
    """Channels (machines, samples) in SI units under a test signal at the amplifier, V at the samples, straight between.

    ``noise`` has the normal numbers of each machine's sensor, (periods, machines), so that neighbors have no say in them.
    """
    many, samples = len(m.area), len(signal)
    motion = Motion(m)
    z = motion.z
    per_sample, per_period = round(1 / rate_hz / STEP_S), round(PERIOD_S / STEP_S)
    lag, waiting, held = np.zeros(many), np.zeros(many), np.zeros(many)
    decay = np.exp(-sensors.bandwidth * STEP_S)
    kept = np.empty((samples, 7, many))
    for k in range((samples - 1) * per_sample + 1):
        if k % per_period == 0:
            readings = np.round((lag + sensors.noise * noise[k // per_period]) / sensors.step) * sensors.step
            held, waiting = waiting, -m.potentiometer_gain * readings
        at, part = divmod(k, per_sample)
        ahead = signal[min(at + 1, samples - 1)]
        middle = signal[at] + (part + 0.5) / per_sample * (ahead - signal[at])
        if part == 0:
            kept[at, :6], kept[at, 6] = z[:, [X, P, THETA, W, QI, SEALS]].T, motion.current(held + signal[at])
        before = z[:, X].copy()
        motion.step(motion.current(held + middle))
        slope = (z[:, X] - before) / (sensors.bandwidth * STEP_S)
        lag = z[:, X] - slope + (lag - before + slope) * decay
    x, p, theta, _, _, seals, current = np.moveaxis(kept, 0, 2)
    columns = {
        "column_angle": theta,
        "piston_position": x,
        "load_cell_force": m.area[:, None] * p - seals,
        "load_pressure": p,
        "valve_current": current,
    }
    return {name: SI[name] * values for name, values in columns.items()}


def some(m, which):
    """Some of the machines."""
    return Machines(
        **{field.name: (v[which] if isinstance(v := getattr(m, field.name), np.ndarray) else v) for field in fields(m)}
    )
