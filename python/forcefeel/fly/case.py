"""A loader, an aircraft and a trimmed flight, and the flights that a pilot holds from there."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Annotated, Self

import numpy as np

from forcefeel.fly.aircraft import FRAME_S, Aircraft, silent, with_surface
from forcefeel.fly.control_data import control_data
from forcefeel.fly.pilot import CrossoverPilot
from forcefeel.fly.run import FlightOptions, Flown, Pilot, fly
from forcefeel.fly.trims import force_per_g, held_force, trimmed_force
from forcefeel.laws.law import Law, LawLike
from forcefeel.live.setup import live_law
from forcefeel.loader.axes import FlightAxis, flight_axis, usual_axis
from forcefeel.loader.loader import Loader
from forcefeel.units import AIRSPEED, FORCE, LOAD_FACTOR

_CROSSOVER_RAD_PER_S = 0.5
"""Of load factor: a pilot who is not in a hurry."""
_INTEGRAL_S = 0.3
_HELD_S = 0.75
_TURNED, _ROLLED_S = 0.1, 1.0
_WINDOW = slice(round(0.25 / FRAME_S), round(_HELD_S / FRAME_S))
"""Before the path curves: a pull-up climbs and loses speed."""

Level = Callable[[float], float]


@dataclass(frozen=True)
class HeldFlight:
    """A flight that a pilot holds in the state in which JSBSim trimmed it; means over 0.25 to 0.75 s.

    Attributes:
        speed_m_per_s: Calibrated airspeed.
        load_factor: Load factor.
        force_n: Force of the hand.
        feel_n: Force of the programmed feel at rest in the same states and column positions.
        trimmed_n: Force by JSBSim's trim, for the programmed feel.

    Example:
        >>> case = ff.fly.FlightCase(ff.digital_elevator(), "c172p", 51.4, 900.0, "robust")
        >>> held = case.held(case.at(load_factor=1.4), alone=True)
        >>> round(held.force_n), round(held.trimmed_n)
        (-14, -14)
    """

    speed_m_per_s: Annotated[float, AIRSPEED]
    load_factor: Annotated[float, LOAD_FACTOR]
    force_n: Annotated[float, FORCE]
    feel_n: Annotated[float, FORCE]
    trimmed_n: Annotated[float, FORCE]


@dataclass(frozen=True, eq=False)
class FlightCase:
    """A loader, an aircraft and a trimmed flight.

    Attributes:
        loader: The loader.
        aircraft: Name of the aircraft, or the path of its data.
        speed_m_per_s: Calibrated airspeed.
        altitude_m: Altitude.
        law: The law.
        axis: The control that the loader is: ``pitch``, ``roll`` or ``yaw``.

    Example:
        >>> case = ff.fly.FlightCase(ff.digital_elevator(), "c172p", 51.4, 900.0, "robust")
        >>> round(case.force_per_g_n)
        -35
    """

    loader: Loader
    aircraft: str
    speed_m_per_s: float
    altitude_m: float
    law: LawLike = None
    axis: FlightAxis = "pitch"

    @classmethod
    def of(
        cls,
        loader: Loader,
        aircraft: str,
        speed_m_per_s: float | None = None,
        altitude_m: float | None = None,
        law: LawLike = None,
        axis: FlightAxis | None = None,
    ) -> Self:
        """A case with the speed and altitude of the aircraft's data and the axis of a built-in loader, unless given.

        Raises:
            InputError: If the aircraft is unknown, or its file is bad.
        """
        axis = axis or flight_axis(usual_axis(loader.name))
        data = control_data(aircraft, axis)
        speed = data.speed_m_per_s if speed_m_per_s is None else speed_m_per_s
        return cls(loader, aircraft, speed, data.altitude_m if altitude_m is None else altitude_m, law, axis)

    @cached_property
    def trim(self) -> Aircraft:
        """The trimmed flight, which is not flown on."""
        return self.at()

    @cached_property
    def feel(self) -> Loader:
        """The loader with the aircraft's surface and feel."""
        return with_surface(self.loader, self.trim)

    @cached_property
    def designed(self) -> Law:
        """The law, designed for the aircraft's feel: one for another feel gives less load factor."""
        return live_law(self.law, self.feel)

    @cached_property
    def without(self) -> tuple[str, ...]:
        """Of flaps, gear and speed brake those that JSBSim's aircraft does not move."""
        return tuple(name for name, moves in self.at().moved_by_levers().items() if not moves)

    @cached_property
    def force_per_g_n(self) -> float:
        """Force per load factor in pull-ups that JSBSim trims, N."""
        return force_per_g(self.loader, self.aircraft, self.speed_m_per_s, self.altitude_m)

    def trimmed_force_n(self, speed_m_per_s: float) -> float:
        """Force that holds another speed which JSBSim trims, N."""
        return trimmed_force(self.feel, self.trim, self.at(speed_m_per_s))

    @cached_property
    def force_per_roll_rate_n(self) -> float:
        """Force of the programmed feel per roll rate, N s/rad, a second after the wheel was turned by a tenth of its travel."""
        aircraft = self.at()
        angle = _TURNED * aircraft.travel_rad
        with silent():
            for _ in range(round(_ROLLED_S / FRAME_S)):
                aircraft.fly(aircraft.trimmed + aircraft.per_angle * angle)
        state = aircraft.state()
        return held_force(self.feel, state, angle) / state["roll_rate"]

    def at(self, speed_m_per_s: float | None = None, load_factor: float = 1.0, **more: float) -> Aircraft:
        """The aircraft in a flight that JSBSim trims, at the case's speed unless another is given; more as in ``Aircraft``."""
        speed = self.speed_m_per_s if speed_m_per_s is None else speed_m_per_s
        return Aircraft(self.aircraft, speed, self.altitude_m, load_factor, axis=self.axis, **more)

    def load_factor_pilot(self, target: Level, begins_n: float = 0.0) -> CrossoverPilot:
        """A pilot who holds a load factor over time, and knows the force at the start and that per load factor."""
        still, known = target(0.0), self.force_per_g_n
        return CrossoverPilot(
            lambda time, seen: target(time) - seen["load_factor"],
            _CROSSOVER_RAD_PER_S * known * _INTEGRAL_S,
            0.0,
            _INTEGRAL_S,
            lambda time: begins_n + known * (target(time) - still),
        )

    def flown(self, pilot: Pilot, duration_s: float, options: FlightOptions, begins: Aircraft | None = None) -> Flown:
        """A flight from a trimmed state, the case's unless another is given, with the case's law and tab."""
        options = replace(options, law=self.designed, trim=self.trim)
        return fly(self.loader, begins or self.at(), pilot, options, duration_s=duration_s)

    def feel_n(self, flown: Flown, window: slice) -> float:
        """Mean force of the programmed feel at rest in the states and column positions of a flight, over frames."""
        rows, angles = [row[window] for row in flown.states.values()], flown.angle_rad[window].tolist()
        states = [dict(zip(flown.states, values, strict=True)) for values in zip(*rows, strict=True)]
        return float(np.mean([held_force(self.feel, state, a) for state, a in zip(states, angles, strict=True)]))

    def held(self, begins: Aircraft, *, alone: bool = False) -> HeldFlight:
        """A pilot holds the load factor of a flight that JSBSim trimmed."""
        force, load_factor = trimmed_force(self.feel, self.trim, begins), begins.state()["load_factor"]
        pilot = self.load_factor_pilot(lambda _: load_factor, force)
        flown = self.flown(pilot, _HELD_S, FlightOptions(alone=alone), begins)
        mean = {name: float(np.mean(row[_WINDOW])) for name, row in flown.states.items()}
        return HeldFlight(
            mean["calibrated_airspeed"],
            mean["load_factor"],
            float(flown.force_n[_WINDOW].mean()),
            self.feel_n(flown, _WINDOW),
            force,
        )
