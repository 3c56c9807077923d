"""Torque mode: the feel by the motor's current alone, from the motor's own encoder; no force sensor, none at the column.

``theta_m = x / (alpha R_b)`` angle of the motor, at the column · ``M`` torque of the motor, there too, against the hand ·
``J_r = J_m (alpha R_b / r)^2`` rotor and ``J = J_r + J_c`` all that moves, at the column · ``k_l`` link and transmission there ·
``K``, ``D`` coupling · ``delta`` the feel computer's displacement · ``N`` what the feel has beyond I, B, G

The feel computer is tied to the encoder by a spring and a damper, a virtual coupling, and the motor gives the torque of that tie:

    theta = theta_m / (1 - G / k_l)                    the column, by the link's stretch under the feel's own torque
    T     = K (theta - delta) + D (theta' - delta') + G theta           I delta'' + B delta' + G delta + N = T
    M     = T - J' a,    e = -r M / (alpha R_b K_t)

At rest ``M = G theta`` is exact, and N comes within ``N / (K + G)`` of where it should be: dry friction sticks and breakout holds
without chatter, since the computer and not the encoder's difference decides what moves. ``a`` is the acceleration of a second
computer that has I, B, G alone, and the column is felt with ``I + J - J'``. ``J' = J`` takes all that moves off a programmed
inertia that is larger. One that is smaller would need the motor to push along with the acceleration, ``J' = I + s J_r``, ``s`` one
of ``SHARES``; where not even ``J' = min(I, J)`` will do, ``KEPT`` says which shares of it are tried. What is taken is the most
whose exact loop, delay and link included, is stable with ``BEARS`` times the command, at the feel's own spring and where its
breakout, detent or friction is steepest. So the column is felt with ``max(I, J - s J_r)`` at best, whatever is programmed.

``K = w^2 min(I, J_r)`` and ``D = 2 zeta w min(I, J_r)``: ``w`` is ``LAG`` over the time from a motion to the current that answers
it, ``tau + T / 2`` with the lags of current loop, encoder and velocity. The velocity is a fading-memory filter's, ``q`` its memory,
the shortest with which the encoder's noise and steps make no more than ``NOISE`` of the largest current.

J. E. Colgate, M. C. Stanley, J. M. Brown, Issues in the haptic display of tool use, IROS 1995 (virtual coupling) · E. Brookner,
Tracking and Kalman Filtering Made Easy, Wiley 1998, ch. 1 (fading memory, its noise)
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from forcefeel import _core
from forcefeel.errors import InputError
from forcefeel.laws.sampled.neutral import trimmed
from forcefeel.laws.sampled.observer_law import feel_rows
from forcefeel.laws.sampled.plant import Scale, link_stiffness, period_and_delay
from forcefeel.laws.sampled.sampled_law import SampledLaw
from forcefeel.linear.unit_circle import inside_unit_circle
from forcefeel.loader.loader import FEEL_SETTING, Loader, check_electric
from forcefeel.loader.sensors import SENSORS, current_lag_s, sample_variance
from forcefeel.loader.timing import controller_steps
from forcefeel.threads import cores
from forcefeel.units import to_text

TORQUE_MODE = "torque-mode"
"""The name of the method."""

LAG = 0.4
"""Phase in rad that the whole lag takes at ``w``, a third of the phase margin of the damped coupling."""

ZETA = 0.6

SHARES = (0.5, 0.375, 0.25, 0.125)
"""Of the rotor's inertia, that a motor may take off what moves beyond the programmed inertia."""

KEPT = (1.0, 0.75, 0.5, 0.25, 0.0)
"""Of the programmed inertia, or of all that moves where that is less: taken off where no share of the rotor's can be."""

BEARS = 2.0
"""A command that is so many times too strong leaves the loop stable: 6 dB, the usual least."""

NOISE = 0.02
"""Of the largest current, r.m.s.: what the encoder may stir by the damper."""

_ENCODER = SENSORS.index("potentiometer")

_MEMORIES = np.linspace(0.1, 0.95, 18)
"""Of the filter, by which it is looked for."""

