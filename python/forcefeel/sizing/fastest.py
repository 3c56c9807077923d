"""The fastest fall of a column that is let go, whatever the law: the drive gives all that it has from that moment on.

``theta_0`` angle of the release · ``v`` largest speed of the drive, in rad/s of the column · ``w`` frequency of the column on its
link, with the oil beside it · ``s`` angle by which the held link is stretched · ``a`` largest acceleration

    gone(t)  = v t - (v / w) sin(w t) + s [1 - cos(w t)]      the drive's end at its largest speed, the column on the link
    gone(t) <= a t^2 / 2,   a = F R_p / J                     the largest force; of a motor on its rotor too
    s        = G theta_0 c,   w = 1 / sqrt(c J)
    c        = (A^2 / k + V_E / (4 beta)) / (alpha R_b A)^2   of a valve, eqs. (5), (9)
    c        = 1 / (k (alpha R_b)^2)                          of a motor

What the column does after a motion of the drive's end, ``1 - cos(w t)``, is never negative, so that no other motion of it takes the
column further; but for one that first pushes it out. Lags, delay, friction and the link's damper are left out: nothing real is
faster. A limit that the loader file does not give is none.
"""

from dataclasses import dataclass
from enum import StrEnum
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from forcefeel.linear.electric import ElectricPlant
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ELECTRIC
from forcefeel.sizing.demand import column_mass_kg
from forcefeel.sizing.motor import Motor
from forcefeel.sizing.valve import Valve
from forcefeel.units import FORCE, MASS, SPEED

_MOMENTS = 2048
"""Into which a fall is cut."""


class Limit(StrEnum):
    """What of a drive keeps a fall slow."""

    FLOW = "the valve's flow"
    CURRENT = "the amplifier's current"
    PRESSURE = "the supply's pressure"
    TORQUE = "the motor's torque"
    VOLTAGE = "the motor's voltage"


@dataclass(frozen=True)
class Fastest:
    """What a drive gives a column that falls, at the grip.

    Attributes:
        force_n, speed_m_per_s: The largest standing still, and without a load; infinite without a limit.
        of_force, of_speed: What sets each.
        mass_kg: What the force moves.
        compliance_rad_per_n_m: c.
        loader: Whose it is.
    """

    force_n: Annotated[float, FORCE]
    speed_m_per_s: Annotated[float, SPEED]
    of_force: Limit
    of_speed: Limit
    mass_kg: Annotated[float, MASS]
    compliance_rad_per_n_m: float
    loader: Loader

    @classmethod
    def of(cls, loader: Loader) -> "Fastest":
        """That of a loader."""
        return _of_motor(loader) if loader.drive == ELECTRIC else _of_valve(loader)

    def fall_s(
        self, angle_rad: float, stiffness: NDArray[np.float64], high: float, low: float
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Least time from ``high`` to ``low``, shares of the release's angle, for each stiffness: by the speed and by the force."""
        by_force = self._by_force(angle_rad, high, low)
        return self._by_speed(angle_rad, stiffness, high, low), np.full(len(stiffness), by_force)

    def _by_speed(self, angle: float, stiffness: NDArray[np.float64], high: float, low: float) -> NDArray[np.float64]:
        speed = self.speed_m_per_s / self.loader["column.grip_arm"]
        if not 0 < speed < np.inf:
            return np.full(len(stiffness), np.inf if speed == 0 else 0.0)
        w = 1 / np.sqrt(self.compliance_rad_per_n_m * self.loader["column.inertia"])
        stretch = stiffness * angle * self.compliance_rad_per_n_m
        # The column lags the drive's end by less than a turn of its swing.
        time = np.linspace(0.0, angle / speed + 2 * np.pi / w, _MOMENTS)
        gone = speed * time - speed / w * np.sin(w * time) + stretch[:, None] * (1 - np.cos(w * time))
        furthest = np.maximum.accumulate(gone, axis=1)
        when = [np.array([np.interp((1 - at) * angle, angles, time) for angles in furthest]) for at in (high, low)]
        return np.asarray(when[1] - when[0])

    def _by_force(self, angle: float, high: float, low: float) -> float:
        if not self.force_n > 0:
            return np.inf
        distance = angle * self.loader["column.grip_arm"]
        return float(np.sqrt(2 * self.mass_kg * distance / self.force_n) * (np.sqrt(1 - low) - np.sqrt(1 - high)))


def _of_valve(loader: Loader) -> Fastest:
    valve = Valve(loader)
    by_current, by_spool = valve.flow_by_current_m3_per_s, loader["valve.flow_limit"]
    flow = min(by_current, by_spool)
    of_speed = Limit.CURRENT if by_current < by_spool else Limit.FLOW
    pressure, of_force = valve.statics.stall_pressure(flow), of_speed
    if loader["valve.orifice"]:
        pressure, of_force = min(pressure, loader["actuator.relief_pressure"]), Limit.PRESSURE
    lever = valve.force_per_pressure
    compliance = valve.statics.oil_compliance / (lever * loader["column.grip_arm"]) ** 2
    return Fastest(lever * pressure, flow / lever, of_force, of_speed, column_mass_kg(loader), compliance, loader)


def _of_motor(loader: Loader) -> Fastest:
    motor, plant = Motor(loader), ElectricPlant.of(loader)
    by_current = loader["current_loop.current_limit"] * loader["winding.resistance"]
    of_force = Limit.TORQUE if by_current <= loader["current_loop.voltage_limit"] else Limit.VOLTAGE
    compliance = 1 / (plant.stiffness * plant.lever**2)
    mass, capability = column_mass_kg(loader) + motor.added_mass_kg, motor.capability
    return Fastest(
        capability.peak_force_n, capability.fastest_m_per_s, of_force, Limit.VOLTAGE, mass, compliance, loader
    )
