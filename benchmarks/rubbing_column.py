"""Machines side by side whose column rubs, step by step: what the witnesses of both drives share, and no line of the engine.

``w`` rate of the column · ``T`` torque on it beside friction · ``C``, ``B`` torques of the dry friction that moves and that holds

    T - C sgn w  moves it;  at rest it sticks while |T| <= B

What is linear takes exact steps by a matrix exponential for each machine; friction is constant over a step. Where the column turns
round in one, it rests at its end, or what is left of the step goes the other way.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm


@dataclass(frozen=True)
class Places:
    """Of column angle, its rate and the torque of friction in a machine's vector; how many of it are states."""

    angle: int
    rate: int
    dry: int
    states: int


class OnLink:
    """Machines of either drive, by the linkage's ratio, the column's arms and inertia, and a pilot's arm."""

    @property
    def lever(self):
        """alpha R_b."""
        return self.ratio * self.base_arm

    @property
    def turned(self):
        """J + m."""
        return self.inertia + self.arm_inertia


class Rubbing:
    """Machines on their way, ``z`` (machines, n), and which of them dry friction holds.

    Args:
        rates: Matrix of rates on the vector, the column moving, (machines, n, n).
        places: What stands where in it.
        step_s: The step.
        friction: C and B, (machines,) each.
    """

    def __init__(self, rates, places, step_s, friction):
        many, size, _ = rates.shape
        stuck = rates.copy()
        stuck[:, [places.angle, places.rate]] = 0.0
        exact = (np.array([expm(step_s * rate_matrix)[: places.states] for rate_matrix in of]) for of in (rates, stuck))
        self.slide, self.stick = exact
        self.places, (self.coulomb, self.breakaway) = places, friction
        self.z, self.rests = np.zeros((many, size)), np.ones(many, dtype=bool)

    def torque(self, z):
        """T of vectors; each drive has its own."""
        raise NotImplementedError

    def push(self):
        """T now."""
        return self.torque(self.z)

    def advance(self):
        """A step under what stands in the vector but the friction."""
        z, rate, states = self.z, self.places.rate, self.places.states
        torque = self.push()
        self.rests &= np.abs(torque) <= self.breakaway
        direction = np.where(z[:, rate] != 0, np.sign(z[:, rate]), np.sign(torque))
        z[:, self.places.dry] = -direction * self.coulomb
        after = (self.slide @ z[:, :, None])[:, :, 0]
        turned = after[:, rate] * direction < 0
        if self.rests.any():
            after[self.rests] = (self.stick[self.rests] @ z[self.rests][:, :, None])[:, :, 0]
        # A column that turns round goes on with what is left of the step, if friction does not hold it.
        push = self.torque(after)
        held_now = turned & (np.abs(push) <= self.breakaway)
        slower = np.clip(
            (push + direction * self.coulomb) / np.where(turned, push - direction * self.coulomb, 1.0), 0.0, 1.0
        )
        after[turned, rate] *= slower[turned]
        after[self.rests | held_now, rate] = 0.0
        self.rests |= held_now
        z[:, :states] = after
