"""What is asked of a commissioning."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType

from forcefeel.choice.score import COARSE
from forcefeel.envelope.draws import MOST_DRAWS
from forcefeel.errors import InputError, expect_number
from forcefeel.qualification import DEFAULT_EDITION
from forcefeel.units import UnitSystem, show

SHARE = 0.95
"""Share of the settings that a law is to render where nothing else is asked for."""


@dataclass(frozen=True)
class CommissionPlan:
    """How a loader is set up.

    Attributes:
        share: Share of the settings, spaced in proportion, that the law is to render: of the identified loader, and on average of
            machines drawn from all of its tolerances at once.
        fit: What to identify, rows or symbols; whatever the data determine if there are none.
        starts: Places at which the identification's search begins.
        rule: Edition of the rule whose tests are made.
        grid: Settings that are tried, as ``find_envelope`` takes them.
        draws: Machines drawn from all tolerances at once.
        own_instruments: Whether the records come from the bench's own fast instruments, and not through the loader's sensors, whose
            lag is then taken out of them.
        units: Of every page.
        threads: How many; all cores if not given.

    Raises:
        InputError: If a number is out of its range.

    Example:
        >>> import forcefeel as ff
        >>> ff.commission.CommissionPlan(share=0.9).rule
        'part60-a-2014'
    """

    share: float = SHARE
    fit: Sequence[str] = ()
    starts: int = 1
    rule: str = DEFAULT_EDITION
    grid: Mapping[str, str | Sequence[float]] = field(default_factory=lambda: MappingProxyType(dict(COARSE)))
    draws: int = 12
    own_instruments: bool = False
    units: UnitSystem = UnitSystem.US
    threads: int | None = None

    def __post_init__(self) -> None:
        expect_number("share", self.share)
        if not 0 < self.share <= 1:
            raise InputError(f"share: expected a share above 0 % and up to 100 %, got {100 * self.share:.4g} %")
        if not isinstance(self.draws, int) or not 1 <= self.draws <= MOST_DRAWS:
            raise InputError(f"draws: expected 1 to {MOST_DRAWS} machines, got {show(self.draws)}")
