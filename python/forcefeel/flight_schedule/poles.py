"""Poles of many sampled loops in every case, in batches."""

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
"""Loops per batch: some 20 MB of matrices and poles."""

_SWINGS = 1e-9
"""Smallest angle of an oscillating pole, rad; below it is rounding."""


@dataclass(frozen=True, eq=False)
class Poles:
    """Largest poles of loops.

    Attributes:
        largest: Largest magnitude of a pole, (cases, loops); stable below 1; infinite for a loop with non-finite numbers.
        swinging: The same for complex poles; 0 without complex poles.
        period_s: Sample period, s.
    """

    largest: NDArray[np.float64]
    swinging: NDArray[np.float64]
    period_s: float

    @property
    def critical(self) -> NDArray[np.float64]:
        """Magnitude that ranks loops, (cases, loops): the largest pole if unstable, else the largest complex pole.

        The largest pole of a stable loop is often the observer's leak, a real pole just below 1 at all settings.
        """
        return np.where(self.largest >= 1, self.largest, self.swinging)

    @property
    def decay(self) -> NDArray[np.float64]:
        """Decay rate of the critical pole in 1/s, ``-ln |z| / T``; NaN for a stable loop without complex poles."""
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
    """Poles of each law with its feel (loops, 3) in each case; ``progress`` gets the number of loops of each batch."""
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
    """Loops of a case, one for each law with its feel (loops, 3)."""
    rows = full_rows(loader, case, feel, Law.of(laws, loader))
    return sampled_loops(loader, laws, rows, threads=threads)
