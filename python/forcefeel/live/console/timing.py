"""The loop's timing as the page draws it."""

import numpy as np

from forcefeel.json_values import Json
from forcefeel.live.state import Histogram, Timing

_EDGES_US = np.array([0.0, *np.geomspace(0.5, 16384.0, 31)])
"""Half powers of two from half a microsecond on."""
_SHARES = {"median": 0.5, "p99": 0.99, "p999": 0.999, "most": 1.0}


def timing_json(timing: Timing) -> dict[str, Json]:
    """How late the thread woke and how long it worked: counts over one scale of bins, and what share took how long at most."""
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
