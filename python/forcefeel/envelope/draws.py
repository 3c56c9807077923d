"""Machines with all tolerances at once: every parameter off, each by a share of its own, drawn from its tolerance."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from forcefeel.envelope.cases import Case, Kind
from forcefeel.envelope.deviations import Deviation
from forcefeel.errors import InputError
from forcefeel.seeded_numbers import shares
from forcefeel.simulation.scenario import LARGEST_SEED
from forcefeel.units import show

MOST_DRAWS = 1000
"""Most machines of an envelope."""


@dataclass(frozen=True)
class Draws:
    """How many machines are drawn, and how.

    Attributes:
        count: How many; none where it is 0.
        seed: Of the draws; the same seed draws the same machines.
        corners: Every parameter at one or the other end of its tolerance, in place of anywhere between.

    Raises:
        InputError: If count or seed is no whole number in its range.

    Example:
        >>> import forcefeel as ff
        >>> ff.envelope.Draws(count=20, seed=1).count
        20
    """

    count: int = 0
    seed: int = 0
    corners: bool = False

    def __post_init__(self) -> None:
        for name, most in (("count", MOST_DRAWS), ("seed", LARGEST_SEED)):
            number = getattr(self, name)
            if not isinstance(number, int) or isinstance(number, bool) or not 0 <= number <= most:
                raise InputError(f"draws: {name}: expected a whole number from 0 to {most:,}, got {show(number)}")

    def machines(self, deviations: Mapping[str, Deviation]) -> tuple[Case, ...]:
        """The machines, hands off.

        The numbers of a parameter depend on the seed and its name alone: the first machines of many are those of few.

        Args:
            deviations: How far each parameter may be off.
        """
        drawn = {}
        for key, deviation in deviations.items():
            u = shares(self.seed, key, 0, self.count)
            low, high = deviation.ends
            drawn[key] = np.where(u < _HALF, low, high) if self.corners else deviation.drawn(u)
        return tuple(
            Case(f"machine {k + 1}", Kind.DRAWN, {key: float(column[k]) for key, column in drawn.items()})
            for k in range(self.count)
        )


NO_DRAWS = Draws()

_HALF = 0.5
"""Either end is as likely."""
