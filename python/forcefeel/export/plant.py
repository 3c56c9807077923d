"""Linear plant of a law as matrices: servo or motor, link, column and sensor lags.

``x' = A x + B u``, ``y = C x + D u``; ``u``: pilot's force and command · ``s`` sensor output for ``y``, ``s' = w (y - s)``

A force sensor at the grip measures ``F_g = K_g (F_p - m_o R_p theta'')``. Without lag it is the only output with a nonzero D.

The matrices of the machine are the exact Jacobians of the model; a lag adds one state, which replaces the lagged output.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from forcefeel.linear.models import Linkage, plant_model
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ELECTRIC
from forcefeel.loader.sensors import has_grip_sensor

SAMPLED = ("load_cell_force_n", "drive_position_m", "column_angle_rad")
"""Sampled signals of a digital controller: F_c, x_p, theta; with a force sensor at the grip also ``AT_GRIP``, F_g."""

AT_GRIP = "grip_force_n"

_LAGS = ("load_cell.bandwidth", "potentiometer.bandwidth", "column_sensor.bandwidth", "grip_sensor.bandwidth")
"""Bandwidths of the sensors, in the order of ``SAMPLED`` and ``AT_GRIP``."""

_OF_STATES = ("load_pressure_pa", "base_position_m", "base_velocity_m_per_s")
"""Further states of analog gains, in addition to position and feel."""


@dataclass(frozen=True, eq=False)
class LinearPlant:
    """Plant without feel and law.

    Attributes:
        a, b, c, d: A, B, C, D, SI units.
        states, inputs, outputs: Their names, with the unit as suffix.
    """

    a: NDArray[np.float64] = field(repr=False)
    b: NDArray[np.float64] = field(repr=False)
    c: NDArray[np.float64] = field(repr=False)
    d: NDArray[np.float64] = field(repr=False)
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]

    @classmethod
    def of(cls, loader: Loader) -> "LinearPlant":
        """Plant of a loader; with an analog valve its outputs include the states of the gains."""
        model = plant_model(loader, Linkage.COMPLIANT)
        position = "drive_position_m" if loader.drive == ELECTRIC else "piston_position_m"
        rows = [model.output_labels.index(name) for name in (SAMPLED[0], position, SAMPLED[2])]
        a, b, c = model.A, model.B, model.C[rows]
        states = tuple(model.state_labels)
        outputs: tuple[str, ...] = SAMPLED
        if loader["controller.period"] == 0:
            c = np.vstack([c, *(np.eye(len(a))[[states.index(name)]] for name in _OF_STATES)])
            return cls(a, b, c, np.zeros((len(c), 2)), states, tuple(model.input_labels), outputs + _OF_STATES)
        d = np.zeros((len(c), 2))
        if has_grip_sensor(loader):
            gain, outboard = loader["grip_sensor.gain"], loader["grip_sensor.mass"]
            per_base = outboard * loader["column.grip_arm"] / loader["column.base_arm"]
            base_rate = states.index(_OF_STATES[2])
            c = np.vstack([c, -gain * per_base * a[base_rate]])
            d = np.vstack([d, gain * (np.array([1.0, 0.0]) - per_base * b[base_rate])])
            outputs += (AT_GRIP,)
        for sensor, (name, key) in enumerate(zip(outputs, _LAGS, strict=False)):
            if np.isfinite(loader[key]):
                a, b, c, d = _behind((a, b, c, d), sensor, loader[key])
                states += (f"shown_{name}",)
        return cls(a, b, c, d, states, tuple(model.input_labels), outputs)


def _behind(system: tuple[NDArray[np.float64], ...], sensor: int, w: float) -> tuple[NDArray[np.float64], ...]:
    """A, B, C, D with one output behind a lag of bandwidth ``w``."""
    a, b, c, d = system
    n = len(a)
    wide = np.block([[a, np.zeros((n, 1))], [w * c[[sensor]], np.full((1, 1), -w)]])
    lagged, at_once = np.hstack([c, np.zeros((len(c), 1))]), d.copy()
    lagged[sensor], at_once[sensor] = np.eye(n + 1)[n], 0.0
    return wide, np.vstack([b, w * d[sensor]]), lagged, at_once
