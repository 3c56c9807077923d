"""The servo and its column over one sample period, with the delay of the command: what sampled laws are designed for.

``x`` states of eq. (17) without the feel · ``e`` command · ``e_h`` command of the sample before · ``T_p`` pilot's torque on the
column · ``T`` period · ``tau`` delay from the sample to its command

    x+   = Phi x + Gamma_0 e_h + Gamma_1 e + Gamma_p T_p
    e_h+ = e

``x`` of an electric drive is position of its end, force on the link, current, and the base: the force stands in the place of the
rotor's velocity, so that each thing that is sampled is a state.

exact for a torque that stays over the period: ``Phi = exp(A T)``, the new command acts over the last ``T - tau``,
``Gamma_1 = Gamma(T - tau)``, and the old one over the first ``tau``, ``Gamma_0 = exp(A (T - tau)) Gamma(tau)``, where
``Gamma(t)`` is the integral of ``exp(A s) B`` from 0 to t.
"""

from dataclasses import dataclass, field
from functools import cached_property
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel._core import GainLaw
from forcefeel.errors import InputError
from forcefeel.linear.models import INPUTS, Linkage, loader_model
from forcefeel.linear.sampled_feel import delayed
from forcefeel.loader.arms import ARMS, Arm
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ELECTRIC
from forcefeel.loader.tolerances import ASSUMED
from forcefeel.units import SECONDS, to_text

PLANT_STATES = (
    "piston_position_m",
    "load_pressure_pa",
    "commanded_flow_m3_per_s",
    "commanded_flow_rate_m3_per_s2",
    "base_position_m",
    "base_velocity_m_per_s",
)
"""The states x, in this order."""


MOST_ARM_GAIN, BEYOND = 4.0, -3
"""Gain of an arm's loop that a design counts at most, and the power by which it counts less beyond: no filter that is tried bears
more, and a feel as light as that is rendered hands off."""


@dataclass(frozen=True)
class Places:
    """Where a plant's states stand.

    Attributes:
        position: Of the drive's end, which is sampled.
        effort: Load pressure, or the force itself: what the load cell shows.
        drive: Flow or current: what the command moves.
        base, base_rate: The column's base.
        count: How many states there are.
    """

    position: int
    effort: int
    drive: int
    base: int
    base_rate: int
    count: int

    @property
    def sampled(self) -> list[int]:
        """F_c, x_p, theta, each one state in its unit."""
        return [self.effort, self.position, self.base]

    @property
    def torque(self) -> int:
        """T_p among ``[x; T_p; d; e_h]``, of which an observer makes an estimate."""
        return self.count

    @property
    def disturbance(self) -> int:
        """d, at the command."""
        return self.count + 1

    @property
    def held(self) -> int:
        """e_h, which is known."""
        return self.count + 2

    @property
    def estimated(self) -> slice:
        """x, T_p, d."""
        return slice(0, self.held)

    @property
    def observed(self) -> int:
        """States of an observer."""
        return self.count + 3

    @property
    def regulated(self) -> list[int]:
        """``[x; e_h]`` in an observer's state."""
        return [*range(self.count), self.held]


_OF_SERVO = Places(position=0, effort=1, drive=2, base=4, base_rate=5, count=6)
"""Of ``PLANT_STATES``."""

_OF_MOTOR = Places(position=0, effort=1, drive=2, base=3, base_rate=4, count=5)


@dataclass(frozen=True, eq=False)
class Scale:
    """Units of the design, from the loader alone, in which its numbers are of the order of one.

    Attributes:
        torque_n_m: Torque of the supply pressure on the column, ``alpha R_b A p_s``.
        time_s: Time in which that torque turns the column from rest by half a radian, ``sqrt(J / T_s)``.
        command_v: Command for the rated current, ``i_r / K_2`` in V; of a motor for the largest one, in A.
        states: SI value of one unit of each of ``PLANT_STATES``: the column at one radian, its rate in radians per unit of
            time, supply pressure, rated flow and its rate at the valve's natural frequency.
        sampled: SI value of one unit of F_c, x_p and theta.
    """

    torque_n_m: float
    time_s: float
    command_v: float
    states: NDArray[np.float64] = field(repr=False)
    sampled: NDArray[np.float64] = field(repr=False)

    @classmethod
    def of(cls, loader: Loader) -> "Scale":
        """The units of a loader."""
        if loader.drive == ELECTRIC:
            return cls._of_motor(loader)
        pressure, base, flow = loader["valve.supply_pressure"], loader["column.base_arm"], loader["valve.rated_flow"]
        piston = loader["linkage.ratio"] * base
        force = loader["actuator.area"] * pressure
        time = float(np.sqrt(loader["column.inertia"] / (piston * force)))
        return cls(
            torque_n_m=piston * force,
            time_s=time,
            command_v=loader["valve.rated_current"] / loader["amplifier.admittance"],
            states=np.array([piston, pressure, flow, flow * loader["valve.natural_frequency"], base, base / time]),
            sampled=np.array([force, piston, 1.0]),
        )

    @classmethod
    def _of_motor(cls, loader: Loader) -> "Scale":
        """The motor's largest current and force in the place of the valve's; at no limit, what the feel asks for at a radian."""
        base, travel = loader["column.base_arm"], loader["transmission.travel"]
        end = loader["linkage.ratio"] * base
        per_ampere = loader["motor.torque_constant"] / travel
        current = loader["current_loop.current_limit"]
        if not np.isfinite(current):
            current = loader["feel.maximum_stiffness"] / (end * per_ampere)
        force = per_ampere * current
        time = float(np.sqrt(loader["column.inertia"] / (end * force)))
        return cls(
            torque_n_m=end * force,
            time_s=time,
            command_v=current,
            states=np.array([end, force, current, base, base / time]),
            sampled=np.array([force, end, 1.0]),
        )


