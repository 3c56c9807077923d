"""The column's dry friction as part of a sampled law: what the loader file says of it, given back, and learnt within its tolerance.

To the load cell and the encoder the friction between hand and load cell looks like a hand that pulls. The observer's plant is told
of it, so that what it estimates is the hand's torque alone, which drives the feel computer through a play, which holds still what
friction may hold. Where the hand is off, what is still estimated of it in motion is an error of the friction, and teaches it.
``crates/model/src/known_friction.rs`` has the equations; here are its numbers.
"""

import numpy as np
from numpy.typing import NDArray

from forcefeel.laws.sampled.plant import SampledPlant
from forcefeel.laws.sampled.sampled_law import OF_FRICTION, SAMPLED

UNCERTAIN = 0.05
"""U, a share of the friction: what noise and learning leave of an error of the level. At 0.03 up to half as many settings again
swing on hands off; at 0.07 fewer pass, since the part for rest also acts where a slow and weak feel turns."""

SLOW_RAD_PER_S = 1.5e-3
"""v_s: a column that takes two minutes over 10 deg rests. From half of it to twice, shares rendered change by four in a hundred at
most; the noise of the estimated rate, some 1e-3 to 1e-2 rad/s r.m.s., smooths the rest. Of a light column it is what
friction changes of the estimated rate in a sample: with less the observer of a column at rest swings from sample to sample."""

LET_GO_S = 0.005
"""1 / l in time. Long beside the time in which a column that turns round rests, short beside a hand that pushes: a column held by
friction is released so much later than the hand lets go. With 1 lb, 93 % of the settings of ``elevator-electric`` pass, and 94 %
with 20 % more friction than stated; at 0.01 s 90 and 88 %, at 0.0025 s 88 and 95 %. At 0.016 s a lever with 3 lb of friction is
0.9 % too soft, at 0.01 s 0.2 %."""

REST_RAD_PER_S = SLOW_RAD_PER_S
"""v_r, the rate below which a column rests. At half of it twice as many settings of ``elevator-electric`` swing on hands off; at
twice that a lever with 3 lb of friction is 4 % too soft, at this rate 0.2 %."""

LEARNS_S = 0.033
"""1 / a in time: with half of what the other direction learns, a swing teaches an error of both within 0.022 s. Slower by a fifth,
friction that is a fifth more passes at 90 in place of 94 %; faster by a quarter, that which is a fifth less at 93, not 94 %."""

BOUND = 1.3
"""g_-, g_+ over the tolerance. The learned friction contains the noise of the estimate: bounded by the tolerance alone, it would
not reach a friction at the end of the tolerance, where 77 in place of 85 to 87 % of the settings of motors at 20 bits pass."""

BLUR_S = 0.005
"""1 / c in time: how long the column must have moved one way, and the hand have been off. At 0.01 s five settings in a hundred
fewer pass where the friction is a fifth more."""

TRUSTED_S = 1.0
"""1 / d in time of a fast column: long beside the moments in which a hand that moves it passes through zero torque. At twice that
a slow hand feels 0.4 of a drift of 0.6 lb after two releases, here 0.2; at half, of 1 lb a push of 20 N at 0.1 Hz feels 7 %, here
3 %."""

_OTHERS = SAMPLED + 2 + OF_FRICTION
"""y, delta, delta', and the single numbers."""


def known_friction(plant: SampledPlant, estimate: NDArray[np.float64]) -> NDArray[np.float64]:
    """The numbers of the friction, (settings, 2 m + 19) for an observer of m states; zeros without friction.

    Args:
        plant: The plant, with its friction.
        estimate: Of the observer's states with the sample, on xi (in the plant's units) and y (SI), (settings, m, m + 3).
    """
    friction, settings, places, scale = plant.friction, len(estimate), plant.places, plant.scale
    level = friction.mean_n_m
    if not level:
        return np.zeros((settings, 2 * places.observed + _OTHERS))
    of_feel = np.zeros((settings, 2))
    rate = np.concatenate([estimate[:, places.base_rate] / scale.time_s, of_feel], axis=1)
    enters = np.zeros((settings, places.observed))
    enters[:, : places.count] = -plant.by_torque / scale.torque_n_m
    # What falls with a jump falls as the column begins to move.
    falls = friction.stribeck_rad_per_s or SLOW_RAD_PER_S
    stated = (*friction.by_direction_n_m, friction.breakaway, 1 / falls)
    # q is the most that friction may be: a column that friction holds looks like a hand that pushes with all of it.
    largest = max(friction.by_direction_n_m) * (1 + friction.breakaway) * (1 + BOUND * friction.off[1])
    slow = np.maximum(SLOW_RAD_PER_S, level * np.abs(np.einsum("ij,ij->i", rate[:, : places.observed], enters)))
    bounds = (BOUND * off for off in friction.off)
    gain, blur, trust = (min(plant.period_s / time, 1.0) for time in (LEARNS_S, BLUR_S, TRUSTED_S))
    before = (*stated, UNCERTAIN * level)
    after = (plant.period_s / LET_GO_S, *bounds, gain / level, largest, blur, trust, REST_RAD_PER_S)
    return np.hstack([rate, enters, np.tile(before, (settings, 1)), slow[:, None], np.tile(after, (settings, 1))])
