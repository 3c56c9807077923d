"""How sure a share is that was counted among machines drawn at random.

Source: E. B. Wilson, Probable inference, the law of succession, and statistical inference, 1927.
"""

import math
from statistics import NormalDist

CONFIDENCE = 0.95
"""Of the interval of a share."""


def wilson_interval(count: int, total: int) -> tuple[float, float]:
    """Between these lies the share of all machines, with ``CONFIDENCE``, where ``count`` of ``total`` drawn ones are counted.

    Args:
        count: How many, from 0 to ``total``.
        total: How many were drawn, above 0.
    """
    share, z = count / total, NormalDist().inv_cdf((1 + CONFIDENCE) / 2)
    middle, width = share + z**2 / (2 * total), z * math.sqrt(share * (1 - share) / total + (z / (2 * total)) ** 2)
    low, high = ((middle + side * width) / (1 + z**2 / total) for side in (-1, 1))
    return max(low, 0.0) if count else 0.0, min(high, 1.0) if count < total else 1.0
