"""How soon a column that is let go falls through a level, whatever the law: before its drive can follow, the link throws it.

``theta``, ``x``, ``y`` angle of the column and, at it, of the link's other end and of the drive behind the oil · ``k``, ``D`` link
· ``c`` oil, eqs. (5), (9) · ``p`` load pressure, ``T_s`` torque of the supply's · ``J_r`` rotor · ``G theta_0`` torque that the
link holds · ``T_f`` dry friction of the column · ``tau`` from the release to the first command that can know of it · ``v``, ``T``
what the drive gives

    J theta'' = -k (theta - x) - D (theta' - x') + T_f
    y' <= v(t - tau) sqrt(1 - p / p_s),    p / p_s = (y - x) / (c T_s)                                 of a valve, eq. (1)
    v = min(v_s, v_i int_0^t |g|)                                          g its answer to an impulse, eq. (9)
    J_r x'' <= T - (T + G theta_0) exp(-w_c (t - tau)) + k (theta - x) + D (theta' - x')                              of a motor

What the column does after a motion or force of the drive's end is never negative, so that none takes it less far down than the
largest at every moment: the drive runs after the column with all that it has. ``v_i`` is the speed by the largest current and
``v_s`` by the spool, both at no load.

Of a valve the largest motion is the one with equality. Suppose that another has come as far, ``y = y*``, for the first time: up
to there ``y <= y*``, hence ``x <= x*`` as long as what an impulse of ``y`` does to ``x`` and ``theta`` is nowhere negative, hence
``p >= p*``, and it goes on no faster. That holds for about half a swing of the column on link and oil; nothing is told beyond.

The hand lets go as the controller samples. Load cell and encoders see nothing of it then, since what they measure goes on without a
jump, so that ``tau`` is period and delay; with a sensor at the grip, which sees the force jump, the delay alone.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.linalg
import scipy.signal
from numpy.typing import NDArray

from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ELECTRIC, OFF
from forcefeel.loader.sensors import has_grip_sensor
from forcefeel.sizing.fastest import Fastest
from forcefeel.sizing.motor import Motor
from forcefeel.sizing.valve import Valve

_MOMENTS = 2400
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
    drive = (_motor if loader.drive == ELECTRIC else _valve)(loader, link)
    friction = max(loader["column.coulomb_friction"], loader["column.static_friction"]) * loader["column.grip_arm"]
    matrix = np.zeros((6, 6))
    matrix[:4, :4] = drive.after_motion
    matrix[1, 4], matrix[3, 5] = friction / link.inertia, 1.0
    step = scipy.linalg.expm(matrix * link.time[1])
    last = len(link.time) if loader.drive == ELECTRIC else _ordered(step, len(link.time))
    torque = stiffness * angle_rad
    end = angle_rad - torque / link.stiffness
    behind = np.zeros_like(end) if loader.drive == ELECTRIC else end - torque * link.oil
    rest = np.zeros_like(end)
    state = np.array([np.full_like(end, angle_rad), rest, end, behind, np.ones_like(end), rest])
    gives = drive.gives(torque)
    for moment in range(1, last):
        # The load helps less and less as the link lets go: its value at the step's begin is the more generous one.
        state[5] = gives[:, moment] * np.sqrt(np.maximum(1 - drive.load @ state[:4], 0.0))
        state = step @ state
        first = (state[0] < level * angle_rad) & np.isinf(latest)
        latest[first] = link.time[moment]
    return latest


def _ordered(step: NDArray[np.float64], moments: int) -> int:
    """For how many moments theta and x answer to an impulse of y with nothing negative: while their answers to a step rise."""
    answer = np.eye(len(step))[3]
    for moment in range(1, moments):
        before, answer = answer, step @ answer
        if (answer[[0, 2]] < before[[0, 2]] - _ROUNDING).any():
            return moment
    return moments


_ROUNDING = 1e-12
"""Of an answer to a step of one."""

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


@dataclass(frozen=True, eq=False)
class _Drive:
    """The column on its link and what drives it.

    Attributes:
        after_motion: On its four states.
        load: p / p_s of them; none of a motor.
        gives: What drives the last state without a load, by the torques that were held, (torques, moments).
    """

    after_motion: NDArray[np.float64]
    load: NDArray[np.float64]
    gives: Callable[[NDArray[np.float64]], NDArray[np.float64]]


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


def _valve(loader: Loader, link: _Link) -> _Drive:
    """On theta, theta', x, y: the piston has no mass, so that the oil pushes it as the link pulls."""
    moves = (np.array([0.0, 0.0, -1 / link.oil, 1 / link.oil]) - link.pulled) / link.damping
    column = (link.pulled + link.damping * moves) / link.inertia
    fastest = Fastest.of(loader)
    w, zeta = loader["valve.natural_frequency"], loader["valve.damping_ratio"]
    since = np.maximum(link.time - _unseen_s(loader), 0.0)
    _, impulse = scipy.signal.impulse(([w**2], [1.0, 2 * zeta * w, w**2]), T=link.time)
    answered = np.interp(since, link.time, np.cumsum(np.abs(impulse)) * link.time[1])
    to_angle = loader["actuator.area"] * loader["linkage.ratio"] * loader["column.base_arm"]
    by_spool = loader["valve.flow_limit"] / to_angle
    current = loader["amplifier.current_limit"]
    by_current = (
        Valve(loader).flow_by_current_m3_per_s / to_angle * answered
        if np.isfinite(current)
        else np.where(since > 0, np.inf, 0.0)
    )
    speed = np.minimum(by_spool, by_current)
    load = np.array([0.0, 0.0, -1.0, 1.0]) / (link.oil * fastest.force_n * loader["column.grip_arm"])
    return _Drive(
        np.array([[0.0, 1.0, 0.0, 0.0], column, moves, np.zeros(4)]), load, lambda held: np.tile(speed, (len(held), 1))
    )


def _motor(loader: Loader, link: _Link) -> _Drive:
    """On theta, theta', x, x'."""
    motor = Motor(loader)
    rotor, most = (
        per_grip * loader["column.grip_arm"] ** power
        for per_grip, power in ((motor.added_mass_kg, 2), (motor.gives.peak_force_n, 1))
    )
    link_torque = link.pulled + np.array([0.0, 0.0, 0.0, link.damping])
    matrix = np.array([[0.0, 1.0, 0.0, 0.0], link_torque / link.inertia, [0.0, 0.0, 0.0, 1.0], -link_torque / rotor])
    since = np.maximum(link.time - _unseen_s(loader), 0.0)
    lag = np.exp(-loader["current_loop.bandwidth"] * since)
    return _Drive(matrix, np.zeros(4), lambda held: (most - (most + held[:, None]) * lag) / rotor)


def _unseen_s(loader: Loader) -> float:
    """From the release to the first command that can know of it."""
    return loader["controller.delay"] + (0.0 if has_grip_sensor(loader) else loader["controller.period"])
