"""How soon a column that is let go falls through a level, whatever the law: before its drive can follow, the link throws it.

``theta``, ``x``, ``y`` angle of the column and, at it, of the link's other end and of the drive behind the oil · ``k``, ``D`` link
· ``c`` oil, eqs. (5), (9) · ``G theta_0`` torque that the link holds · ``J_r`` rotor · ``T_f`` dry friction of the column · ``tau``
delay · ``v``, ``T`` what the drive gives

    J theta'' = -k (theta - x) - D (theta' - x') + T_f
    y' <= v(t - tau),     v = min(v_s, v_i int_0^t |g|) sqrt(1 + p_0 / p_s)        of a valve, g its answer to an impulse, eq. (9)
    J_r x'' <= T - (T + G theta_0) exp(-w_c (t - tau)) + k (theta - x) + D (theta' - x')                              of a motor

What the column does after a motion or force of the drive's end is never negative, so that none takes it less far down than the
largest at every moment: the drive runs after the column with all that it has, from one delay after the release on. ``v_i`` is the
speed by the largest current and ``v_s`` by the spool, both at no load, and ``p_0`` the pressure that holds: the load helps.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.linalg
import scipy.signal
from numpy.typing import NDArray

from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ELECTRIC, OFF
from forcefeel.loader.valve_flow import flow_of_current
from forcefeel.sizing.fastest import Fastest
from forcefeel.sizing.motor import Motor

_MOMENTS = 600
"""Into which a swing of the column on its link is cut."""

_LEAST_DAMPING = 1e-3
"""Of the link, as a share of ``sqrt(k J)``: without any the oil's spring has no state."""


def falls_through_s(
    loader: Loader, angle_rad: float, stiffness: NDArray[np.float64], level: float
) -> NDArray[np.float64]:
    """By when at the latest the column falls through a share of the angle; infinite where its first swing on the link need not.

    Args:
        loader: The loader. Nothing is told of one whose drive has no limit, whose valve follows no orifice, whose motor has
            friction, whose transmission gives way, or whose column is not balanced.
        angle_rad: Where it is let go.
        stiffness: G in N m/rad, one for each time.
        level: The share.
    """
    latest = np.full(len(stiffness), np.inf)
    if not _told(loader):
        return latest
    link = _Link.of(loader)
    after_motion, driven = (_motor if loader.drive == ELECTRIC else _valve)(loader, link)
    friction = max(loader["column.coulomb_friction"], loader["column.static_friction"]) * loader["column.grip_arm"]
    matrix = np.zeros((6, 6))
    matrix[:4, :4] = after_motion
    matrix[1, 4], matrix[3, 5] = friction / link.inertia, 1.0
    step = scipy.linalg.expm(matrix * link.time[1])
    for place, torque in enumerate((stiffness * angle_rad).tolist()):
        end = angle_rad - torque / link.stiffness
        behind = 0.0 if loader.drive == ELECTRIC else end - torque * link.oil
        state, pushes = np.array([angle_rad, 0.0, end, behind, 1.0, 0.0]), driven(torque)
        for now, push in zip(link.time[1:].tolist(), pushes[1:].tolist(), strict=True):
            state[5] = push
            state = step @ state
            if state[0] < level * angle_rad:
                latest[place] = now
                break
    return latest


_UNKNOWN = (
    "motor.coulomb_friction",
    "motor.static_friction",
    "transmission.backlash",
    "transmission.stiffness",
    "linkage.backlash",
    "column.gravity_torque",
)


def _told(loader: Loader) -> bool:
    fastest, electric = Fastest.of(loader), loader.drive == ELECTRIC
    limited = fastest.force_n < np.inf if electric else bool(loader["valve.orifice"]) and fastest.speed_m_per_s < np.inf
    return limited and all(loader[key] in {OFF.get(key), 0.0} for key in _UNKNOWN)


Driven = Callable[[float], NDArray[np.float64]]
"""What drives the last state at each moment, by the torque that was held."""


@dataclass(frozen=True, eq=False)
class _Link:
    """The column on its link: J, k, D and c in units at the column, and the moments of one swing."""

    inertia: float
    stiffness: float
    damping: float
    oil: float
    time: NDArray[np.float64]

    @classmethod
    def of(cls, loader: Loader) -> "_Link":
        lever = (loader["linkage.ratio"] * loader["column.base_arm"]) ** 2
        inertia, k = loader["column.inertia"], loader["linkage.stiffness"] * lever
        oil = 0.0 if loader.drive == ELECTRIC else _oil(loader) / lever
        damping = max(loader["linkage.damping"] * lever, _LEAST_DAMPING * np.sqrt(k * inertia))
        return cls(inertia, k, damping, oil, np.linspace(0.0, 2 * np.pi * np.sqrt(inertia / k), _MOMENTS))

    @property
    def pulled(self) -> NDArray[np.float64]:
        """Torque of the link on the column, on theta, theta', x; x' comes on top, by D."""
        return np.array([-self.stiffness, -self.damping, self.stiffness, 0.0])


def _oil(loader: Loader) -> float:
    """Compliance of the oil at the piston, m/N."""
    return float(loader["actuator.oil_volume"] / (4 * loader["actuator.bulk_modulus"] * loader["actuator.area"] ** 2))


def _valve(loader: Loader, link: _Link) -> tuple[NDArray[np.float64], Driven]:
    """On theta, theta', x, y: the piston has no mass, so that the oil pushes it as the link pulls."""
    moves = (np.array([0.0, 0.0, -1 / link.oil, 1 / link.oil]) - link.pulled) / link.damping
    column = (link.pulled + link.damping * moves) / link.inertia
    fastest = Fastest.of(loader)
    w, zeta = loader["valve.natural_frequency"], loader["valve.damping_ratio"]
    since = np.maximum(link.time - loader["controller.delay"], 0.0)
    _, impulse = scipy.signal.impulse(([w**2], [1.0, 2 * zeta * w, w**2]), T=link.time)
    answered = np.interp(since, link.time, np.cumsum(np.abs(impulse)) * link.time[1])
    to_angle = loader["actuator.area"] * loader["linkage.ratio"] * loader["column.base_arm"]
    by_spool = loader["valve.flow_limit"] / to_angle
    current = loader["amplifier.current_limit"]
    by_current = (
        flow_of_current(loader, current) / to_angle * answered
        if np.isfinite(current)
        else np.where(since > 0, np.inf, 0.0)
    )
    speed = np.minimum(by_spool, by_current)
    torque = fastest.force_n * loader["column.grip_arm"]
    return np.array([[0.0, 1.0, 0.0, 0.0], column, moves, np.zeros(4)]), lambda held: speed * np.sqrt(1 + held / torque)


def _motor(loader: Loader, link: _Link) -> tuple[NDArray[np.float64], Driven]:
    """On theta, theta', x, x'."""
    motor = Motor(loader)
    rotor, most = (
        per_grip * loader["column.grip_arm"] ** power
        for per_grip, power in ((motor.added_mass_kg, 2), (motor.gives.peak_force_n, 1))
    )
    link_torque = link.pulled + np.array([0.0, 0.0, 0.0, link.damping])
    matrix = np.array([[0.0, 1.0, 0.0, 0.0], link_torque / link.inertia, [0.0, 0.0, 0.0, 1.0], -link_torque / rotor])
    since = np.maximum(link.time - loader["controller.delay"], 0.0)
    lag = np.exp(-loader["current_loop.bandwidth"] * since)
    return matrix, lambda held: (most - (most + held) * lag) / rotor
