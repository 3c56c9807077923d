"""Timing of the loop for the page."""

import numpy as np

from forcefeel.live.state import Histogram, Timing
from forcefeel.units import Json

_EDGES_US = np.array([0.0, *np.geomspace(0.5, 16384.0, 31)])
"""Bin edges: powers of the square root of two from 0.5 us."""
_SHARES = {"median": 0.5, "p99": 0.99, "p999": 0.999, "most": 1.0}


def timing_json(timing: Timing) -> dict[str, Json]:
    """Wake-up latency and working time: counts in common bins, and quantiles."""
    return {
        "edges_us": [float(f"{edge:.4g}") for edge in _EDGES_US],
        "late": _histogram(timing.late),
        "work": _histogram(timing.work),
    }


def _histogram(of: Histogram) -> Json:
    middles = (of.edges_us[:-1] + of.edges_us[1:]) / 2
    binned, _ = np.histogram(np.clip(middles, 0.0, _EDGES_US[-1]), _EDGES_US, weights=of.counts)
    histogram: dict[str, Json] = {"counts": [int(count) for count in binned]}
    for name, share in _SHARES.items():
        histogram[name] = of.quantile_us(share) if of.total else None
    return histogram
