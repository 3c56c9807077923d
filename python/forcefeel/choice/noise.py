"""Effect of the sensor noise on the grip, from the linear loop.

A hand at the grip feels ``F = R_p (m theta'' + d theta' + k theta)`` of its own arm, with ``theta'`` and ``theta''`` as
central differences from sample to sample.
"""

from dataclasses import dataclass
from typing import Annotated

from forcefeel.envelope.cases import REFERENCE_ARMS, PilotArm
from forcefeel.laws.law import Law
from forcefeel.loader.arms import ARM_ROWS
from forcefeel.loader.loader import Loader
from forcefeel.simulation.noisy_loop import NoisyLoop
from forcefeel.units import ANGLE, FORCE

HOLDING: PilotArm = REFERENCE_ARMS[-1]
"""Arm at the grip: the firmest of the reference arms."""


@dataclass(frozen=True)
class Noise:
    """Effect of the sensor noise on the grip, r.m.s.

    Attributes:
        angle_rad: Column angle, hands off; infinite for an unstable loop.
        force_n: Force on a hand with the arm ``HOLDING``; infinite if the loop is unstable with it.
    """

    angle_rad: Annotated[float, ANGLE]
    force_n: Annotated[float, FORCE]


def noise_at_grip(loader: Loader, law: Law) -> Noise | None:
    """Effect of the sensor noise on the grip of a loader without an arm, under one law; ``None`` for an analog loader."""
    if not loader["controller.period"]:
        return None
    held = loader.replace(dict(zip(ARM_ROWS, HOLDING.values, strict=True)), si=True)
    return Noise(NoisyLoop.of(loader, law).angle_rms(), hand_force_rms(NoisyLoop.of(held, law), held))


def hand_force_rms(loop: NoisyLoop, loader: Loader) -> float:
    """R.m.s. force in N on the hand with the loader's arm."""
    mass, damping, stiffness = (loader[row] for row in ARM_ROWS)
    lever, t = loader["column.grip_arm"], loop.period_s
    swing, drag = mass / t**2, damping / (2 * t)
    return loop.filtered_rms(lever * (swing - drag), lever * (stiffness - 2 * swing), lever * (swing + drag))
