"""Electric machines, nonlinear, many side by side, for ``grip_sensor.py --electric``: shares no line with the engine.

SI units. The motor drives the link through a lead without friction, backlash or give; its winding is as warm as the air.

``x``, ``v`` drive's end and its rate · ``i`` current · ``e`` command · ``theta``, ``w`` column and its rate · ``F`` link ·
``u`` voltage

    F = k (x - alpha R_b theta) + c (v - alpha R_b w)
    v' = r / J_m (K_t i - r F)
    L i' = u - R i - K_e v / r,    u = R i + K_e v / r + w_c L (e - i), at most +-u_max,    K_e = 2 K_t / 3 of three phases
    (J + m) w' = alpha R_b F - d w - k_a theta - F_c R_p sgn w

At rest the column sticks while ``|alpha R_b F - k_a theta| <= F_c R_p``. What is linear takes the exact steps of
``rubbing_column.py``; what the voltage's limit takes from ``i'`` is carried on straight from the last two (second order).
"""

from dataclasses import dataclass

import numpy as np
from rubbing_column import Friction, OnLink, Places, Rubbing

STEP_S = 5e-5
"""A third of the current loop's time constant."""
OF_FILE = {
    "torque_constant": "motor.torque_constant",
    "rotor": "motor.inertia",
    "resistance": "winding.resistance",
    "inductance": "winding.inductance",
    "bandwidth": "current_loop.bandwidth",
    "current_limit": "current_loop.current_limit",
    "voltage_limit": "current_loop.voltage_limit",
    "travel": "transmission.travel",
    "ratio": "linkage.ratio",
    "link_stiffness": "linkage.stiffness",
    "link_damping": "linkage.damping",
    "inertia": "column.inertia",
    "base_arm": "column.base_arm",
    "grip_arm": "column.grip_arm",
}
"""The file's row for each number of a machine."""
PER_PHASE = 2 / 3
"""Back-EMF in torque constant, peak values of three phases."""
X, V, CURRENT, THETA, W, COMMAND, DEFICIT, DRY = range(8)
"""Places in the vector: states, then what is constant over a step: command, what the voltage takes from ``i'``, friction."""
PLACES = Places(THETA, W, DRY, states=5)


@dataclass(frozen=True)
class Machines(OnLink):
    """Numbers of the machines, (machines,) each; friction as forces at the grip, arms about the column's pivot."""

    torque_constant: np.ndarray
    rotor: np.ndarray
    resistance: np.ndarray
    inductance: np.ndarray
    bandwidth: np.ndarray
    current_limit: np.ndarray
    voltage_limit: np.ndarray
    travel: np.ndarray
    ratio: np.ndarray
    link_stiffness: np.ndarray
    link_damping: np.ndarray
    inertia: np.ndarray
    base_arm: np.ndarray
    grip_arm: np.ndarray
    friction: np.ndarray
    arm_inertia: np.ndarray
    arm_damping: np.ndarray
    arm_stiffness: np.ndarray

    @property
    def held_by(self):
        """Command that holds a newton of the link, A."""
        return self.travel / self.torque_constant

    @property
    def command_limit(self):
        """Largest command, A."""
        return self.current_limit


def _rates(m):
    """Matrix of rates on the vector, the column moving, (machines, 8, 8)."""
    link = np.zeros((len(m.rotor), 8))
    link[:, X], link[:, V] = m.link_stiffness, m.link_damping
    link[:, THETA], link[:, W] = -m.lever * m.link_stiffness, -m.lever * m.link_damping
    a = np.zeros((len(m.rotor), 8, 8))
    a[:, X, V] = a[:, THETA, W] = 1.0
    a[:, V] = -(m.travel**2 / m.rotor)[:, None] * link
    a[:, V, CURRENT] = m.travel * m.torque_constant / m.rotor
    a[:, CURRENT, COMMAND], a[:, CURRENT, CURRENT], a[:, CURRENT, DEFICIT] = m.bandwidth, -m.bandwidth, 1.0
    a[:, W] = (m.lever / m.turned)[:, None] * link
    a[:, W, THETA] -= m.arm_stiffness / m.turned
    a[:, W, W] -= m.arm_damping / m.turned
    a[:, W, DRY] = 1 / m.turned
    return a


class Motion(Rubbing):
    """Machines on their way, ``z`` (machines, 8).

    Args:
        m: The machines.
        y: At rest: force of the link in N and the drive's end in m, then others, (machines, 2 and more).
        held: Angle of the column.
    """

    def __init__(self, m, y, held):
        dry = m.grip_arm * m.friction
        super().__init__(_rates(m), PLACES, STEP_S, Friction(dry, dry))
        self.machines, self.deficit = m, np.zeros(len(m.rotor))
        self.z[:, X], self.z[:, THETA] = y[:, 1], held
        self.z[:, CURRENT] = m.held_by * y[:, 0]

    def link(self, z):
        """F of vectors."""
        m = self.machines
        return m.link_stiffness * (z[:, X] - m.lever * z[:, THETA]) + m.link_damping * (z[:, V] - m.lever * z[:, W])

    def torque(self, z):
        """Torque on the column beside friction."""
        m = self.machines
        return m.lever * self.link(z) - m.arm_stiffness * z[:, THETA] - m.arm_damping * z[:, W]

    def shown(self):
        """Force of the link in N, the drive's end in m, the column's angle."""
        return self.link(self.z), self.z[:, X], self.z[:, THETA]

    def run(self, command, time_s):
        """On for a time under a command in A."""
        for _ in range(round(time_s / STEP_S)):
            self._step(np.clip(command, -self.machines.current_limit, self.machines.current_limit))

    def _step(self, command):
        m, z = self.machines, self.z
        z[:, COMMAND] = command
        back = PER_PHASE * m.torque_constant * z[:, V] / m.travel
        voltage = m.resistance * z[:, CURRENT] + back + m.bandwidth * m.inductance * (command - z[:, CURRENT])
        before = self.deficit
        self.deficit = (np.clip(voltage, -m.voltage_limit, m.voltage_limit) - voltage) / m.inductance
        z[:, DEFICIT] = 1.5 * self.deficit - 0.5 * before
        self.advance()
