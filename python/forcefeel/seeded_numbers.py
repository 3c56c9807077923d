"""Random numbers of many machines: each belongs to a parameter and a machine, whoever asks for it and in whatever order.

The numbers of a parameter are a stream of Philox 4x64-10, keyed by a seed and the parameter's name; machine k has
the k-th. So a piece of a sweep is the same wherever it is computed, and a parameter's numbers stay when others are varied too.

Source: J. K. Salmon, M. A. Moraes, R. O. Dror, D. E. Shaw, Parallel Random Numbers: As Easy as 1, 2, 3, SC'11.
"""

import hashlib

import numpy as np
from numpy.typing import NDArray

_BLOCK = 4
"""Numbers that Philox makes at a count."""

_KEY_BYTES = 16


def shares(seed: int, key: str, first: int, count: int) -> NDArray[np.float64]:
    """Independent numbers for the row ``key``, uniform between 0 and 1, of machines ``first`` to ``first + count - 1``."""
    digest = hashlib.sha256(f"{seed} {key}".encode()).digest()
    stream = np.random.Philox(key=int.from_bytes(digest[:_KEY_BYTES], "little"), counter=first // _BLOCK)
    skipped = first % _BLOCK
    raw = stream.random_raw(skipped + count)[skipped:]
    return ((raw >> np.uint64(11)).astype(np.float64) + 0.5) * 2.0**-53
