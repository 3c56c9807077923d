"""A valve and its piston at the grip: what a force at a speed takes of them and what they give.

The equations are the model's (`crates/model/src/drive/hydraulic/statics.rs`): eq. (5) at an even speed, eq. (1) or (4). The give of
oil and link is left out.
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
    """What a force at a speed takes of a valve.

    Attributes:
        pressure_pa: The largest load pressure, a magnitude.
        flow_m3_per_s: The largest flow at no load that the spool must let through; infinite where the load presses harder than
            the supply.
    """

    pressure_pa: Annotated[float, PRESSURE]
    flow_m3_per_s: Annotated[float, FLOW]


@dataclass(frozen=True)
class ValveCapability:
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

    @cached_property
    def statics(self) -> _core.ValveStatics:
        """The model's."""
        return _core.ValveStatics(self.loader.si_values)

    @property
    def force_per_pressure(self) -> float:
        """Force at the grip per load pressure, N/Pa, or m^3/m: flow per speed of the grip."""
        return self.statics.force_per_pressure

    @property
    def added_mass_kg(self) -> float:
        """None: the model's piston has no mass."""
        return 0.0

    @property
    def flow_by_current_m3_per_s(self) -> float:
        """Flow at no load of the amplifier's largest current, whatever the spool's stroke; infinite without a limit."""
        return self.statics.no_load_flow(self.loader["amplifier.current_limit"])

    @property
    def flow_m3_per_s(self) -> float:
        """Largest flow at no load: of the largest current, the rated one without a limit, and of the spool's stroke."""
        limit = self.loader["amplifier.current_limit"]
        current = limit if np.isfinite(limit) else self.loader["valve.rated_current"]
        return min(self.loader["valve.flow_limit"], self.statics.no_load_flow(current))

    def share(self, force: NDArray[np.float64], speed: NDArray[np.float64]) -> NDArray[np.float64]:
        """Share of the largest pressure or flow that a force at a speed takes, whichever is more."""
        pressure, flow = self.statics.taken(force, speed)
        return self.share_of(pressure, flow)

    def share_of(self, pressure: NDArray[np.float64], flow: NDArray[np.float64]) -> NDArray[np.float64]:
        """Share of the largest pressure, or of the largest flow at no load, whichever is more."""
        capability = self.capability
        return np.asarray(np.maximum(np.abs(pressure) / capability.peak_pressure_pa, flow / capability.flow_m3_per_s))

    def needs(self, force: NDArray[np.float64], speed: NDArray[np.float64], *, held: bool) -> ValveNeeds:
        """The most that forces at speeds take, moment by moment."""
        pressure, flow = self.statics.taken(force, speed)
        return ValveNeeds(float(np.abs(pressure).max()), float(flow.max()))

    @cached_property
    def capability(self) -> ValveCapability:
        """What it gives at the grip."""
        flow = self.flow_m3_per_s
        limits = [self.loader[key] for key in ("valve.supply_pressure", "actuator.relief_pressure")]
        pressure = min(*limits, self.statics.stall_pressure(flow))
        return ValveCapability(self.force_per_pressure * pressure, flow / self.force_per_pressure, pressure, flow)

    def curve(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Speeds and the force in N that the valve gives at each, at its largest current."""
        capability = self.capability
        pressure = np.linspace(capability.peak_pressure_pa, 0.0, POINTS)
        flow = self.statics.flow(np.full(POINTS, capability.flow_m3_per_s), pressure)
        return flow / self.force_per_pressure, self.force_per_pressure * pressure

    def remedy(self, force: float) -> ValveRemedy:
        """What would hold ``force`` in N."""
        capability = self.capability
        needed = force / self.force_per_pressure
        return ValveRemedy(needed, self.loader["actuator.area"] * needed / capability.peak_pressure_pa)
