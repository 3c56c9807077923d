"""Plan of a commissioning."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType

from forcefeel.choice.score import COARSE
from forcefeel.envelope.draws import MOST_DRAWS
from forcefeel.errors import InputError, expect_number
from forcefeel.qualification import DEFAULT_EDITION
from forcefeel.units import UnitSystem, show

SHARE = 0.95
"""Default required share of the settings."""


@dataclass(frozen=True)
class CommissionPlan:
    """Plan of a commissioning.

    Attributes:
        share: Required share of the settings, spaced in proportion: for the identified loader, and on average of machines with
            joint tolerances.
        fit: Rows or symbols to identify; default, all that the data determine.
        starts: Number of starts of the identification.
        rule: Edition of the rule of the tests.
        grid: Settings, as for ``find_envelope``.
        draws: Number of machines with joint tolerances.
        own_instruments: Whether the records come from the bench's own fast instruments; otherwise the lag of the loader's sensors
            is removed.
        units: Units of the pages.
        threads: Number of threads; default, all cores.

    Raises:
        InputError: If a number is out of its range.

    Example:
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
