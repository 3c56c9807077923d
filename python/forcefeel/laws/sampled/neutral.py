"""What a law adds to its command and torque where the feel's neutral is not at zero.

A law is designed for a feel that rests at zero: its feed-forward stretches the link by the spring's force ``G delta``, where
that of a feel trimmed to ``n`` is ``G (delta - n)``. The loader is the same wherever it stands. So a law for the neutral ``n``
is the law for zero with its coordinates moved by ``n``, its column at ``theta - n``, its drive at ``x_p - alpha R_b n``, its
feel at ``delta - n``:

    e = c [xi - p n; y - q n; delta - n; delta'] = c [xi; y; delta; delta'] + c_n n,    T likewise

    c_n = -c [p; q; 1; 0],    q = [0; alpha R_b; 1],    (1 - A) p = B [q; 0]

``q`` what the sensors show per radian of a column that is at rest without a force, ``p`` what the state comes to there.
Without it the motor of ``elevator-electric`` holds the column 7 % of the trim away from the neutral.
"""

from dataclasses import replace

import numpy as np

from forcefeel.errors import InputError
from forcefeel.laws.sampled.sampled_law import SAMPLED, SampledLaw
from forcefeel.loader.loader import Loader

_ROUNDING = 1e-9
"""A sum that is so small beside its terms is zero."""


def trimmed(law: SampledLaw, loader: Loader) -> SampledLaw:
    """The law with its command and torque per radian of the feel's neutral.

    Raises:
        InputError: If the steady state of the law is not determined, because the law has an integrator.
    """
    n = law.states
    shown = np.zeros((law.sampled + 1, 1))
    shown[1:SAMPLED, 0] = loader["linkage.ratio"] * loader["column.base_arm"], 1.0
    try:
        state = np.linalg.solve(np.eye(n) - law.transition, law.input @ shown)[..., 0]
    except np.linalg.LinAlgError as error:
        raise InputError(
            f"transition: expected a stable law, got one with an integrator ({error}); let the integrator leak"
        ) from error
    feel = np.tile([1.0, 0.0], (law.settings, 1))
    moved = np.hstack([state, np.tile(shown[:-1, 0], (law.settings, 1)), feel])
    terms = np.stack([law.command, law.torque], axis=1) * moved[:, None]
    total = terms.sum(axis=2)
    return replace(law, neutral=-np.where(np.abs(total) > _ROUNDING * np.abs(terms).sum(axis=2), total, 0.0))
