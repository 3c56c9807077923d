"""The force of a sweep neutral - stop - opposite stop - neutral, without corners, to avoid oscillation.

``F`` goes from 0 to ``F_high`` in a quarter of the time, to ``F_low`` in a half, and back to ``F_end`` in a quarter, each as half a
cosine: ``F = a + (b - a) (1 - cos(pi s)) / 2``, ``s`` from 0 to 1. ``F_end`` is 0, but of a control that its friction holds.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from forcefeel.simulation.inputs import Recorded

_POINTS_EACH_SECOND = 200
_FEWEST_POINTS = 2001


@dataclass(frozen=True)
class SweepForce:
    """Greatest forces to either side, N at the grip.

    Attributes:
        low_n, high_n: Lowest and highest force, below and above 0.
        end_n: Force at the end, which brings back to neutral what does not go there by itself.
    """

    low_n: float
    high_n: float
    end_n: float = 0.0

    def over(self, duration_s: float) -> Recorded:
        """The force of a sweep of ``duration_s``."""
        time = np.linspace(0.0, duration_s, max(_FEWEST_POINTS, round(_POINTS_EACH_SECOND * duration_s) + 1))
        part = 4 * time / duration_s
        out = self.high_n * _eased(part)
        across = (self.low_n - self.high_n) * _eased((part - 1) / 2)
        back = (self.end_n - self.low_n) * _eased(part - 3)
        return Recorded(time, out + across + back, "sweep")

    def scaled(self, low: float, high: float) -> "SweepForce":
        """The force with each side scaled by a factor."""
        return SweepForce(self.low_n * low, self.high_n * high, self.end_n)


def _eased(share: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray((1 - np.cos(np.pi * np.clip(share, 0.0, 1.0))) / 2)
