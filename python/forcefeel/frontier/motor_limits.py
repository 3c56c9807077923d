"""Settings that the motor forbids to every law, and current or voltage demand of free responses.

For the hands-off release of I', B', G from ``theta_0``, as force and speed at the grip (``sizing.motor``):

    F = (J / R_p + m R_p) theta'',   v = R_p theta'       column, eqs. (6), (7), and rotor, m = J_m g^2
    share = max(|i| / i_max, |u| / u_max)

The stretch of the link is neglected: its relative effect is ``(w / w_link)^2``, ``w_link`` the frequency of the column on the link.
The share that holds ``F = G theta_0 / R_p`` at rest is computed separately.

**The first instant.** At the release the link's torque changes from ``-G theta_0`` to ``-J (G / I) theta_0``. The rotor,
``m_r = J_m / r^2`` at the drive's end, moves by the change s of the link's stretch, driven by at most the motor's largest force F_m
and the held force F_h of the link:

    t_0 = sqrt(2 m_r s / (F_m + F_h)),      s = |1 - J / I| F_h / k,     F_h = G theta_0 / (alpha R_b);

until then the link alone moves the column, whatever the law. Delay and current loop add to this time.
"""

from dataclasses import dataclass, field
from math import isfinite
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from forcefeel.envelope.plan import Plan
from forcefeel.frontier.drive_limits import DriveLimits, demands, motion
from forcefeel.frontier.second_order_bound import SettingGroup
from forcefeel.linear.electric import ElectricPlant
from forcefeel.linear.release_motion import holding_force
from forcefeel.loader.loader import Loader
from forcefeel.sizing.motor import Motor
from forcefeel.units import FORCE, PERCENT


@dataclass(frozen=True, eq=False)
class MotorLimits(DriveLimits):
    """Limits of the motor; zero demand on a limit that the loader file does not state.

    Attributes:
        peak_force_n: Force at the grip at the largest current, at rest; infinite without a limit.
        hold: Share of the largest current or voltage that holds each setting at the release angle, (settings,).
    """

    peak_force_n: Annotated[float, FORCE]
    hold: NDArray[np.float64] = field(repr=False)

    @property
    def largest_hold(self) -> Annotated[float, PERCENT]:
        """Largest share that holds a setting at rest."""
        return float(self.hold.max())


def motor_limits(plan: Plan, *, threads: int | None = None) -> MotorLimits:
    """Compute the limits of a plan's motor at its settings, from its rule and angle; its laws are not used."""
    motor, feel = Motor(plan.loader), plan.settings.feel(plan.loader)
    demand, forbidden = demands(plan, _peak, threads)
    held = holding_force(plan.loader, feel[:, 2], plan.release_rad)
    return MotorLimits(
        demand,
        forbidden,
        _unload_s(plan.loader, feel, plan.release_rad),
        plan.settings.rows[:, 1],
        motor.capability.peak_force_n,
        _share(motor, held, np.zeros(len(held))),
    )


def _peak(group: SettingGroup) -> NDArray[np.float64]:
    """Peak demand of each release as a share of the largest current or voltage."""
    motor = Motor(group.plan.loader)
    return np.asarray(np.max([motor.moving_shares(*moment) for moment in motion(group)], axis=(0, 1)))


def _share(motor: Motor, force: NDArray[np.float64], speed: NDArray[np.float64]) -> NDArray[np.float64]:
    share = motor.share(force, speed)
    return np.where(np.isnan(share), 0.0, share)  # NaN: no limit


def _unload_s(loader: Loader, feel: NDArray[np.float64], angle: float) -> NDArray[np.float64]:
    """t_0 of the settings; zero without a current limit."""
    plant, current = ElectricPlant.of(loader), loader["current_loop.current_limit"]
    if not isfinite(current):
        return np.zeros(len(feel))
    held = feel[:, 2] * abs(angle) / plant.lever
    shorter = np.abs(1 - loader["column.inertia"] / feel[:, 0]) * held / plant.stiffness
    return np.asarray(np.sqrt(2 * plant.rotor_mass * shorter / (plant.force_per_ampere * current + held)))
