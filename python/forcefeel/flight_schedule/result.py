"""What the check of a flight schedule found."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from forcefeel.envelope.cases import Case
from forcefeel.envelope.deviations import Deviation
from forcefeel.flight_schedule.poles import Poles
from forcefeel.flight_schedule.releases import PASSES, ReleaseTest
from forcefeel.flight_schedule.schedule import FlightSchedule
from forcefeel.flight_schedule.transitions import Transitions
from forcefeel.loops.margins import LoopMargins
from forcefeel.units import RATIO


class Part(StrEnum):
    """Where loops were checked."""

    KNOTS = "at the knots"
    BETWEEN = "between the knots"
    CHANGES = "during changes"


@dataclass(frozen=True)
class PartFound:
    """What one part came to.

    Attributes:
        part: Which.
        loops: Loops that were checked: places times cases.
        unstable: How many of them are not stable.
        place: Where the loop is nearest to its edge, in words: see ``Poles.critical``.
        case: In which case.
        critical: The magnitude of the pole there.
        largest: The largest magnitude of any pole.
    """

    part: Part
    loops: int
    unstable: int
    place: str
    case: str
    critical: Annotated[float, RATIO]
    largest: Annotated[float, RATIO]


@dataclass(frozen=True)
class CheckedMargins:
    """Margins on the nominal plant at one place.

    Attributes:
        place: Where, in words.
        margins: What the loop bears there.
    """

    place: str
    margins: LoopMargins


@dataclass(frozen=True)
class CheckedRelease:
    """The release test at a knot or in the middle between knots, nominal plant, hands off.

    Attributes:
        place: Where, in words.
        knot: Whether it is a knot.
        outcome: ``passes``, or the figure that fails first.
        designed: The outcome of a law that is designed for the place itself; the same at a knot.
    """

    place: str
    knot: bool
    outcome: str
    designed: str

    @property
    def passes(self) -> bool:
        """Whether it passes."""
        return self.outcome == PASSES

    @property
    def lost(self) -> bool:
        """Whether a knot here would make it pass."""
        return not self.passes and self.designed == PASSES


@dataclass(frozen=True, eq=False)
class ScheduleCheck:
    """A checked schedule.

    Attributes:
        schedule: The schedule.
        refine: Into how many parts the way between two knots was cut.
        deviations: How far each parameter of the plant may be off, and who says so.
        cases: The nominal machine, each parameter off its value, each arm.
        where: Places of the refined grid, (places, axes); the last axis runs fastest.
        knot: Which of them are knots.
        poles: Poles there, (cases, places).
        transitions: Changes between knots.
        during: Poles held at each share of each change, (cases, changes times shares).
        parts: What came of knots, of what is between them, and of the changes.
        remedy_helps: Where a loop between knots is unstable, whether the law designed for the worst place is stable there in
            its case; ``None`` where none is.
        margins: Margins at corners, in the middle, and at the worst place of the nominal plant.
        test: The release test.
        releases: Its outcome at the knots and in the middle between them.

    Example:
        >>> import forcefeel as ff
        >>> pressure = ff.flight_schedule.ScheduleAxis("pressure", "lb/ft^2", (50, 100))
        >>> feel = ff.flight_schedule.second_order_feel([500.0, 1000.0], [1.0, 1.5], 0.6)
        >>> schedule = ff.flight_schedule.design_schedule(ff.digital_elevator(), [pressure], feel)
        >>> ff.flight_schedule.check_schedule(schedule, refine=2, changes={}, arms=()).refine
        2
    """

    schedule: FlightSchedule
    refine: int
    deviations: Mapping[str, Deviation]
    cases: tuple[Case, ...]
    where: NDArray[np.float64] = field(repr=False)
    knot: NDArray[np.bool_] = field(repr=False)
    poles: Poles = field(repr=False)
    transitions: Transitions = field(repr=False)
    during: Poles = field(repr=False)
    parts: tuple[PartFound, ...]
    remedy_helps: bool | None
    margins: tuple[CheckedMargins, ...]
    test: ReleaseTest = field(repr=False)
    releases: tuple[CheckedRelease, ...]

    @property
    def stable(self) -> bool:
        """Whether every loop that was checked is stable."""
        return not any(part.unstable for part in self.parts)

    @property
    def worst(self) -> PartFound:
        """The part with the loop that is nearest to its edge, or farthest beyond it."""
        return max(self.parts, key=lambda part: part.critical)

    @property
    def dense(self) -> bool:
        """Whether no place between knots loses the release test that a law of its own would pass."""
        return not any(release.lost for release in self.releases)

    def part(self, which: Part) -> PartFound:
        """What one part came to."""
        return next(part for part in self.parts if part.part is which)
