"""What came of sizing a drive, with what made it."""

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
    """One thing that is asked of the drive, and what it takes.

    Attributes:
        name: In words.
        duration: How long.
        programmed: Whether the loader's own feel asks for it.
        force_n, speed_m_per_s: The largest of each at the grip, as magnitudes, with what the rotor's own mass takes.
        of_peak: At the moment that takes most of the drive, share of what the drive gives for a short time; not a
            number where the loader file gives no limit. Of a release also in the engine, which relieves the link.
        of_continuous: Share of what it gives for ever; not a number of a movement, and where that is not known.
        needs: What it takes of the drive.
        remedy: What would give it; ``None`` where the drive does, or where it lacks speed.
        source: Where it comes from.
        verified: Whether a person has held it against that.
        of_motion: Of a release the share that its ideal motion takes by itself; not a number of what is held.
        law: Under which the engine released; empty of what is held, and where there is no law for the loader.
        path_speed_m_per_s, path_force_n: Moment by moment as the drive pushes, not a number where it holds back.
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
        """Whether the drive gives it; also where no limit is known."""
        share = self.of_continuous if self.duration is Duration.LONG else self.of_peak
        return isnan(share) or share <= 1


@dataclass(frozen=True, eq=False)
class Curve:
    """Force over speed.

    Attributes:
        name: Of the drive: for how long.
        speed_m_per_s, force_n: At the grip.
    """

    name: str
    speed_m_per_s: NDArray[np.float64] = field(repr=False)
    force_n: NDArray[np.float64] = field(repr=False)


@dataclass(frozen=True, eq=False)
class Sizing:
    """What is asked of a drive and what it gives.

    Attributes:
        plan: What was asked.
        capability: What the drive gives at the grip.
        demands: What is asked of it, and what that takes.
        curves: Force over speed that it gives; none without a limit.
        missing: Rows that the loader file does not give, and without which something is not known.
        added_mass_kg: The rotor at the grip, J (F / T)^2; none of a piston, which has no mass in the model.
        column_mass_kg: The column at the grip, J / R_p^2.

    Example:
        >>> import forcefeel as ff
        >>> sizing = ff.sizing.size_drive(ff.loader.electric("rudder-pedals"))
        >>> [demand.name for demand in sizing.demands if not demand.programmed]
        ['25.143(d) short term', '25.143(d) long term']
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
    def good(self) -> bool:
        """Whether the drive gives what the programmed feel asks for."""
        return all(demand.available for demand in self.demands if demand.programmed)
