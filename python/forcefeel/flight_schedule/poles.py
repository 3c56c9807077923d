"""Poles of many sampled loops in every case, a piece at a time."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from forcefeel.envelope.cases import Case
from forcefeel.envelope.machines import full_rows
from forcefeel.laws.law import Law
from forcefeel.laws.sampled.sampled_law import SampledLaw
from forcefeel.loader.loader import Loader
from forcefeel.loops.sampled_loop import SampledLoops, sampled_loops

_PIECE = 4096
"""Loops at a time: some 20 MB of matrices and poles."""

_SWINGS = 1e-9
"""Rad per period; a pole that turns less does not swing but for rounding."""


@dataclass(frozen=True, eq=False)
class Poles:
    """What stability is read from.

    Attributes:
        largest: Largest magnitude of a pole, (cases, loops); below 1 is stable, infinite where the loop is not made of numbers.
        swinging: The same of the poles that swing, which are not real; 0 where there is none.
        period_s: Sample period.
    """

    largest: NDArray[np.float64]
    swinging: NDArray[np.float64]
    period_s: float

    @property
    def critical(self) -> NDArray[np.float64]:
        """What ranks loops, (cases, loops): the largest pole where it is unstable, else the largest that swings.

        The largest of a stable loop is often the observer's leak, a real pole that is just below 1 wherever one looks.
        """
        return np.where(self.largest >= 1, self.largest, self.swinging)

    @property
    def decay(self) -> NDArray[np.float64]:
        """Rate in 1/s at which the critical pole dies, ``-ln |z| / T``; not a number where a stable loop has none that swings."""
        size = self.critical
        with np.errstate(divide="ignore"):
            return np.where(size > 0, -np.log(size) / self.period_s, np.nan)


def poles_of(
    loader: Loader,
    feel: NDArray[np.float64],
    laws: SampledLaw,
    cases: Sequence[Case],
    *,
    threads: int,
    progress: Callable[[int], None],
) -> Poles:
    """The poles of each law with its feel (loops, 3) in each case; ``progress`` is called with the loops that are done."""
    largest, swinging = np.empty((2, len(cases), len(feel)))
    for first in range(0, len(feel), _PIECE):
        piece = slice(first, first + _PIECE)
        some = laws.some(piece)
        for k, case in enumerate(cases):
            poles = loops_of(loader, feel[piece], some, case, threads=threads).poles
            size = np.abs(poles)
            largest[k, piece] = np.where(np.isfinite(size).all(axis=1), size.max(axis=1), np.inf)
            swings = np.abs(np.angle(poles)) > _SWINGS
            swinging[k, piece] = np.where(swings, size, 0.0).max(axis=1)
            progress(some.settings)
    return Poles(largest, swinging, laws.period_s)


def loops_of(loader: Loader, feel: NDArray[np.float64], laws: SampledLaw, case: Case, *, threads: int) -> SampledLoops:
    """The loops of a case, one for each law with its feel (loops, 3)."""
    rows = full_rows(loader, case, feel, Law.of(laws, loader))
    return sampled_loops(loader, laws, rows, threads=threads)
