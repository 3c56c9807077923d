"""Results of the sizing of a drive."""

from dataclasses import dataclass, field
from math import isnan, nan
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from forcefeel.loader.loader import Loader
from forcefeel.sizing.demand import Duration
from forcefeel.sizing.motor import MotorCapability, MotorNeeds, MotorRemedy
from forcefeel.sizing.plan import SizingPlan
from forcefeel.sizing.valve import ValveCapability, ValveNeeds, ValveRemedy
from forcefeel.units import FORCE, MASS, PERCENT, SPEED

Needs = MotorNeeds | ValveNeeds
Capability = MotorCapability | ValveCapability
Remedy = MotorRemedy | ValveRemedy


@dataclass(frozen=True, eq=False)
class DemandResult:
    """One demand on the drive, and the share of the limits that it uses.

    Attributes:
        name: Its name.
        duration: Its duration.
        programmed: Whether it comes from the loader's feel.
        force_n, speed_m_per_s: Largest magnitudes at the grip, including the force on the rotor's own mass.
        of_peak: Largest used share of the drive's peak limit; NaN without a limit. For a release it includes the simulated
            relief of the link.
        of_continuous: Used share of the continuous limit; NaN for a movement, and if the limit is unknown.
        needs: Demand on the drive.
        remedy: Remedy; ``None`` if none is required, or if the speed is too low.
        source: Its source.
        verified: Whether it is verified against the source.
        of_motion: Used share of the ideal motion of a release alone; NaN for a held force.
        law: Law of the simulated release; empty for a held force, and if no law fits the loader.
        path_speed_m_per_s, path_force_n: Speed and force over time while the drive pushes; NaN while it brakes.
    """

    name: str
    duration: Duration
    programmed: bool
    force_n: Annotated[float, FORCE]
    speed_m_per_s: Annotated[float, SPEED]
    of_peak: Annotated[float, PERCENT]
    of_continuous: Annotated[float, PERCENT]
    needs: Needs
    remedy: Remedy | None
    source: str
    verified: bool
    path_speed_m_per_s: NDArray[np.float64] = field(repr=False)
    path_force_n: NDArray[np.float64] = field(repr=False)
    of_motion: Annotated[float, PERCENT] = nan
    law: str = ""

    @property
    def available(self) -> bool:
        """Whether the drive can supply it; true if the limit is unknown."""
        share = self.of_continuous if self.duration is Duration.LONG else self.of_peak
        return isnan(share) or share <= 1


@dataclass(frozen=True, eq=False)
class Curve:
    """Force over speed.

    Attributes:
        name: Name of the limit.
        speed_m_per_s, force_n: Speed and force at the grip.
    """

    name: str
    speed_m_per_s: NDArray[np.float64] = field(repr=False)
    force_n: NDArray[np.float64] = field(repr=False)


@dataclass(frozen=True, eq=False)
class Sizing:
    """Demands on a drive and its capability.

    Attributes:
        plan: Inputs of the sizing.
        capability: Capability of the drive at the grip.
        demands: Demands and the used shares of the limits.
        curves: Largest force over speed; empty without a limit.
        missing: Missing rows of the loader file that leave a limit unknown.
        added_mass_kg: Mass of the rotor at the grip, J (F / T)^2; zero for a piston.
        column_mass_kg: Mass of the column at the grip, J / R_p^2.
    """

    plan: SizingPlan
    capability: Capability
    demands: tuple[DemandResult, ...]
    curves: tuple[Curve, ...] = field(repr=False)
    missing: tuple[str, ...]
    added_mass_kg: Annotated[float, MASS]
    column_mass_kg: Annotated[float, MASS]

    @property
    def loader(self) -> Loader:
        """The loader."""
        return self.plan.loader

    @property
    def ok(self) -> bool:
        """Whether the drive is large enough for the programmed feel."""
        return all(demand.available for demand in self.demands if demand.programmed)
