"""A motor at the grip: its demand for a force at a speed, its capability, and its temperature.

The equations are the model's (`crates/model/src/drive/electric/statics.rs`): torque, current and voltage of rotor, transmission and
winding at constant speed and current, with the winding at ambient temperature. Cogging is neglected.

``T' = A T + b`` temperature rise of winding and housing above ambient, at constant current
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from math import inf, isfinite, nan
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel.linear.bracketing import root_between
from forcefeel.loader.loader import Loader
from forcefeel.units import FORCE, LENGTH, MASS, MOTOR_CURRENT, SECONDS, SPEED, TEMPERATURE, TORQUE, VOLTAGE


@dataclass(frozen=True)
class MotorNeeds:
    """Demand of a force on a motor.

    Attributes:
        torque_n_m, current_a, voltage_v: Largest magnitudes over time; current and voltage are phase peaks.
        winding_degc: Final winding temperature of a held force; infinite in thermal runaway, NaN if unknown.
        derates_after_s: Time until the current falls: until a cold winding reaches derating or the drive's peak time is over;
            infinite if it does not.
    """

    torque_n_m: Annotated[float, TORQUE]
    current_a: Annotated[float, MOTOR_CURRENT]
    voltage_v: Annotated[float, VOLTAGE]
    winding_degc: Annotated[float, TEMPERATURE]
    derates_after_s: Annotated[float, SECONDS]


@dataclass(frozen=True)
class MotorCapability:
    """Capability of a motor at the grip.

    Attributes:
        peak_force_n: Force at rest at the largest current; infinite without a limit.
        continuous_force_n: Force that keeps the winding below derating and the drive at its continuous current; NaN if neither
            is known.
        fastest_m_per_s: Speed without load; infinite without a voltage limit.
        peak_torque_n_m, continuous_torque_n_m, continuous_current_a: Limits at the motor.
        added_mass_kg: Mass of the rotor at the grip.
    """

    peak_force_n: Annotated[float, FORCE]
    continuous_force_n: Annotated[float, FORCE]
    fastest_m_per_s: Annotated[float, SPEED]
    peak_torque_n_m: Annotated[float, TORQUE]
    continuous_torque_n_m: Annotated[float, TORQUE]
    continuous_current_a: Annotated[float, MOTOR_CURRENT]
    added_mass_kg: Annotated[float, MASS]


@dataclass(frozen=True)
class MotorRemedy:
    """Remedies where the motor cannot hold a force.

    Attributes:
        torque_n_m: Required torque with this transmission.
        travel_m: Required travel per radian with this motor; NaN if no travel is sufficient.
        added_mass_kg: Mass of the rotor at the grip with that travel.
    """

    torque_n_m: Annotated[float, TORQUE]
    travel_m: Annotated[float, LENGTH]
    added_mass_kg: Annotated[float, MASS]


@dataclass(frozen=True)
class Motor:
    """The motor of an electric loader, seen from the grip."""

    loader: Loader

    @cached_property
    def statics(self) -> _core.MotorStatics:
        """Statics of the model."""
        return _core.MotorStatics(self.loader.si_values)

    @property
    def added_mass_kg(self) -> float:
        """Mass of the rotor at the grip."""
        return self.statics.added_mass

    def torque(self, force: NDArray[np.float64], speed: NDArray[np.float64]) -> NDArray[np.float64]:
        """Torque in N m for a force at the grip, both signed."""
        return self.statics.taken(force, speed)[0]

    def voltage(self, current: NDArray[np.float64], speed: NDArray[np.float64]) -> NDArray[np.float64]:
        """Phase voltage in V at constant current and a speed of the grip."""
        return self.statics.voltage(current, speed)

    def share(self, force: NDArray[np.float64], speed: NDArray[np.float64]) -> NDArray[np.float64]:
        """Used share of the current or voltage limit for a force at a speed, the larger one; NaN without limits."""
        _, current, voltage = self.statics.taken(force, speed)
        return self.share_of(current, voltage)

    def share_of(self, current: NDArray[np.float64], voltage: NDArray[np.float64]) -> NDArray[np.float64]:
        """Used share of the current or voltage limit, the larger one; NaN without limits."""
        shares = [
            np.abs(taken) / limit
            for taken, limit in (
                (current, self.loader["current_loop.current_limit"]),
                (voltage, self.loader["current_loop.voltage_limit"]),
            )
            if isfinite(limit)
        ]
        return np.max(shares, axis=0) if shares else np.full(np.shape(current), nan)

    def moving_shares(
        self, velocity: NDArray[np.float64], acceleration: NDArray[np.float64], jerk: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Used shares of the current and of the voltage, (2, ..), in free motion of the column in rad; zero without a limit.

        ``F = (J / R_p + m R_p) theta''``, with the rotor ``m``; the stretch of the link, and so the jerk, is neglected.
        """
        arm = self.loader["column.grip_arm"]
        force = _core.column_grip_force(self.loader.si_values, acceleration) + self.added_mass_kg * arm * acceleration
        _, current, voltage = self.statics.taken(force, arm * velocity)
        limits = (self.loader[f"current_loop.{name}_limit"] for name in ("current", "voltage"))
        return np.array([np.abs(taken) / limit for taken, limit in zip((current, voltage), limits, strict=True)])

    def needs(self, force: NDArray[np.float64], speed: NDArray[np.float64], *, held: bool) -> MotorNeeds:
        """Largest demands of forces at speeds over time."""
        torque, current, volts = self.statics.taken(force, speed)
        standing = float(current[0])
        return MotorNeeds(
            torque_n_m=float(np.abs(torque).max()),
            current_a=float(np.abs(current).max()),
            voltage_v=float(np.abs(volts).max()),
            winding_degc=self.winding_degc(standing) if held else nan,
            derates_after_s=self.derates_after_s(standing) if held else nan,
        )

    @cached_property
    def capability(self) -> MotorCapability:
        """Capability at the grip."""
        limits = [self.loader[f"current_loop.{name}_limit"] for name in ("current", "voltage")]
        stalled = min(limits[0], float(self._current(limits[1], np.zeros(1))[0]))
        lasting = float(np.fmin(self.continuous_current_a, self.loader["current_loop.continuous_current"]))
        lasting = min(lasting, stalled) if isfinite(lasting) else nan
        peak_force, continuous_force = self.statics.given(np.array([stalled, lasting]), np.zeros(2)).tolist()
        return MotorCapability(
            peak_force_n=peak_force,
            continuous_force_n=continuous_force,
            fastest_m_per_s=self.statics.fastest(limits[1]) if isfinite(limits[1]) else inf,
            peak_torque_n_m=self.statics.torque(stalled),
            continuous_torque_n_m=self.statics.torque(lasting),
            continuous_current_a=lasting,
            added_mass_kg=self.added_mass_kg,
        )

    def _current(self, voltage: float, speed: NDArray[np.float64]) -> NDArray[np.float64]:
        """Current at a voltage and speeds of the grip; infinite without a limit."""
        return self.statics.current(np.full(len(speed), voltage), speed)

    def curve(self, fastest: float, largest_current: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Speeds up to ``fastest`` and the motor's largest force in N at each, within limits of current and voltage."""
        speed = np.linspace(0.0, min(fastest, self.capability.fastest_m_per_s), POINTS)
        by_voltage = self._current(self.loader["current_loop.voltage_limit"], speed)
        return speed, self.statics.given(np.minimum(largest_current, by_voltage), speed)

    # Heat

    @property
    def heat_rows(self) -> tuple[str, ...]:
        """Missing rows of the loader file for the thermal model."""
        return tuple(row for row in HEAT if not isfinite(self.loader[row]))

    @property
    def _allowed(self) -> float:
        """Temperature rise above ambient at which derating begins, K."""
        return max(self.loader["thermal.derating_from"] - self.loader["thermal.ambient"], 0.0)

    @property
    def continuous_current_a(self) -> float:
        """Current that holds the winding at the start of derating, A; NaN if its thermal data are unknown.

        ``T' = 0``, with matrices linear in the square of the current: first the housing temperature, then that square.
        """
        if self.heat_rows:
            return nan
        (cold, none), (warm, heats) = (self.statics.warming(current) for current in (0.0, 1.0))
        steady = self._allowed * np.array([1.0, -cold[1, 0] / cold[1, 1]])
        per_square = (warm - cold) @ steady + (heats - none)[:, 0]
        return float(np.sqrt(-(cold[0] @ steady) / per_square[0]))

    def winding_degc(self, current: float) -> float:
        """Final temperature of the winding."""
        if self.heat_rows:
            return nan
        matrix, heat = self.statics.warming(current)
        # A stable system has a positive determinant; otherwise the resistance grows faster than the winding cools.
        runs_away = np.linalg.det(matrix) <= 0
        return inf if runs_away else self.loader["thermal.ambient"] - float(np.linalg.solve(matrix, heat)[0, 0])

    def derates_after_s(self, current: float) -> float:
        """Time until the current falls, s; NaN if the thermal data are unknown and the drive's peak time does not count.

        The first of two: a winding at ambient temperature reaches derating, or the drive's peak time is over.
        """
        if abs(current) > self.loader["current_loop.continuous_current"]:
            return float(np.fmin(self._heated_after_s(current), self.loader["current_loop.peak_time"]))
        return self._heated_after_s(current)

    def _heated_after_s(self, current: float) -> float:
        """Time until a winding at ambient temperature reaches derating, s; NaN if its thermal data are unknown."""
        if self.heat_rows:
            return nan
        if self.winding_degc(current) <= self.loader["thermal.derating_from"]:
            return inf
        rise = self._warming(current)
        return _first_time(rise, self._allowed, guess=1.0)

    def _warming(self, current: float) -> Callable[[float], float]:
        """Temperature rise of the winding over time, K, by the eigenvalues of the two-mass model."""
        matrix, heat = self.statics.warming(current)
        values, vectors = np.linalg.eig(matrix)
        parts = vectors[0] * np.linalg.solve(vectors, heat[:, 0])

        def rise(time: float) -> float:
            exponent = np.minimum(values * time, LARGEST_EXPONENT)
            safe = np.where(exponent == 0, 1.0, exponent)
            return float(np.sum(parts * time * np.where(exponent == 0, 1.0, np.expm1(safe) / safe)))

        return rise

    def remedy(self, force: float, available: float) -> MotorRemedy:
        """Remedies for ``force`` above ``available``, both in N; the travel per radian is proportional to the force."""
        travel = self.loader["transmission.travel"] * available / force
        torque = float(self.torque(np.array([force]), np.zeros(1))[0])
        if not available > 0:
            return MotorRemedy(torque, nan, nan)
        return MotorRemedy(torque, travel, self.added_mass_kg * (force / available) ** 2)


HEAT = (
    "thermal.winding_resistance",
    "thermal.housing_resistance",
    "thermal.winding_capacity",
    "thermal.housing_capacity",
)
"""Rows of the thermal model; a loader file states all or none."""

POINTS = 201
"""Points of a curve."""

LARGEST_EXPONENT = 500.0
"""Largest exponent before overflow; in thermal runaway every limit is exceeded earlier."""


def _first_time(rise: Callable[[float], float], level: float, guess: float) -> float:
    """First time at which a rise exceeds a level."""
    late = guess
    while rise(late) < level:
        late *= 2
    early = late
    while early > 0 and rise(early) >= level:
        early /= 2
    return root_between(lambda time: rise(time) - level, early, late, tolerance=late * 1e-9) if early > 0 else 0.0
