"""Result of the check of a flight schedule."""

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
    """Part of a schedule in which loops were checked."""

    KNOTS = "at the knots"
    BETWEEN = "between the knots"
    CHANGES = "during changes"


@dataclass(frozen=True)
class PartResult:
    """Result for one part.

    Attributes:
        part: The part.
        loops: Number of checked loops: points times cases.
        unstable: Number of unstable loops.
        place: Point of the loop closest to instability, as text: see ``Poles.critical``.
        case: Case of this loop.
        critical: Magnitude of its critical pole.
        largest: Largest magnitude of all poles.
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
    """Margins on the nominal plant at one point.

    Attributes:
        place: The point as text.
        margins: Margins of the loop.
    """

    place: str
    margins: LoopMargins


@dataclass(frozen=True)
class CheckedRelease:
    """Release test at a knot or in the middle between knots, nominal plant, hands off.

    Attributes:
        place: The point as text.
        knot: Whether it is a knot.
        outcome: ``passes`` or the first failing figure.
        designed: Outcome of a law designed for this point; the same at a knot.
    """

    place: str
    knot: bool
    outcome: str
    designed: str

    @property
    def passes(self) -> bool:
        """Whether the release passes."""
        return self.outcome == PASSES

    @property
    def lost(self) -> bool:
        """Whether a knot at this point would make the release pass."""
        return not self.passes and self.designed == PASSES


@dataclass(frozen=True, eq=False)
class ScheduleCheck:
    """A checked schedule.

    Attributes:
        schedule: The schedule. refine: Number of intervals between two knots. deviations: Deviation of each plant parameter, with
        its source. cases: The nominal machine, each deviation, each arm. where: Points of the refined grid, (points, axes); the
        last axis runs fastest. knot: Which points are knots. poles: Poles at the points, (cases, points). transitions: Changes
        between knots. during: Poles at each fixed share of each change, (cases, changes times shares). parts: Results at the knots,
        between them and during changes. remedy_helps: Whether a law designed for the worst point is stable there in the worst case;
        ``None`` if all loops are stable. margins: Margins at the corners, in the middle, and at the worst point of the nominal
        plant. test: The release test. releases: Outcomes at the knots and in the middle between them.
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
    parts: tuple[PartResult, ...]
    remedy_helps: bool | None
    margins: tuple[CheckedMargins, ...]
    test: ReleaseTest = field(repr=False)
    releases: tuple[CheckedRelease, ...]

    @property
    def stable(self) -> bool:
        """Whether all checked loops are stable."""
        return not any(part.unstable for part in self.parts)

    @property
    def worst(self) -> PartResult:
        """The part with the least stable loop."""
        return max(self.parts, key=lambda part: part.critical)

    @property
    def dense(self) -> bool:
        """Whether no point between knots fails a release test that a law designed for it passes."""
        return not any(release.lost for release in self.releases)

    def part(self, which: Part) -> PartResult:
        """Result for one part."""
        return next(part for part in self.parts if part.part is which)
