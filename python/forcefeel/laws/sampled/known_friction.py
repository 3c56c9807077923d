"""The column's dry friction as part of a sampled law: what the loader file says of it, given back.

To the load cell and the encoder the friction between hand and load cell looks like a hand that pulls. The observer's plant is told
of it, so that what it estimates is the hand's torque alone, and the feel computer hears that through a play, which holds still what
friction may hold. ``crates/model/src/known_friction.rs`` has the equations; here are its numbers.
"""

import numpy as np
from numpy.typing import NDArray

from forcefeel.laws.sampled.plant import SampledPlant

MARGIN = 0.5
"""M, a share of the friction: room at the edges of the play for the noise of what is estimated. Shares rendered change by less than
three in a hundred from 0.3 to 1."""

SLOW_RAD_PER_S = 1.5e-3
"""v_s: a column that takes two minutes over 10 deg rests. From a fifth of it to twice, shares rendered change by less than three in
a hundred; the noise of the estimated rate, some 1e-3 to 1e-2 rad/s r.m.s., smooths the rest."""

LET_GO_S = 0.02
"""1 / l in time. Long beside the time in which a column that turns round rests, short beside a hand that pushes."""

_OTHERS = 9
"""y, delta, delta', and the four numbers."""


def known_friction(plant: SampledPlant, estimate: NDArray[np.float64]) -> NDArray[np.float64]:
    """The numbers of the friction, (settings, 2 m + 9) for an observer of m states; zeros where there is none.

    Args:
        plant: The plant, with its friction.
        estimate: Of the observer's states with the sample, on xi (in the plant's units) and y (SI), (settings, m, m + 3).
    """
    friction, settings, places, scale = plant.friction_n_m, len(estimate), plant.places, plant.scale
    if not friction:
        return np.zeros((settings, 2 * places.observed + _OTHERS))
    of_feel = np.zeros((settings, 2))
    rate = np.concatenate([estimate[:, places.base_rate] / scale.time_s, of_feel], axis=1)
    enters = np.zeros((settings, places.observed))
    enters[:, : places.count] = -plant.by_torque / scale.torque_n_m
    numbers = (friction, MARGIN * friction, SLOW_RAD_PER_S, plant.period_s / LET_GO_S)
    return np.hstack([rate, enters, np.tile(numbers, (settings, 1))])
