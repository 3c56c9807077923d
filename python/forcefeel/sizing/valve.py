"""A valve and its piston at the grip: what a force at a speed takes of them and what they give.

``F`` force at the grip, ``v`` its speed along the force · ``l = alpha R_b / R_p`` · ``A`` piston area · ``p`` load
pressure · ``q`` flow

    p = F / (l A),   q = A l v              eqs. (5)-(9), the give of oil and link left out
    q = q_0 sqrt(1 - p / p_s)               eq. (1); q_0 - C_p p, eq. (4), where the flow follows the gains
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel.loader.loader import Loader
from forcefeel.loader.valve_flow import no_load_flow, spool_flow
from forcefeel.sizing.motor import POINTS
from forcefeel.units import AREA, FLOW, FORCE, PRESSURE, SPEED


@dataclass(frozen=True)
class ValveNeeds:
    """What a force at a speed takes of a valve.

    Attributes:
        pressure_pa: The largest load pressure, a magnitude.
        flow_m3_per_s: The largest flow at no load that the spool must let through; infinite where the load presses harder than
            the supply.
    """

    pressure_pa: Annotated[float, PRESSURE]
    flow_m3_per_s: Annotated[float, FLOW]


@dataclass(frozen=True)
class ValveGives:
    """What a valve gives at the grip.

    Attributes:
        peak_force_n: Standing still, at the supply's pressure or the relief's; it holds it as long as it likes.
        fastest_m_per_s: Without a load, at the largest current.
        peak_pressure_pa, flow_m3_per_s: Of the valve: standing still, and without a load.
    """

    peak_force_n: Annotated[float, FORCE]
    fastest_m_per_s: Annotated[float, SPEED]
    peak_pressure_pa: Annotated[float, PRESSURE]
    flow_m3_per_s: Annotated[float, FLOW]


@dataclass(frozen=True)
class ValveRemedy:
    """What would hold a force that the valve does not.

    Attributes:
        pressure_pa: Load pressure that it takes with this piston.
        area_m2: Piston with which this pressure does.
    """

    pressure_pa: Annotated[float, PRESSURE]
    area_m2: Annotated[float, AREA]


@dataclass(frozen=True)
class Valve:
    """The valve and piston of a hydraulic loader, seen from the grip."""

    loader: Loader

    @property
    def force_per_pressure(self) -> float:
        """``l A`` in N/Pa, or m^3/m: flow per speed of the grip."""
        loader = self.loader
        lever = loader["linkage.ratio"] * loader["column.base_arm"] / loader["column.grip_arm"]
        return lever * loader["actuator.area"]

    @property
    def added_mass_kg(self) -> float:
        """None: the model's piston has no mass."""
        return 0.0

    def share(self, force: NDArray[np.float64], speed: NDArray[np.float64]) -> NDArray[np.float64]:
        """Share of the largest pressure or flow that a force at a speed takes, whichever is more."""
        pressure, flow = self._taken(force, speed)
        gives = self.gives
        return np.asarray(np.maximum(np.abs(pressure) / gives.peak_pressure_pa, flow / gives.flow_m3_per_s))

    def needs(self, force: NDArray[np.float64], speed: NDArray[np.float64], *, held: bool) -> ValveNeeds:
        """The most that forces at speeds take, moment by moment."""
        pressure, flow = self._taken(force, speed)
        return ValveNeeds(float(np.abs(pressure).max()), float(flow.max()))

    def _taken(
        self, force: NDArray[np.float64], speed: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        pressure = force / self.force_per_pressure
        return pressure, no_load_flow(self.loader, self.force_per_pressure * speed, pressure)

    @cached_property
    def gives(self) -> ValveGives:
        """What it gives at the grip."""
        loader, flow = self.loader, spool_flow(self.loader)
        pressure = min(loader["valve.supply_pressure"], loader["actuator.relief_pressure"])
        if not loader["valve.orifice"]:
            pressure = min(pressure, flow / loader["valve.pressure_gain"])
        return ValveGives(self.force_per_pressure * pressure, flow / self.force_per_pressure, pressure, flow)

    def curve(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Speeds and the force in N that the valve gives at each, at its largest current."""
        loader, gives = self.loader, self.gives
        pressure = np.linspace(gives.peak_pressure_pa, 0.0, POINTS)
        if loader["valve.orifice"]:
            current = gives.flow_m3_per_s * loader["valve.rated_current"] / loader["valve.rated_flow"]
            flow = _core.orifice_flow(loader.values, np.full(POINTS, current), pressure)
        else:
            flow = gives.flow_m3_per_s - loader["valve.pressure_gain"] * pressure
        return flow / self.force_per_pressure, self.force_per_pressure * pressure

    def remedy(self, force: float) -> ValveRemedy:
        """What would hold ``force`` in N."""
        gives = self.gives
        needed = force / self.force_per_pressure
        return ValveRemedy(needed, self.loader["actuator.area"] * needed / gives.peak_pressure_pa)
