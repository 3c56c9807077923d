"""A motor at the grip: what a force at a speed takes of it, what it gives, and how warm it becomes.

``F`` force at the grip, ``v`` its speed along the force · ``g = alpha R_b / (R_p r)`` radians of the motor per metre
of the grip · ``K_t``, ``K_e = K_t / n``, ``R`` · ``n = 3/2`` for three phases in peak amperes, 1 for a brushed motor · ``eta``,
``eta_b`` efficiencies · ``T_c``, ``B_m`` friction

    T     = K_t i = F / (g eta) + T_c + B_m omega,   omega = g v     the load driven; held up alike, before it moves on
    T     = eta_b F / g - T_c + B_m omega                           F v < 0: the load drives
    u     = R i + K_e omega                                         winding at the temperature around, steady current
    m     = J_m g^2                                                 the rotor at the grip
    T_w   = T_a + R_th P,   P = n R (1 + a (T_w - T_a)) i^2         winding in the end, R_th = R_wh + R_ha

These are the equilibria of the equations in `crates/model/src/drive/electric.rs`; the tests hold them against runs.
Cogging is left out.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from math import inf, isfinite, nan
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

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
class MotorGives:
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

    @property
    def lever(self) -> float:
        """``alpha R_b / R_p``: travel of the drive per travel of the grip."""
        return self.loader["linkage.ratio"] * self.loader["column.base_arm"] / self.loader["column.grip_arm"]

    @property
    def gear(self) -> float:
        """``g`` in rad/m, or 1/m: newtons at the grip per newton metre."""
        return self.lever / self.loader["transmission.travel"]

    @property
    def phases(self) -> float:
        """``n``."""
        return 1.5 if self.loader["motor.three_phase"] else 1.0

    @property
    def added_mass_kg(self) -> float:
        """``J_m g^2``."""
        return self.loader["motor.inertia"] * self.gear**2

    def torque(self, force: NDArray[np.float64], speed: NDArray[np.float64]) -> NDArray[np.float64]:
        """Torque in N m that a force at the grip takes, both with their signs."""
        loader, load = self.loader, force / self.gear
        way = np.where(speed == 0, np.sign(force), np.sign(speed))
        through = np.where(
            load * way >= 0,
            load / loader["transmission.efficiency"],
            load * loader["transmission.backdriving_efficiency"],
        )
        drag = loader["motor.viscous_friction"] * self.gear * speed
        return np.asarray(through + loader["motor.coulomb_friction"] * way + drag)

    def voltage(self, current: NDArray[np.float64], speed: NDArray[np.float64]) -> NDArray[np.float64]:
        """``R i + K_e omega``, V."""
        back_emf = self.loader["motor.torque_constant"] / self.phases * self.gear * speed
        return np.asarray(self.loader["winding.resistance"] * current + back_emf)

    def force(self, current: NDArray[np.float64] | float, speed: NDArray[np.float64] | float) -> NDArray[np.float64]:
        """Force in N that a current drives the grip with at a speed along it; zero where friction takes all."""
        loader = self.loader
        drag = loader["motor.coulomb_friction"] + loader["motor.viscous_friction"] * self.gear * np.asarray(speed)
        torque = loader["motor.torque_constant"] * np.asarray(current) - drag
        return np.asarray(np.maximum(loader["transmission.efficiency"] * torque * self.gear, 0.0))

    def share(self, force: NDArray[np.float64], speed: NDArray[np.float64]) -> NDArray[np.float64]:
        """Share of the largest current or voltage that a force at a speed takes, whichever is more; not a number without either."""
        current = self.torque(force, speed) / self.loader["motor.torque_constant"]
        shares = [
            np.abs(taken) / limit
            for taken, limit in (
                (current, self.loader["current_loop.current_limit"]),
                (self.voltage(current, speed), self.loader["current_loop.voltage_limit"]),
            )
            if isfinite(limit)
        ]
        return np.max(shares, axis=0) if shares else np.full(np.shape(force), nan)

    def needs(self, force: NDArray[np.float64], speed: NDArray[np.float64], *, held: bool) -> MotorNeeds:
        """The most that forces at speeds take, moment by moment."""
        torque = self.torque(force, speed)
        current = torque / self.loader["motor.torque_constant"]
        volts, standing = self.voltage(current, speed), float(current[0])
        return MotorNeeds(
            torque_n_m=float(np.abs(torque).max()),
            current_a=float(np.abs(current).max()),
            voltage_v=float(np.abs(volts).max()),
            winding_degc=self.winding_degc(standing) if held else nan,
            derates_after_s=self.derates_after_s(standing) if held else nan,
        )

    @cached_property
    def gives(self) -> MotorGives:
        """What it gives at the grip."""
        loader = self.loader
        peak, constant = loader["current_loop.current_limit"], loader["motor.torque_constant"]
        volts, resistance = loader["current_loop.voltage_limit"], loader["winding.resistance"]
        stalled = min(peak, volts / resistance)
        lasting = min(self.continuous_current_a, stalled) if isfinite(self.continuous_current_a) else nan
        return MotorGives(
            peak_force_n=float(self.force(stalled, 0.0)),
            continuous_force_n=float(self.force(lasting, 0.0)),
            fastest_m_per_s=self._fastest(),
            peak_torque_n_m=constant * stalled,
            continuous_torque_n_m=constant * lasting,
            continuous_current_a=lasting,
            added_mass_kg=self.added_mass_kg,
        )

    def _fastest(self) -> float:
        """Where voltage and friction leave no force: ``K_t (u - K_e omega) / R = T_c + B_m omega``."""
        loader = self.loader
        constant, resistance = loader["motor.torque_constant"], loader["winding.resistance"]
        volts = loader["current_loop.voltage_limit"]
        if not isfinite(volts):
            return inf
        left = constant * volts / resistance - loader["motor.coulomb_friction"]
        slope = constant**2 / (self.phases * resistance) + loader["motor.viscous_friction"]
        return max(left, 0.0) / slope / self.gear

    def curve(self, fastest: float, largest_current: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Speeds up to ``fastest`` and the force in N that the motor gives at each, within a current and the voltage."""
        loader = self.loader
        speed = np.linspace(0.0, min(fastest, self.gives.fastest_m_per_s), POINTS)
        back_emf = self.voltage(np.zeros(POINTS), speed)
        by_voltage = (loader["current_loop.voltage_limit"] - back_emf) / loader["winding.resistance"]
        return speed, self.force(np.minimum(largest_current, by_voltage), speed)

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
    def _heat_per_square(self) -> float:
        """``n R``."""
        return self.phases * self.loader["winding.resistance"]

    @property
    def continuous_current_a(self) -> float:
        """Current at which the winding stays where derating begins, A; not a number where its heat is not known."""
        if self.heat_rows:
            return nan
        hot = 1 + self.loader["winding.temperature_coefficient"] * self._allowed
        return float(np.sqrt(self._allowed / (self._resistance * self._heat_per_square * hot)))

    @property
    def _resistance(self) -> float:
        return self.loader["thermal.winding_resistance"] + self.loader["thermal.housing_resistance"]

    def winding_degc(self, current: float) -> float:
        """Temperature of the winding in the end."""
        if self.heat_rows:
            return nan
        rise = self._resistance * self._heat_per_square * current**2
        feedback = self.loader["winding.temperature_coefficient"] * rise
        return inf if feedback >= 1 else self.loader["thermal.ambient"] + rise / (1 - feedback)

    def derates_after_s(self, current: float) -> float:
        """How long a winding that is as warm as the air bears a current; not a number where its heat is not known."""
        if self.heat_rows:
            return nan
        if self.winding_degc(current) <= self.loader["thermal.derating_from"]:
            return inf
        guess = self._resistance * (self.loader["thermal.winding_capacity"] + self.loader["thermal.housing_capacity"])
        return _first_time(self._warming(current), self._allowed, guess)

    def _warming(self, current: float) -> Callable[[float], float]:
        """Rise of the winding over the time, K: two masses, linear, by the eigenvalues of their matrix."""
        loader = self.loader
        power = self._heat_per_square * current**2
        inner, outer = (1 / loader[f"thermal.{part}_resistance"] for part in ("winding", "housing"))
        by_winding, by_housing = (1 / loader[f"thermal.{part}_capacity"] for part in ("winding", "housing"))
        grows = loader["winding.temperature_coefficient"] * power
        matrix = np.array(
            [[by_winding * (grows - inner), by_winding * inner], [by_housing * inner, -by_housing * (inner + outer)]]
        )
        values, vectors = np.linalg.eig(matrix)
        parts = vectors[0] * np.linalg.solve(vectors, [by_winding * power, 0.0])

        def rise(time: float) -> float:
            exponent = np.minimum(values * time, LARGEST_EXPONENT)
            safe = np.where(exponent == 0, 1.0, exponent)
            return float(np.sum(parts * time * np.where(exponent == 0, 1.0, np.expm1(safe) / safe)))

        return rise

    def remedy(self, force: float, available: float) -> MotorRemedy:
        """What would hold ``force`` where ``available`` is too little, both in N: the travel per radian goes as the force."""
        travel = self.loader["transmission.travel"] * available / force
        torque = float(self.torque(np.array(force), np.array(0.0)))
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
