"""Hydraulic machines, nonlinear, many side by side: the integrator of ``commission.py``, which shares no line with the engine.

U.S. customary units: lb, in, s, mA, V, rad; the servo alone, its position loop closed by a digital controller.

``x`` piston · ``p`` load pressure · ``q_i`` valve · ``theta``, ``w`` column and its rate · ``i`` current · ``e`` command

    x' = (A p - k s) / c + alpha R_b w,    s = x - alpha R_b theta                                    eq. (9)
    p' = 4 beta / V_E (q - A x'),          q = q_i sqrt(1 - sgn(q_i) p / p_s)                         eqs. (5), (1)
    q_i'' = w_n^2 (q_c - q_i) - 2 zeta w_n q_i',    q_c = (q_r / i_r) i,    i = K_2 e                 eq. (3)
    J w' = alpha R_b A p - F_c R_p sgn w                                                              eqs. (6), (7)
    e = - K_3 x  of the last sample but one, through its sensor, and the test signal                  eq. (13)

At rest the column sticks while ``|alpha R_b A p| <= F_s R_p``. All that is linear takes exact steps by a matrix exponential for
each machine; what the orifice takes from the flow, ``q - q_i``, is carried on straight from the last two steps (second order), and
friction is constant over a step; where the column turns round in one, it rests at its end, or what is left of the step goes the
other way. Angle, piston, force and current are within 1e-4 of the engine's r.m.s., friction and all.
"""

from dataclasses import dataclass, fields

import numpy as np
from scipy.linalg import expm

STEP_S, PERIOD_S = 1e-4, 5e-4
LBF, INCH = 4.4482216152605, 0.0254  # N, m
SI = {
    "column_angle": 1.0,
    "piston_position": INCH,
    "load_cell_force": LBF,
    "load_pressure": LBF / INCH**2,
    "valve_current": 1e-3,
}
X, P, QI, QI_RATE, THETA, W, COMMAND, DEFICIT, DRY = range(9)
"""Places in the vector: states, then what is constant over a step: commanded flow, ``q - q_i``, the torque of friction."""
STATES = 6


@dataclass(frozen=True)
class Machines:
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
    rated_current: float = 15.0
    current_limit: float = 15.0
    flow_limit: float = 100.0
    potentiometer_gain: float = 7.632

    @classmethod
    def of(cls, **values):
        """Machines of numbers or arrays."""
        return cls(**{name: np.atleast_1d(np.asarray(it, float)) for name, it in values.items()})

    @property
    def lever(self):
        """alpha R_b."""
        return self.ratio * self.base_arm


@dataclass(frozen=True)
class Sensors:
    """What shows the piston to the controller: bandwidth in rad/s, noise and step in in."""

    bandwidth: float
    noise: float
    step: float


def _rates(m):
    """Matrix of rates on the vector, the column moving, (machines, 9, 9)."""
    a = np.zeros((len(m.area), 9, 9))
    a[:, X, P], a[:, X, X] = m.area / m.link_damping, -m.link_stiffness / m.link_damping
    a[:, X, THETA], a[:, X, W] = m.lever * m.link_stiffness / m.link_damping, m.lever
    a[:, P] = -m.area[:, None] * a[:, X]
    a[:, P, QI] += 1.0
    a[:, P, DEFICIT] = 1.0
    a[:, P] *= (4 * m.bulk_modulus / m.oil_volume)[:, None]
    a[:, QI, QI_RATE] = 1.0
    a[:, QI_RATE, COMMAND], a[:, QI_RATE, QI] = m.valve_frequency**2, -(m.valve_frequency**2)
    a[:, QI_RATE, QI_RATE] = -2 * m.valve_damping * m.valve_frequency
    a[:, THETA, W] = 1.0
    a[:, W, P], a[:, W, DRY] = m.lever * m.area / m.inertia, 1 / m.inertia
    return a


def run(m, signal, rate_hz, sensors, seed):
    """Channels (machines, samples) in SI units under a test signal at the amplifier, V at the samples, straight between."""
    many, samples = len(m.area), len(signal)
    moving = _rates(m)
    stuck = moving.copy()
    stuck[:, [THETA, W]] = 0.0
    slide, stick = (np.array([expm(STEP_S * one)[:STATES] for one in of]) for of in (moving, stuck))
    coulomb, breakaway = (m.grip_arm * it for it in (m.coulomb_friction, m.static_friction))
    per_sample, per_period = round(1 / rate_hz / STEP_S), round(PERIOD_S / STEP_S)
    random = np.random.default_rng(seed)
    z, lag, rests = np.zeros((many, 9)), np.zeros(many), np.ones(many, dtype=bool)
    deficit, waiting, held = np.zeros(many), np.zeros(many), np.zeros(many)
    decay = np.exp(-sensors.bandwidth * STEP_S)
    kept = np.empty((samples, 6, many))
    for k in range((samples - 1) * per_sample + 1):
        if k % per_period == 0:
            shown = np.round((lag + sensors.noise * random.standard_normal(many)) / sensors.step) * sensors.step
            held, waiting = waiting, -m.potentiometer_gain * shown
        at, part = divmod(k, per_sample)
        ahead = signal[min(at + 1, samples - 1)]
        middle = signal[at] + (part + 0.5) / per_sample * (ahead - signal[at])
        current = np.clip(m.admittance * (held + middle), -m.current_limit, m.current_limit)
        if part == 0:
            now = np.clip(m.admittance * (held + signal[at]), -m.current_limit, m.current_limit)
            kept[at, :5], kept[at, 5] = z[:, [X, P, THETA, W, QI]].T, now
        z[:, COMMAND] = np.clip(m.rated_flow / m.rated_current * current, -m.flow_limit, m.flow_limit)
        left = np.maximum(1 - np.sign(z[:, QI]) * z[:, P] / m.supply_pressure, 0.0)
        before, deficit = deficit, z[:, QI] * (np.sqrt(left) - 1)
        z[:, DEFICIT] = 1.5 * deficit - 0.5 * before
        torque = m.lever * m.area * z[:, P]
        rests &= np.abs(torque) <= breakaway
        way = np.where(z[:, W] != 0, np.sign(z[:, W]), np.sign(torque))
        z[:, DRY] = -way * coulomb
        after = (slide @ z[:, :, None])[:, :, 0]
        turned = after[:, W] * way < 0
        if rests.any():
            after[rests] = (stick[rests] @ z[rests][:, :, None])[:, :, 0]
        # A column that turns round goes on with what is left of the step, if friction does not hold it.
        push = m.lever * m.area * after[:, P]
        held_now = turned & (np.abs(push) <= breakaway)
        slower = np.clip((push + way * coulomb) / np.where(turned, push - way * coulomb, 1.0), 0.0, 1.0)
        after[turned, W] *= slower[turned]
        after[rests | held_now, W] = 0.0
        rests |= held_now
        slope = (after[:, X] - z[:, X]) / (sensors.bandwidth * STEP_S)
        lag = after[:, X] - slope + (lag - z[:, X] + slope) * decay
        z[:, :STATES] = after
    x, p, theta, _, _, current = np.moveaxis(kept, 0, 2)
    shown = {
        "column_angle": theta,
        "piston_position": x,
        "load_cell_force": m.area[:, None] * p,
        "load_pressure": p,
        "valve_current": current,
    }
    return {name: SI[name] * values for name, values in shown.items()}


def some(m, which):
    """Some of the machines."""
    return Machines(
        **{it.name: (v[which] if isinstance(v := getattr(m, it.name), np.ndarray) else v) for it in fields(m)}
    )
