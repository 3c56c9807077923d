"""Machines with all tolerances at once: the deviation of each parameter is drawn from its tolerance."""

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
"""Largest number of machines of an envelope."""


@dataclass(frozen=True)
class Draws:
    """Number and kind of drawn machines.

    Attributes:
        count: Number of machines.
        seed: Seed of the draws; the same seed draws the same machines.
        corners: Draw every parameter at one end of its tolerance instead of within it.

    Raises:
        InputError: If count or seed is not a whole number in its range.

    Example:
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

        The numbers of a parameter depend only on the seed and its name: a larger count keeps the first machines.
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
"""Probability of the lower end."""
