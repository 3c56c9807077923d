"""Motion of ideal releases and the force that holds them, by the matrices of eq. (11) from the core.

``w = [delta, delta']``, ``w' = W w + b F_p`` · ``theta_0`` angle of the release
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel.loader.loader import FEEL_SETTING, Loader
from forcefeel.loader.parameters import INDEX

_FEEL = [INDEX[key] for key in FEEL_SETTING]


def release_motion(
    loader: Loader, feel: NDArray[np.float64], angle_rad: float, step_s: float, samples: int
) -> Iterator[tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]]:
    """Velocity, acceleration and jerk, (settings,) each, at the samples of the hands-off release of each row I, B, G."""
    rates = np.array([_core.ideal_feel(_feel_values(loader, row))[0] for row in feel])
    step = _core.feel_transitions(feel, np.array([step_s]))[:, 0]
    state = np.tile([angle_rad, 0.0], (len(feel), 1))
    for _ in range(samples):
        rate = np.einsum("sij,sj->si", rates, state)
        yield state[:, 1], rate[:, 1], np.einsum("sj,sj->s", rates[:, 1], rate)
        state = np.einsum("sij,sj->si", step, state)


def holding_force(loader: Loader, stiffness: NDArray[np.float64], angle_rad: float) -> NDArray[np.float64]:
    """Force at the grip in N that holds each stiffness in N m/rad alone at an angle: ``W w + b F_p = 0`` at rest."""
    matrix, per_force, *_ = _core.ideal_feel(loader.si_values)
    held = -matrix[1, 0] * angle_rad / per_force[1, 0]
    return np.asarray(stiffness * (held / loader["feel.stiffness"]))


def _feel_values(loader: Loader, feel: NDArray[np.float64]) -> NDArray[np.float64]:
    values = loader.si_values.copy()
    values[_FEEL] = feel
    return values
