"""Machines side by side whose column rubs, step by step: what the witnesses of both drives share, and no line of the engine.

``w`` rate of the column · ``T`` torque on it beside friction · ``C``, ``B`` torques of the dry friction that moves and that holds ·
``w_s`` Stribeck velocity · ``a`` asymmetry · ``s`` direction

    T - (C + (B - C) exp(-(w / w_s)^2)) (1 + a s) s  moves it;  at rest it sticks while |T| <= B (1 + a sgn T)

What is linear takes exact steps by a matrix exponential for each machine; friction and hand are constant over a step. Where the
column turns round in one, it rests at its end, or what is left of the step goes the other way.
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


@dataclass(frozen=True)
class Friction:
    """C and B, w_s and a, (machines,) each; without w_s friction falls with a jump."""

    coulomb: np.ndarray
    breakaway: np.ndarray
    stribeck: np.ndarray | float = 0.0
    asymmetry: np.ndarray | float = 0.0

    def level(self, direction, rate):
        """Torque of a motion in a direction."""
        slow = np.where(np.asarray(self.stribeck) > 0, self.stribeck, 1.0)
        fall = np.where(np.asarray(self.stribeck) > 0, np.exp(-((rate / slow) ** 2)), 0.0)
        return (self.coulomb + (self.breakaway - self.coulomb) * fall) * (1 + self.asymmetry * direction)

    def holds(self, torque):
        """Whether it holds a column at rest."""
        return np.abs(torque) <= self.breakaway * (1 + self.asymmetry * np.sign(torque))


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
        friction: That of the column.

    Attributes:
        hand: Torque of a hand on each column, constant over a step.
    """

    def __init__(self, rates, places, step_s, friction):
        many, size, _ = rates.shape
        stuck = rates.copy()
        stuck[:, [places.angle, places.rate]] = 0.0
        exact = (np.array([expm(step_s * rate_matrix)[: places.states] for rate_matrix in of]) for of in (rates, stuck))
        self.slide, self.stick = exact
        self.places, self.friction = places, friction
        self.z, self.rests, self.hand = np.zeros((many, size)), np.ones(many, dtype=bool), 0.0

    def torque(self, z):
        """T of vectors beside the hand's; each drive has its own."""
        raise NotImplementedError

    def push(self, z):
        """T."""
        return self.torque(z) + self.hand

    def advance(self):
        """A step under what stands in the vector but the friction."""
        z, rate, states = self.z, self.places.rate, self.places.states
        torque = self.push(z)
        self.rests &= self.friction.holds(torque)
        direction = np.where(z[:, rate] != 0, np.sign(z[:, rate]), np.sign(torque))
        level = self.friction.level(direction, z[:, rate])
        z[:, self.places.dry] = self.hand - direction * level
        after = (self.slide @ z[:, :, None])[:, :, 0]
        turned = after[:, rate] * direction < 0
        if self.rests.any():
            after[self.rests] = (self.stick[self.rests] @ z[self.rests][:, :, None])[:, :, 0]
        # A column that turns round goes on with what is left of the step, if friction does not hold it.
        push = self.push(after)
        held_now = turned & self.friction.holds(push)
        back = self.friction.level(-direction, 0.0)
        slower = np.clip((push + direction * back) / np.where(turned, push - direction * level, 1.0), 0.0, 1.0)
        after[turned, rate] *= slower[turned]
        after[self.rests | held_now, rate] = 0.0
        self.rests |= held_now
        z[:, :states] = after
