"""A valve and its piston at the grip: their demand for a force at a speed, and their capability.

The equations are the model's (`crates/model/src/drive/hydraulic/statics.rs`): eq. (5) at constant speed, eq. (1) or (4).
Compliance of oil and link is neglected.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel.loader.loader import Loader
from forcefeel.sizing.motor import POINTS
from forcefeel.units import AREA, FLOW, FORCE, PRESSURE, SPEED


@dataclass(frozen=True)
class ValveNeeds:
    """Demand of a force at a speed on a valve.

    Attributes:
        pressure_pa: The largest load pressure, a magnitude.
        flow_m3_per_s: The largest required no-load flow of the spool; infinite if the load pressure exceeds the supply
            pressure.
    """

    pressure_pa: Annotated[float, PRESSURE]
    flow_m3_per_s: Annotated[float, FLOW]


@dataclass(frozen=True)
class ValveCapability:
    """Capability of a valve at the grip.

    Attributes:
        peak_force_n: Force at rest, at the pressure of supply or relief, against the seals; also the continuous force.
        fastest_m_per_s: Speed without load, at the largest current.
        peak_pressure_pa, flow_m3_per_s: Pressure at rest and flow without load.
    """

    peak_force_n: Annotated[float, FORCE]
    fastest_m_per_s: Annotated[float, SPEED]
    peak_pressure_pa: Annotated[float, PRESSURE]
    flow_m3_per_s: Annotated[float, FLOW]


@dataclass(frozen=True)
class ValveRemedy:
    """Remedies where the valve cannot hold a force.

    Attributes:
        pressure_pa: Required load pressure with this piston.
        area_m2: Required piston area at this pressure.
    """

    pressure_pa: Annotated[float, PRESSURE]
    area_m2: Annotated[float, AREA]


@dataclass(frozen=True)
class Valve:
    """The valve and piston of a hydraulic loader, seen from the grip."""

    loader: Loader

    @cached_property
    def statics(self) -> _core.ValveStatics:
        """Statics of the model."""
        return _core.ValveStatics(self.loader.si_values)

    @property
    def force_per_pressure(self) -> float:
        """Force at the grip per load pressure, N/Pa; also flow per speed of the grip, m^3/m."""
        return self.statics.force_per_pressure

    @property
    def added_mass_kg(self) -> float:
        """Zero: the model's piston has no mass."""
        return 0.0

    @property
    def flow_by_current_m3_per_s(self) -> float:
        """No-load flow at the amplifier's largest current, without the stroke limit; infinite without a current limit."""
        return self.statics.no_load_flow(self.loader["amplifier.current_limit"])

    @property
    def flow_m3_per_s(self) -> float:
        """Largest no-load flow: at the largest current, or the rated one without a limit, and at the spool's stroke."""
        limit = self.loader["amplifier.current_limit"]
        current = limit if np.isfinite(limit) else self.loader["valve.rated_current"]
        return min(self.loader["valve.flow_limit"], self.statics.no_load_flow(current))

    def share(self, force: NDArray[np.float64], speed: NDArray[np.float64]) -> NDArray[np.float64]:
        """Used share of the pressure or flow limit for a force at a speed, the larger one."""
        pressure, flow = self.statics.taken(force, speed)
        return self.share_of(pressure, flow)

    def share_of(self, pressure: NDArray[np.float64], flow: NDArray[np.float64]) -> NDArray[np.float64]:
        """Used share of the pressure limit or of the no-load flow limit, the larger one."""
        capability = self.capability
        return np.asarray(np.maximum(np.abs(pressure) / capability.peak_pressure_pa, flow / capability.flow_m3_per_s))

    def moving_shares(
        self, velocity: NDArray[np.float64], acceleration: NDArray[np.float64], jerk: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Used shares of the pressure and of the no-load flow, (2, ..), in free motion of the column in rad; zero without a limit.

        The flow also stretches the link and compresses the oil, eqs. (5), (9). A load pressure above the supply's requires infinite
        flow.
        """
        pressure, pressure_rate = (
            _core.column_grip_force(self.loader.si_values, term) / self.force_per_pressure
            for term in (acceleration, jerk)
        )
        speed = self.loader["column.grip_arm"] * velocity
        flow = self.force_per_pressure * speed + self.statics.oil_compliance * pressure_rate
        limits = [self.loader[key] for key in ("valve.supply_pressure", "actuator.relief_pressure")]
        of_pressure = np.abs(pressure) / min(limits) if self.loader["valve.orifice"] else np.zeros(pressure.shape)
        return np.array([of_pressure, self.statics.needed(flow, pressure) / self.flow_m3_per_s])

    def needs(self, force: NDArray[np.float64], speed: NDArray[np.float64], *, held: bool) -> ValveNeeds:
        """Largest demands of forces at speeds over time."""
        pressure, flow = self.statics.taken(force, speed)
        return ValveNeeds(float(np.abs(pressure).max()), float(flow.max()))

    @cached_property
    def capability(self) -> ValveCapability:
        """Capability at the grip."""
        flow = self.flow_m3_per_s
        limits = [self.loader[key] for key in ("valve.supply_pressure", "actuator.relief_pressure")]
        pressure = min(*limits, self.statics.stall_pressure(flow))
        force = self.force_per_pressure * max(pressure - self._seals_pa, 0.0)
        return ValveCapability(force, flow / self.force_per_pressure, pressure, flow)

    @cached_property
    def _seals_pa(self) -> float:
        """Pressure that the seals take of a moving piston."""
        return float(self.statics.taken(np.zeros(1), np.ones(1))[0][0])

    def curve(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Speeds and the valve's force in N at each, at its largest current."""
        capability = self.capability
        pressure = np.linspace(capability.peak_pressure_pa, 0.0, POINTS)
        flow = self.statics.flow(np.full(POINTS, capability.flow_m3_per_s), pressure)
        return flow / self.force_per_pressure, self.force_per_pressure * np.maximum(pressure - self._seals_pa, 0.0)

    def remedy(self, force: float) -> ValveRemedy:
        """Remedies for ``force`` in N."""
        capability = self.capability
        needed = force / self.force_per_pressure + self._seals_pa
        return ValveRemedy(needed, self.loader["actuator.area"] * needed / capability.peak_pressure_pa)