@dataclass(frozen=True, eq=False)
class SampledPlant:
    """The plant over one period, in the units of ``scale``.

    Attributes:
        period_s: T.
        delay_s: tau.
        scale: Its units.
        places: Where its states stand; n of them.
        phi: Phi, (n, n).
        by_held: Gamma_0, (n,).
        by_command: Gamma_1, (n,).
        by_torque: Gamma_p, (n,).
        friction: Dry friction of the column.
        arm_share: Share of a firm arm's mass in the inertia of arm and column, ``m R_p^2 / (J + m R_p^2)``.
    """

    period_s: Annotated[float, SECONDS]
    delay_s: Annotated[float, SECONDS]
    scale: Scale
    places: Places
    phi: NDArray[np.float64] = field(repr=False)
    by_held: NDArray[np.float64] = field(repr=False)
    by_command: NDArray[np.float64] = field(repr=False)
    by_torque: NDArray[np.float64] = field(repr=False)
    friction: "ColumnFriction"
    arm_share: float

    @classmethod
    def of(cls, loader: Loader) -> "SampledPlant":
        """The plant of a loader: its linear model and the column's viscous friction, without limits, lags of sensors or an arm.

        Raises:
            InputError: If the loader has no ``controller.period``, or its delay is longer than that.
        """
        timing = period_and_delay(loader)
        scale = Scale.of(loader)
        a, b = _continuous(loader, scale)
        phi, by_held, by_command = delayed(a, b[:, 1:], *timing)
        _, whole = _core.discretize(a, b, timing[0])
        places = _OF_MOTOR if loader.drive == ELECTRIC else _OF_SERVO
        held = ARMS[Arm.FIRM][0] * loader["column.grip_arm"] ** 2
        return cls(
            *timing,
            scale,
            places,
            phi,
            by_held[:, 0],
            by_command[:, 0],
            whole[:, 0],
            ColumnFriction.of(loader),
            held / (held + loader["column.inertia"]),
        )

    def arm_gain(self, inertia_ratio: float) -> float:
        """``K``, gain of the loop that a firm arm's mass closes over the estimate of its torque.

        By the estimate ``F T_p`` the column moves as ``s^2 theta = [1 + (J / I - 1) F] T_p / J`` where inertia counts, and the arm
        answers ``T_p = -m R_p^2 s^2 theta``, so that ``1 + K F = 0`` with

            K = (J / I - 1) m R_p^2 / (J + m R_p^2)

        A filter that lags by 180 deg where it still has 1 / K of its gain makes the arm swing.
        """
        gain = max(1 / inertia_ratio - 1, 0.0) * self.arm_share
        return gain if gain <= MOST_ARM_GAIN else MOST_ARM_GAIN * (gain / MOST_ARM_GAIN) ** BEYOND

    @property
    def periods_per_time(self) -> float:
        """T in units of time."""
        return self.period_s / self.scale.time_s

    @cached_property
    def transition(self) -> NDArray[np.float64]:
        """Transition matrix of ``[x; e_h]``, (n + 1, n + 1)."""
        n = self.places.count
        matrix = np.zeros((n + 1, n + 1))
        matrix[:n, :n], matrix[:n, n] = self.phi, self.by_held
        return matrix

    @property
    def input(self) -> NDArray[np.float64]:
        """How the command enters ``[x; e_h]``, (n + 1,)."""
        return np.append(self.by_command, 1.0)

    @property
    def by_disturbance(self) -> NDArray[np.float64]:
        """How what is added to the held command enters ``x`` over a period, ``Gamma_0 + Gamma_1``, (n,)."""
        return self.by_held + self.by_command


def period_and_delay(loader: Loader) -> tuple[float, float]:
    """T and tau of a loader's controller.

    Raises:
        InputError: If it has none, or its delay is longer than its period.
    """
    period, delay = loader["controller.period"], loader["controller.delay"]
    if period == 0:
        raise InputError("controller.period: expected a sample period, got none; give one, for example 0.5 ms")
    if delay > period:
        raise InputError(
            f"controller.delay: expected at most the period of {to_text(period * 1e3)} ms, got {to_text(delay * 1e3)} ms; "
            "shorten the delay or lengthen controller.period"
        )
    return period, delay


