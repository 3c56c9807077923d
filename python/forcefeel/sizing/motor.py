"""A motor at the grip: what a force at a speed takes of it, what it gives, and how warm it becomes.

The equations are the model's (`crates/model/src/drive/electric/statics.rs`): torque, current and voltage of rotor, transmission and
winding at an even speed and a current that stays, the winding at the temperature around. Cogging is left out.

``T' = A T + b`` winding and housing over the temperature around, at a current that stays
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from math import inf, isfinite, nan
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel.loader.loader import Loader
from forcefeel.units import FORCE, LENGTH, MASS, MOTOR_CURRENT, SECONDS, SPEED, TEMPERATURE, TORQUE, VOLTAGE


@dataclass(frozen=True)
class MotorNeeds:
    """What a force takes of a motor.

    Attributes:
        torque_n_m, current_a, voltage_v: The most at any moment, as magnitudes; current and voltage are the peak of a phase.
        winding_degc: Winding in the end of a force that is held; infinite where it never stops, not a number where it is not known.
        derates_after_s: When the winding, cold at first, is so warm that the current is taken back; infinite where it never is.
    """

    torque_n_m: Annotated[float, TORQUE]
    current_a: Annotated[float, MOTOR_CURRENT]
    voltage_v: Annotated[float, VOLTAGE]
    winding_degc: Annotated[float, TEMPERATURE]
    derates_after_s: Annotated[float, SECONDS]


@dataclass(frozen=True)
class MotorCapability:
    """What a motor gives at the grip.

    Attributes:
        peak_force_n: Standing still, at its largest current; infinite where no limit is given.
        continuous_force_n: So that the winding stays below derating; not a number where its heat is not known.
        fastest_m_per_s: Without a load; infinite where no voltage is given.
        peak_torque_n_m, continuous_torque_n_m, continuous_current_a: At the motor.
        added_mass_kg: The rotor at the grip.
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
    """What would hold a force that the motor does not.

    Attributes:
        torque_n_m: Torque that it takes with this transmission.
        travel_m: Travel per radian with which this motor does; not a number where none does.
        added_mass_kg: The rotor at the grip then.
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
        """The model's."""
        return _core.MotorStatics(self.loader.si_values)

    @property
    def added_mass_kg(self) -> float:
        """The rotor at the grip."""
        return self.statics.added_mass

    def torque(self, force: NDArray[np.float64], speed: NDArray[np.float64]) -> NDArray[np.float64]:
        """Torque in N m that a force at the grip takes, both with their signs."""
        return self.statics.taken(force, speed)[0]

    def voltage(self, current: NDArray[np.float64], speed: NDArray[np.float64]) -> NDArray[np.float64]:
        """Voltage of a phase in V, at a current that stays and a speed of the grip."""
        return self.statics.voltage(current, speed)

    def share(self, force: NDArray[np.float64], speed: NDArray[np.float64]) -> NDArray[np.float64]:
        """Share of the largest current or voltage that a force at a speed takes, whichever is more; not a number without either."""
        _, current, voltage = self.statics.taken(force, speed)
        return self.share_of(current, voltage)

    def share_of(self, current: NDArray[np.float64], voltage: NDArray[np.float64]) -> NDArray[np.float64]:
        """Share of the largest current or voltage, whichever is more; not a number without either."""
        shares = [
            np.abs(taken) / limit
            for taken, limit in (
                (current, self.loader["current_loop.current_limit"]),
                (voltage, self.loader["current_loop.voltage_limit"]),
            )
            if isfinite(limit)
        ]
        return np.max(shares, axis=0) if shares else np.full(np.shape(current), nan)

    def needs(self, force: NDArray[np.float64], speed: NDArray[np.float64], *, held: bool) -> MotorNeeds:
        """The most that forces at speeds take, moment by moment."""
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
        """What it gives at the grip."""
        limits = [self.loader[f"current_loop.{name}_limit"] for name in ("current", "voltage")]
        stalled = min(limits[0], float(self._current(limits[1], np.zeros(1))[0]))
        lasting = min(self.continuous_current_a, stalled) if isfinite(self.continuous_current_a) else nan
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
        """Current that a voltage drives at speeds of the grip; infinite without a limit."""
        return self.statics.current(np.full(len(speed), voltage), speed)

    def curve(self, fastest: float, largest_current: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Speeds up to ``fastest`` and the force in N that the motor gives at each, within a current and the voltage."""
        speed = np.linspace(0.0, min(fastest, self.capability.fastest_m_per_s), POINTS)
        by_voltage = self._current(self.loader["current_loop.voltage_limit"], speed)
        return speed, self.statics.given(np.minimum(largest_current, by_voltage), speed)

    # Heat

    @property
    def heat_rows(self) -> tuple[str, ...]:
        """Rows that the loader file does not give, without which the heat is not known."""
        return tuple(row for row in HEAT if not isfinite(self.loader[row]))

    @property
    def _allowed(self) -> float:
        """Temperature over that around from which on the current is taken back, K."""
        return max(self.loader["thermal.derating_from"] - self.loader["thermal.ambient"], 0.0)

    @property
    def continuous_current_a(self) -> float:
        """Current at which the winding stays where derating begins, A; not a number where its heat is not known.

        ``T' = 0`` of matrices that are straight in the current's square: first the housing's temperature, then that square.
        """
        if self.heat_rows:
            return nan
        (cold, none), (warm, heats) = (self.statics.warming(current) for current in (0.0, 1.0))
        steady = self._allowed * np.array([1.0, -cold[1, 0] / cold[1, 1]])
        per_square = (warm - cold) @ steady + (heats - none)[:, 0]
        return float(np.sqrt(-(cold[0] @ steady) / per_square[0]))

    def winding_degc(self, current: float) -> float:
        """Temperature of the winding in the end."""
        if self.heat_rows:
            return nan
        matrix, heat = self.statics.warming(current)
        # Two rates that pull back have a determinant above zero; below it the resistance grows faster than it cools.
        runs_away = np.linalg.det(matrix) <= 0
        return inf if runs_away else self.loader["thermal.ambient"] - float(np.linalg.solve(matrix, heat)[0, 0])

    def derates_after_s(self, current: float) -> float:
        """How long a winding that is as warm as the air bears a current; not a number where its heat is not known."""
        if self.heat_rows:
            return nan
        if self.winding_degc(current) <= self.loader["thermal.derating_from"]:
            return inf
        rise = self._warming(current)
        return _first_time(rise, self._allowed, guess=1.0)

    def _warming(self, current: float) -> Callable[[float], float]:
        """Rise of the winding over the time, K: two masses, linear, by the eigenvalues of their matrix."""
        matrix, heat = self.statics.warming(current)
        values, vectors = np.linalg.eig(matrix)
        parts = vectors[0] * np.linalg.solve(vectors, heat[:, 0])

        def rise(time: float) -> float:
            exponent = np.minimum(values * time, LARGEST_EXPONENT)
            safe = np.where(exponent == 0, 1.0, exponent)
            return float(np.sum(parts * time * np.where(exponent == 0, 1.0, np.expm1(safe) / safe)))

        return rise

    def remedy(self, force: float, available: float) -> MotorRemedy:
        """What would hold ``force`` where ``available`` is too little, both in N: the travel per radian goes as the force."""
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
"""Rows that the heat follows from; a loader file gives all or none."""

POINTS = 201
"""Of a curve."""

LARGEST_EXPONENT = 500.0
"""Its exponential is still a number: a winding that runs away has long passed every limit there."""


def _first_time(rise: Callable[[float], float], level: float, guess: float) -> float:
    """When a rise first passes a level."""
    from scipy.optimize import brentq  # noqa: PLC0415  a motor that stays cool does not need it

    late = guess
    while rise(late) < level:
        late *= 2
    early = late
    while early > 0 and rise(early) >= level:
        early /= 2
    return float(brentq(lambda time: rise(time) - level, early, late, xtol=late * 1e-9)) if early > 0 else 0.0
