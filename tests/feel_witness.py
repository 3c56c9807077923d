"""An aircraft's control by formulas of its own: force over position, sweeps and releases; no code of the engine."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from forcefeel.qualification import ForcePoints, Record

ARM_M = 31.375 * 0.0254
"""Arm of the grip of the built-in elevator."""
STEP_S = 1e-4
"""Step of the integration; halving it moves no release by 1e-5 rad."""
BUILD_UP_RAD = math.radians(0.1)
"""Angle over which breakout builds up, as the default of a loader."""


def linear(angle_deg):
    """6 N/deg."""
    return 6.0 * angle_deg


def progressive(angle_deg):
    """3 N/deg at neutral, 12 N/deg at 12 deg."""
    return 3.0 * angle_deg + 0.02 * angle_deg**3


def stopped(angle_deg):
    """5 N/deg, and 20 N/deg more beyond 8 deg."""
    return 25.0 * angle_deg + 10.0 * (abs(angle_deg - 8.0) - abs(angle_deg + 8.0))


@dataclass(frozen=True)
class Control:
    """Spring force in N over degrees, breakout, friction, inertia at the column and damping."""

    spring: Callable = linear
    breakout_n: float = 8.0
    friction_n: float = 6.0
    inertia: float = 1.6
    damping: float = 4.0

    def elastic(self, angle_rad):
        """Force without friction."""
        share = angle_rad / BUILD_UP_RAD
        return self.spring(math.degrees(1) * angle_rad) + self.breakout_n * (abs(share + 1) - abs(share - 1)) / 2

    def static(self, angle_rad, direction):
        """Force that moves it slowly."""
        return self.elastic(angle_rad) + self.friction_n * np.asarray(direction)

    def points(self, angle_deg, direction, noise_n=0.0, seed=0, *, stated=True):
        """Measured points."""
        angle, direction = np.radians(angle_deg), np.broadcast_to(np.asarray(direction, float), np.shape(angle_deg))
        noise = noise_n * np.random.default_rng(seed).standard_normal(np.shape(angle_deg))
        return ForcePoints(
            angle, self.static(angle, direction) + noise, direction if stated else None, name="flight.csv"
        )

    def moved(self, angle_rad, forces_n):
        """Angles under a force for each step, friction as a set; before the first step at rest."""
        angle, speed, drag = angle_rad, 0.0, STEP_S * self.friction_n * ARM_M / self.inertia
        angles = []
        for force in forces_n.tolist():
            angles.append(angle)
            torque = ARM_M * (force - self.elastic(angle)) - self.damping * speed
            speed += STEP_S * torque / self.inertia
            speed = math.copysign(max(abs(speed) - drag, 0.0), speed)
            angle += STEP_S * speed
        return np.array(angles)

    def released(self, angle_deg, *, lasts_s=6.0, held_s=0.5, rate=200, noise_deg=0.0, seed=0):
        """A release: held, let go, and integrated."""
        free = self.moved(math.radians(angle_deg), np.zeros(round(lasts_s / STEP_S)))[:: round(1 / rate / STEP_S)]
        x = np.concatenate([np.full(round(held_s * rate), math.radians(angle_deg)), free])
        x = x + math.radians(noise_deg) * np.random.default_rng(seed).standard_normal(len(x))
        return Record(np.arange(len(x)) / rate, x, name="release.csv")

    def swept(self, throw_deg, duration_s, rate=100.0):
        """A sweep neutral, stop, opposite stop, neutral, under a force without corners."""
        part = 4 * np.arange(round(duration_s / STEP_S)) * STEP_S / duration_s
        most = float(self.static(math.radians(throw_deg), 1.0))

        def eased(share):
            return (1 - np.cos(np.pi * np.clip(share, 0, 1))) / 2

        force = most * (eased(part) - 2 * eased((part - 1) / 2) + eased(part - 3))
        every = round(1 / rate / STEP_S)
        x = self.moved(0.0, force)[::every]
        return Record(
            np.arange(len(x)) / rate, x, force[::every], name=f"sweep of {duration_s:g} s", noise=0.0, force_noise_n=0.0
        )
