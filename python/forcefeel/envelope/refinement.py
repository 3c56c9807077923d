"""Which settings of a case to run, so that the outcome of all others follows from their neighbors.

The cells of a coarse lattice over frequency and stiffness are halved, at each damping ratio. A cell is inferred if its corners

1. have the same outcome, other than unstable, and
2. have margins further from the limit than ``GUARD`` times their spread.

Inferred settings take the corners' outcome and the bilinear margin. All settings of the smallest cells that fail this are run.
Last, each inferred setting is run that touches a setting with another known outcome, until none is left.
Stability is known beforehand at every setting.
"""

from collections.abc import Iterator
from itertools import product

import numpy as np
from numpy.typing import NDArray

Strides = tuple[tuple[int, int], ...]

STRIDES: Strides = ((4, 8), (2, 4), (1, 2))
"""Sides of the cells in grid steps along frequency and stiffness."""

SMALL_STRIDES: Strides = STRIDES[1:]
"""Where single settings fail among others that pass."""

PACE = 0.17, 0.31, 0.61, 0.87, 1.0
"""Usual share of the runs by the end of each round, for progress."""

FEWEST, LARGEST_RATIO = 9, 1.25
"""Fewest values, and largest ratio of neighboring values, of frequency and stiffness; a coarser grid is run whole."""

GUARD = 0.5

UNKNOWN = -1
"""Outcome code of a setting that is neither run nor inferred yet."""

_FAR = -1e3
"""Margin in place of a missing one, for comparison only."""

_Indices = tuple[NDArray[np.intp], NDArray[np.intp]]


def rounds(
    outcome: NDArray[np.int8], margin: NDArray[np.float32], unstable: int, strides: Strides = STRIDES
) -> Iterator[NDArray[np.bool_]]:
    """Yield the settings to run next, round by round; fill in all others at the end.

    Args:
        outcome: Codes (cases, damping, frequency, stiffness): ``unstable`` or ``UNKNOWN``. The caller writes the outcomes of the
            settings of each round before the next.
        margin: Margins of the same shape, written likewise.
        unstable: Code of an unstable setting.
        strides: Sides of the cells, halved from each to the next.
    """
    guess, guessed_margin = outcome.copy(), margin.copy()
    active = outcome == UNKNOWN
    for sides in strides:
        ends = [_ends(size, side) for size, side in zip(outcome.shape[2:], sides, strict=True)]
        corners = [(frequency, stiffness) for frequency, stiffness in product(*ends)]
        yield _at_corners(active, corners) & (outcome == UNKNOWN)
        codes = np.stack([outcome[:, :, f[:, np.newaxis], s] for f, s in corners])
        margins = np.stack([margin[:, :, f[:, np.newaxis], s] for f, s in corners])
        inferred = active & _agree(codes, margins, unstable)
        guess[inferred] = codes[0][inferred]
        guessed_margin[inferred] = _bilinear(margins, *ends)[inferred]
        active &= ~inferred
    yield active & (outcome == UNKNOWN)
    while (edge := (outcome == UNKNOWN) & _differs_from_neighbor(outcome, guess)).any():
        yield edge
    rest = outcome == UNKNOWN
    outcome[rest], margin[rest] = guess[rest], guessed_margin[rest]


def _ends(size: int, stride: int) -> _Indices:
    """Lattice points below and above each index; the last index is one."""
    lattice = np.unique([*range(0, size, stride), size - 1])
    index = np.arange(size)
    below = lattice[np.searchsorted(lattice, index, side="right") - 1]
    return below, lattice[np.searchsorted(lattice, index, side="left")]


def _at_corners(active: NDArray[np.bool_], corners: list[_Indices]) -> NDArray[np.bool_]:
    """Corners of the cells of active settings."""
    wanted = np.zeros_like(active)
    case, damping, f, s = np.nonzero(active)
    for frequency, stiffness in corners:
        wanted[case, damping, frequency[f], stiffness[s]] = True
    return wanted


def _agree(codes: NDArray[np.int8], margins: NDArray[np.float32], unstable: int) -> NDArray[np.bool_]:
    """Whether the four corners of each setting's cell allow an inference."""
    compared = np.where(np.isfinite(margins), margins, _FAR)
    clear = np.abs(compared).min(axis=0) > GUARD * np.ptp(compared, axis=0)
    return np.asarray((codes == codes[0]).all(axis=0) & (codes[0] != unstable) & clear)


def _bilinear(margins: NDArray[np.float32], frequency: _Indices, stiffness: _Indices) -> NDArray[np.float32]:
    """Margin between the corners, in grid steps."""
    up, right = (
        (np.arange(len(below)) - below) / np.maximum(above - below, 1) for below, above in (frequency, stiffness)
    )
    up = up[:, np.newaxis]
    weights = (1 - up) * (1 - right), (1 - up) * right, up * (1 - right), up * right
    with np.errstate(invalid="ignore"):
        parts = [np.where(weight > 0, weight * corner, 0.0) for weight, corner in zip(weights, margins, strict=True)]
        return np.asarray(sum(parts), dtype=np.float32)


def _differs_from_neighbor(outcome: NDArray[np.int8], guess: NDArray[np.int8]) -> NDArray[np.bool_]:
    """Whether a known outcome beside each setting differs from its guess, along all three axes and diagonally."""
    padded = np.pad(outcome, ((0, 0), (1, 1), (1, 1), (1, 1)), constant_values=UNKNOWN)
    differs = np.zeros(outcome.shape, dtype=bool)
    for start in product(range(3), repeat=3):
        window = (slice(first, first + size) for first, size in zip(start, outcome.shape[1:], strict=True))
        beside = padded[(slice(None), *window)]
        differs |= (beside != UNKNOWN) & (beside != guess)
    return differs