_ARM = ("pilot.arm_mass", "pilot.arm_damping", "pilot.arm_stiffness")

_STEP_S = 1e-4
"""Of the loop that the share is tried on."""


@dataclass(frozen=True, eq=False)
class Coupling:
    """What ties the feel computer to the encoder.

    Attributes:
        frequency: w in rad/s.
        memory: q, share of an old sample that a new one leaves.
        rotor, moved: J_r and J in N m s²/rad.
        arm: alpha R_b in m.
        per_torque: Command in A per N m at the column.

    Example:
        >>> from forcefeel.loader.built_in import BUILT_IN
        >>> round(Coupling.of(BUILT_IN["desktop-yoke"]()).moved, 3)
        0.042
    """

    frequency: float
    memory: float
    rotor: float
    moved: float
    arm: float
    per_torque: float

    @classmethod
    def of(cls, loader: Loader) -> "Coupling":
        """That of a loader, by the rules above."""
        arm, travel = loader["linkage.ratio"] * loader["column.base_arm"], loader["transmission.travel"]
        rotor = loader["motor.inertia"] * (arm / travel) ** 2
        moved, per_torque = rotor + loader["column.inertia"], travel / (arm * loader["motor.torque_constant"])
        (period, _), lag = period_and_delay(loader), current_lag_s(loader)
        seen = float(np.sqrt(sample_variance(loader)[_ENCODER])) / arm
        allowed = NOISE * Scale.of(loader).command_v
        for memory in _MEMORIES.tolist():
            # A velocity is known (alpha / beta - 1/2) T late.
            frequency = LAG / (lag + period * ((1 + memory) / (1 - memory) - 0.5))
            stirred = 2 * ZETA * frequency * rotor * seen * _velocity_noise(memory) / period
            if stirred * per_torque <= allowed:
                break
        return cls(frequency, memory, rotor, moved, arm, per_torque)


def design(loader: Loader, feel: ArrayLike) -> SampledLaw:
    """The laws for many settings of one loader.

    Args:
        loader: The loader, with a motor and ``controller.period``; its own feel and arm are not used.
        feel: I, B, G in SI units, a row per setting.

    Raises:
        InputError: If the loader has a valve or no period, a row is bad, or its G is not below that of link and transmission.
    """
    check_electric(loader, TORQUE_MODE, "take another method, such as robust")
    rows, coupling = feel_rows(feel), Coupling.of(loader)
    damping, open_ = np.zeros(len(rows)), np.arange(len(rows))
    for tried in _tried(coupling, rows[:, 0]):
        laws = _laws(loader, coupling, rows[open_], tried[open_])
        bears = _stable(loader, rows[open_], replace(laws, command=BEARS * laws.command))
        damping[open_[bears]] = tried[open_[bears]]
        open_ = open_[~bears]
        if not len(open_):
            break
    return trimmed(_laws(loader, coupling, rows, damping), loader)


def _tried(coupling: Coupling, inertia: NDArray[np.float64]) -> Iterator[NDArray[np.float64]]:
    """What J' may be for each programmed inertia, the most first."""
    for share in SHARES:
        yield np.minimum(coupling.moved, inertia + share * coupling.rotor)
    for share in KEPT:
        yield share * np.minimum(coupling.moved, inertia)


def _weights(memory: float) -> tuple[float, float]:
    """Alpha and beta of the filter."""
    return 1 - memory**2, (1 - memory) ** 2


def _velocity_noise(memory: float) -> float:
    """Of the velocity, in steps of the position's noise per period."""
    alpha, beta = _weights(memory)
    return float(np.sqrt(2 * beta**2 / (alpha * (4 - 2 * alpha - beta))))


