"""What the data cannot tell apart, in words.

In shares of its values the unknowns move along a direction that the data hardly see: (1, -1) of two leaves their product alone, so
only the product is determined; (1, 1) only the ratio.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from forcefeel.identification.confidence import weak_directions
from forcefeel.identification.result import Confusion
from forcefeel.identification.unknowns import Unknown

DETERMINED = 0.5
"""Half the 95 % interval, as a share of the value, beyond which a parameter is not determined by the data."""

_PART = 0.2
"""Share in a direction below which a parameter is not named."""

_EVEN = 0.1
"""Within so much two parameters move alike, so that it is their product or ratio that stays."""


def confusions_of(
    unknowns: Sequence[Unknown], information: NDArray[np.float64], quantile: float
) -> tuple[Confusion, ...]:
    """The directions along which the data leave more than ``DETERMINED`` open.

    Args:
        unknowns: The unknowns.
        information: Of the data alone, in shares of the values, (unknowns, unknowns).
        quantile: Standard errors in half a 95 % interval.
    """
    directions = weak_directions(information, DETERMINED / quantile)
    return tuple(_confusion(unknowns, direction) for direction in directions)


def _confusion(unknowns: Sequence[Unknown], direction: NDArray[np.float64]) -> Confusion:
    named = np.flatnonzero(np.abs(direction) > _PART).tolist()
    parts = sorted(named, key=lambda j: -abs(float(direction[j])))
    keys = tuple(unknowns[j].key for j in parts)
    weights = tuple(float(direction[j]) for j in parts)
    return Confusion(keys, weights, _sentence([unknowns[j].symbol for j in parts], weights))


def _sentence(symbols: Sequence[str], weights: Sequence[float]) -> str:
    if len(symbols) == 1:
        return f"The data do not see {symbols[0]}: changing it by half changes nothing beyond the noise."
    if len(symbols) == 2 and abs(abs(weights[1]) - 1) < _EVEN:
        a, b = symbols
        kept = f"product {a} {b}" if weights[1] < 0 else f"ratio {a} / {b}"
        return f"The data cannot tell {a} from {b}: only their {kept} is determined."
    moves = ", ".join(f"{symbol} by {10 * weight:+.2g} %" for symbol, weight in zip(symbols, weights, strict=True))
    names = f"{', '.join(symbols[:-1])} and {symbols[-1]}"
    return f"The data cannot tell {names} apart: moving {moves} together changes nothing beyond the noise."
