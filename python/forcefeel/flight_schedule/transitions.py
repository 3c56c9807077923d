"""Loops at fixed shares of a change of the setting.

A change blends the accelerations of the two feels and the outputs of the two laws. At the share s

    delta'' = (1 - s) (T - B_0 delta' - G_0 delta) / I_0 + s (T - B_1 delta' - G_1 delta) / I_1

which is the feel ``1 / I = (1 - s) / I_0 + s / I_1``, ``B = I ((1 - s) B_0 / I_0 + s B_1 / I_1)`` and ``G`` likewise,
and the law has the numbers ``(1 - s) a_0 + s a_1``. This differs from the interpolated schedule, whose I, B, G are linear.
"""

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from forcefeel.flight_schedule.schedule import FlightSchedule
from forcefeel.laws.sampled.sampled_law import NUMBERS, SampledLaw


@dataclass(frozen=True, eq=False)
class Transitions:
    """Changes between knots, each at the same shares.

    Attributes:
        ends: Indices of the first and last knot of each change, (changes, 2).
        shares: Shares of the change, between 0 and 1.
    """

    ends: NDArray[np.intp]
    shares: NDArray[np.float64]

    @classmethod
    def of(cls, schedule: FlightSchedule, refine: int) -> "Transitions":
        """Changes between neighbors along each axis and between any two corners, with ``refine - 1`` shares each."""
        shape = tuple(len(axis.values) for axis in schedule.axes)
        knots = np.arange(schedule.knots).reshape(shape)
        pairs = []
        for axis in range(len(shape)):
            along = np.moveaxis(knots, axis, 0)
            pairs.append(np.column_stack([along[:-1].ravel(), along[1:].ravel()]))
        corners = knots[np.ix_(*([0, -1] for _ in shape))].ravel()
        pairs.append(np.array(list(combinations(corners.tolist(), 2))))
        ends = np.unique(np.vstack(pairs), axis=0)
        return cls(ends, np.arange(1, refine) / refine)

    def loops(self, schedule: FlightSchedule) -> tuple[NDArray[np.float64], SampledLaw]:
        """Feels and laws of all changes at all shares; the share runs fastest."""
        start, end = (np.repeat(self.ends[:, k], len(self.shares)) for k in (0, 1))
        share = np.tile(self.shares, len(self.ends))
        first, second = schedule.laws.some(start), schedule.laws.some(end)
        numbers = (_blend(getattr(first, name), getattr(second, name), share) for name in NUMBERS)
        laws = SampledLaw(first.period_s, first.delay_s, *numbers)
        return blended_feel(schedule.rows[start], schedule.rows[end], share), laws


def blended_feel(start: ArrayLike, end: ArrayLike, share: ArrayLike) -> NDArray[np.float64]:
    """I, B, G of a change from ``start`` to ``end`` (..., 3) at a fixed share."""
    first, second, s = np.asarray(start, dtype=float), np.asarray(end, dtype=float), np.asarray(share, dtype=float)
    mobility = _blend(1 / first[..., 0], 1 / second[..., 0], s)
    damping, stiffness = (
        _blend(first[..., k] / first[..., 0], second[..., k] / second[..., 0], s) / mobility for k in (1, 2)
    )
    return np.stack([1 / mobility, damping, stiffness], axis=-1)


def _blend(first: NDArray[np.float64], second: NDArray[np.float64], share: NDArray[np.float64]) -> NDArray[np.float64]:
    s = share.reshape(share.shape + (1,) * (first.ndim - share.ndim))
    return np.asarray((1 - s) * first + s * second)