def drive_lag_s(loader: Loader) -> float:
    """Lag between a command and its effect: valve or current loop, delay and hold."""
    if loader.drive == ELECTRIC:
        drive = 1 / loader["current_loop.bandwidth"]
    else:
        drive = 2 * loader["valve.damping_ratio"] / loader["valve.natural_frequency"]
    return drive + loader["controller.delay"] + loader["controller.period"] / 2


def link_stiffness(loader: Loader) -> float:
    """Stiffness of link and, of a motor, transmission at the column, ``k (alpha R_b)^2`` in N m/rad."""
    softness = 1 / loader["linkage.stiffness"]
    if loader.drive == ELECTRIC:
        softness += 1 / loader["transmission.stiffness"]
    return float((loader["linkage.ratio"] * loader["column.base_arm"]) ** 2 / softness)


def _continuous(loader: Loader, scale: Scale) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """A and B of eq. (17) in units of ``scale``, the feel computer left out; inputs T_p, e."""
    if loader.drive == ELECTRIC:
        a, force, signal = _motor(loader)
    else:
        a, force, signal = _servo(loader)
    a = a * scale.states / scale.states[:, None]
    torque = force / loader["column.grip_arm"] * scale.torque_n_m
    return a, np.column_stack([torque, signal * scale.command_v]) / scale.states[:, None]


_FORCE_OUTPUT = 2
"""F_c among the outputs of ``_core.electric_plant``."""

_Plant = tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]
"""A, and how the pilot's force and the command enter."""


def _motor(loader: Loader) -> _Plant:
    """Of an electric drive, with the force for the rotor's velocity."""
    a, b, c, _ = _core.electric_plant(loader.si_values)
    a[-1, -1] -= _drag(loader)
    to = np.eye(_OF_MOTOR.count)  # from x_m, x_m', i, x_b, x_b'
    to[_OF_MOTOR.effort] = c[_FORCE_OUTPUT]
    return to @ np.linalg.solve(to.T, a.T).T, *(to @ b).T


def _servo(loader: Loader) -> _Plant:
    """Of a hydraulic drive."""
    # Without input the feel computer neither moves nor acts, so leaving its states out is exact.
    model = loader_model(loader, GainLaw.none(loader.si_values), Linkage.COMPLIANT)
    kept = [model.state_labels.index(name) for name in PLANT_STATES]
    force, signal = (model.B[kept, INPUTS.index(name)] for name in INPUTS)
    a = model.A[np.ix_(kept, kept)]
    a[_OF_SERVO.base_rate, _OF_SERVO.base_rate] -= _drag(loader)
    return a, force, signal


def _drag(loader: Loader) -> float:
    """What viscous friction takes of the base's velocity: ``B_c / J``."""
    return loader["column.viscous_friction"] / loader["column.inertia"]


_FRICTION, _BREAKAWAY, _STRIBECK = "column.coulomb_friction", "column.static_friction", "column.stribeck_velocity"


@dataclass(frozen=True)
class ColumnFriction:
    """Dry friction of a column as its file states it.

    Attributes:
        by_direction_n_m: While it moves towards negative and towards positive angles, as torque on it.
        breakaway: Share by which it is larger where the column breaks away.
        stribeck_rad_per_s: Velocity over which it falls from there; zero where it falls with a jump.
        off: Shares by which it may be off, least and most: the file's tolerance, or an assumed one.
    """

    by_direction_n_m: tuple[float, float]
    breakaway: float
    stribeck_rad_per_s: float
    off: tuple[float, float]

    @classmethod
    def of(cls, loader: Loader) -> "ColumnFriction":
        """Of a loader."""
        stated, asymmetry = loader[_FRICTION], loader["column.friction_asymmetry"]
        torque = stated * loader["column.grip_arm"]
        least, most = friction_off(loader)
        return cls(
            by_direction_n_m=(torque * (1 - asymmetry), torque * (1 + asymmetry)),
            breakaway=max(loader[_BREAKAWAY] / stated - 1, 0.0) if stated else 0.0,
            stribeck_rad_per_s=loader[_STRIBECK],
            off=(least / stated, most / stated) if stated else (0.0, 0.0),
        )

    @property
    def mean_n_m(self) -> float:
        """Of both directions."""
        return float(np.mean(self.by_direction_n_m))


def friction_off(loader: Loader) -> tuple[float, float]:
    """By how much the column's dry friction may be off, N at the grip: by its tolerance, or by a share that is assumed."""
    stated = loader[_FRICTION]
    low, high = (
        loader.tolerances[_FRICTION].ends
        if _FRICTION in loader.tolerances
        else (
            (1 - ASSUMED) * stated,
            (1 + ASSUMED) * stated,
        )
    )
    # Bounds that stand by themselves need not hold the value.
    return min(low - stated, 0.0), max(high - stated, 0.0)