def _stable(loader: Loader, feel: NDArray[np.float64], laws: SampledLaw) -> NDArray[np.bool_]:
    """Whether each law's loop is stable, hands off, in the exact loop: with the spring G, and where the feel is steepest."""
    step_s, timing = controller_steps(loader, _STEP_S)
    stable, numbers, steepest = np.ones(len(feel), dtype=bool), laws.rows(), _steepest(loader, feel[:, 0])
    for added in (np.zeros(len(feel)), steepest) if steepest.any() else (steepest,):
        which = np.flatnonzero(stable)
        if len(which):
            there = np.column_stack([feel[:, :2], feel[:, 2] + added, np.zeros((len(feel), len(_ARM)))])
            values = loader.rows((*FEEL_SETTING, *_ARM), there[which])
            states, matrices = _core.sampled_loops(values, step_s, timing, observers=numbers[which], threads=cores())
            stable[which] = inside_unit_circle(matrices[:, :, : len(states)], cores())
    return stable


def _steepest(loader: Loader, inertia: NDArray[np.float64]) -> NDArray[np.float64]:
    """What the loader's own feel adds to G where it is steepest, in N m/rad; where it sticks, as much as the period bears."""
    if loader["feel.coulomb_friction"] or loader["feel.static_friction"]:
        return np.asarray(inertia / (2 * loader["controller.period"]) ** 2)
    ramps = (("breakout", "breakout_travel"), ("detent_force", "detent_travel"), ("hysteresis", "hysteresis_travel"))
    slope = sum(loader[f"feel.{force}"] / loader[f"feel.{travel}"] for force, travel in ramps)
    stops = np.isfinite([loader["feel.soft_stop_low"], loader["feel.soft_stop_high"]]).any()
    stop = loader["feel.soft_stop_stiffness"] if stops else 0.0
    return np.full(len(inertia), max(slope * loader["column.grip_arm"], stop))


def _laws(loader: Loader, coupling: Coupling, feel: NDArray[np.float64], taken_off: NDArray[np.float64]) -> SampledLaw:
    """The laws as data for these J'.

    Their states are angle and velocity of the motor as expected for the sample, then displacement and rate of the second computer.
    """
    period, delay = period_and_delay(loader)
    inertia, damping, stiffness = feel.T[:, :, None]
    tied = np.minimum(inertia, coupling.rotor)
    k, d = coupling.frequency**2 * tied, 2 * ZETA * coupling.frequency * tied
    expected, speed, second, second_rate, _, position, _, delta, rate = np.eye(9)
    alpha, beta = _weights(coupling.memory)
    new = position / coupling.arm - expected
    angle, velocity = expected + alpha * new, speed + beta / period * new
    column = 1 / (1 - stiffness / _link(loader, feel))

    def tie(displacement: NDArray[np.float64], its_rate: NDArray[np.float64]) -> NDArray[np.float64]:
        theta = column * position / coupling.arm
        pull = k * (theta - displacement) + d * (column * velocity - its_rate)
        return np.asarray(pull + stiffness * theta, dtype=np.float64)

    torque, alone = tie(delta, rate), tie(second, second_rate)
    acceleration = (alone - damping * second_rate - stiffness * second) / inertia
    moves = _core.feel_steps(feel, period)
    filtered = np.broadcast_to([angle + period * velocity, velocity], (len(feel), 2, 9))
    states = moves[:, :, :2] @ np.array([second, second_rate]) + moves[:, :, 2:] * alone[:, None]
    after = np.concatenate([filtered, states], axis=1)
    return SampledLaw(
        period_s=period,
        delay_s=delay,
        transition=after[:, :, :4],
        input=np.concatenate([after[:, :, 4:7], np.zeros((len(feel), 4, 1))], axis=2),
        command=-coupling.per_torque * (torque - taken_off[:, None] * acceleration),
        torque=torque,
    )


def _link(loader: Loader, feel: NDArray[np.float64]) -> float:
    """Stiffness of link and transmission at the column in N m/rad.

    Raises:
        InputError: If a programmed one is not below it.
    """
    link = link_stiffness(loader)
    stiffest = int(np.argmax(feel[:, 2]))
    if not feel[stiffest, 2] < link:
        raise InputError(
            f"feel: row {stiffest} programs {to_text(feel[stiffest, 2], 4)} N m/rad, and link and "
            f"transmission have {to_text(link, 4)} N m/rad at the column: by the motor's encoder alone it cannot be made; "
            "stiffen linkage.stiffness or program less"
        )
    return link
