"""Sentences about inseparable parameters.

In shares of their values the unknowns move along a hardly observable direction: (1, -1) of two leaves their product unchanged, so
only the product is determined; (1, 1) leaves the ratio.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from forcefeel.bench.identification.confidence import Confidence, weak_directions
from forcefeel.bench.identification.result import Inseparable
from forcefeel.bench.identification.unknowns import Unknown

DETERMINED = 0.5
"""Half the 95 % interval, as a share of the value, beyond which a parameter is not determined by the data."""

_PART = 0.2
"""Least share of a named parameter in a direction."""

_NEAR_ZERO = 0.1
"""Share of the file's value below which an estimate is no reference of relative motion."""

_EVEN = 0.1
"""Largest difference of two equal weights, for a constant product or ratio."""


def inseparable_sets(unknowns: Sequence[Unknown], confidence: Confidence) -> tuple[Inseparable, ...]:
    """The directions along which the data alone leave more than ``DETERMINED`` open."""
    directions = weak_directions(confidence.information, DETERMINED / confidence.quantile)
    near_zero = confidence.estimates < _NEAR_ZERO * confidence.sizes
    in_estimates = confidence.sizes / np.where(near_zero, confidence.sizes, confidence.estimates)
    sets = tuple(_inseparable(unknowns, direction * in_estimates, confidence.clear) for direction in directions)
    named = tuple(dict.fromkeys(key for group in sets for key in group.keys))
    if 1 < len(named) == len(sets) and any(len(group.keys) > 1 for group in sets):
        # As many directions as parameters: none of them is determined.
        symbols = [unknown.symbol for unknown in unknowns if unknown.key in named]
        of = f"neither {symbols[0]} nor {symbols[1]}" if len(symbols) == 2 else f"none of {_list(symbols)}"
        return (Inseparable(named, (1.0,) * len(named), f"The data determine {of}."),)
    return sets


def _inseparable(unknowns: Sequence[Unknown], direction: NDArray[np.float64], clear: NDArray[np.bool_]) -> Inseparable:
    direction = direction / direction[np.argmax(np.abs(direction))]
    named = np.flatnonzero(np.abs(direction) > _PART).tolist()
    parts = sorted(named, key=lambda j: -abs(float(direction[j])))
    keys = tuple(unknowns[j].key for j in parts)
    weights = tuple(float(direction[j]) for j in parts)
    symbols = [unknowns[j].symbol for j in parts]
    if len(parts) == 1 and not clear[parts[0]]:
        sentence = (
            f"The residual has no clear minimum in {symbols[0]}: it does not rise on both sides, or only in jumps."
        )
        return Inseparable(keys, weights, sentence)
    return Inseparable(keys, weights, _sentence(symbols, weights))


def _sentence(symbols: Sequence[str], weights: Sequence[float]) -> str:
    if len(symbols) == 1:
        return f"The data do not see {symbols[0]}: changing it by half changes nothing beyond the noise."
    if len(symbols) == 2 and abs(abs(weights[1]) - 1) < _EVEN:
        a, b = symbols
        invariant = f"product {a} {b}" if weights[1] < 0 else f"ratio {a} / {b}"
        return f"The data cannot tell {a} from {b}: only their {invariant} is determined."
    if all(abs(weight - 1) < _EVEN for weight in weights):
        return (
            f"The data cannot tell {_list(symbols)} apart: only their mutual ratios are determined. A measured force fixes "
            "their size: record load_cell_force, or drive the loader by a measured pilot_force."
        )
    moves = ", ".join(f"{symbol} by {10 * weight:+.2g} %" for symbol, weight in zip(symbols, weights, strict=True))
    return f"The data cannot tell {_list(symbols)} apart: moving {moves} together changes nothing beyond the noise."


def _list(symbols: Sequence[str]) -> str:
    return f"{', '.join(symbols[:-1])} and {symbols[-1]}"
