"""Possible machines of a sweep: independent draws may violate relations between the rows of a loader."""

import numpy as np
from numpy.typing import NDArray

from forcefeel.loader.consistency import AT_LEAST, BELOW
from forcefeel.loader.parameters import INDEX, OFF

_ROUNDING = 1e-9
"""Relative; as the check of a loader."""


def impossible(values: NDArray[np.float64]) -> dict[str, NDArray[np.bool_]]:
    """Violated relations: a sentence, and for each row of ``values`` (SI) whether it applies.

    The relations of a loader file: a lower stop below the upper one, static friction no smaller than Coulomb's.
    """
    ruled_out: dict[str, NDArray[np.bool_]] = {}
    for low_key, high_key in BELOW:
        low, high = values[:, INDEX[low_key]], values[:, INDEX[high_key]]
        with np.errstate(invalid="ignore"):  # both ends may be infinite, which is far apart
            close = np.isfinite(low) & np.isfinite(high) & (np.abs(high - low) <= _ROUNDING * np.abs(low))
        ruled_out[f"{low_key} is not below {high_key}"] = ~((low < high) | np.isposinf(high)) | close
    for key, minimum in AT_LEAST:
        value = values[:, INDEX[key]]
        present = value != OFF[key]
        ruled_out[f"{key} is below {minimum}"] = present & (value < values[:, INDEX[minimum]] * (1 - _ROUNDING))
    return {sentence: which for sentence, which in ruled_out.items() if which.any()}
