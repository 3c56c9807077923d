"""The linear plant that goes with a law: servo or motor, link and column, behind the sensors' lags, as matrices.

``x' = A x + B u``, ``y = C x``; ``u``: pilot's force and command · ``s`` what a sensor shows of ``y``, ``s' = w (y - s)``

The matrices of the machine are the exact Jacobians of the model; a lag is one state more, which takes the place of what it lags.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from forcefeel.linear.models import Linkage, plant_model
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ELECTRIC

SAMPLED = ("load_cell_force_n", "drive_position_m", "column_angle_rad")
"""What a digital controller samples: F_c, x_p, theta."""

_LAGS = ("load_cell.bandwidth", "potentiometer.bandwidth", "column_sensor.bandwidth")
"""The sensors' bandwidths, in the order of ``SAMPLED``."""

_OF_STATES = ("load_pressure_pa", "base_position_m", "base_velocity_m_per_s")
"""States that analog gains act on beside position and feel."""


@dataclass(frozen=True, eq=False)
class LinearPlant:
    """The plant without feel and without law.

    Attributes:
        a, b, c: A, B, C, SI units.
        states, inputs, outputs: Their names, with the unit at the end.
    """

    a: NDArray[np.float64] = field(repr=False)
    b: NDArray[np.float64] = field(repr=False)
    c: NDArray[np.float64] = field(repr=False)
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]

    @classmethod
    def of(cls, loader: Loader) -> "LinearPlant":
        """The plant of a loader; of an analog valve also the states that its gains act on."""
        model = plant_model(loader, Linkage.COMPLIANT)
        position = "drive_position_m" if loader.drive == ELECTRIC else "piston_position_m"
        shown = [model.output_labels.index(name) for name in (SAMPLED[0], position, SAMPLED[2])]
        a, b, c = model.A, model.B, model.C[shown]
        states, outputs = tuple(model.state_labels), SAMPLED
        if loader["controller.period"] == 0:
            c = np.vstack([c, *(np.eye(len(a))[[states.index(name)]] for name in _OF_STATES)])
            return cls(a, b, c, states, tuple(model.input_labels), outputs + _OF_STATES)
        for sensor, key in enumerate(_LAGS):
            if np.isfinite(loader[key]):
                a, b, c = _behind(a, b, c, sensor, loader[key])
                states += (f"shown_{SAMPLED[sensor]}",)
        return cls(a, b, c, states, tuple(model.input_labels), outputs)


def _behind(
    a: NDArray[np.float64], b: NDArray[np.float64], c: NDArray[np.float64], sensor: int, w: float
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """A, B, C with one output behind a lag of bandwidth ``w``."""
    n = len(a)
    wide = np.zeros((n + 1, n + 1))
    wide[:n, :n], wide[n, :n], wide[n, n] = a, w * c[sensor], -w
    shown = np.hstack([c, np.zeros((len(c), 1))])
    shown[sensor] = np.eye(n + 1)[n]
    return wide, np.vstack([b, np.zeros((1, b.shape[1]))]), shown
