"""Expected results of an exported loop, from the engine instead of the exported matrices.

For a sampled law they follow from the loop over one period by the machine's own step (``sampled_loops``), for an analog law from
eq. (17), whose matrices are the Jacobian of the whole loader. Effects outside the linear plant are removed.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from forcefeel.export.exported import Exported
from forcefeel.linear.models import Linkage, loader_model
from forcefeel.linear.step import transition
from forcefeel.loader.loader import FEEL_SETTING, Loader
from forcefeel.loops.sampled_loop import sampled_loops

_NOT_IN_PLANT = {
    "valve.orifice": False,
    "column.viscous_friction": None,
    "column.gravity_torque": None,
    "pilot.arm_mass": None,
    "pilot.arm_damping": None,
    "pilot.arm_stiffness": None,
}
"""Rows with a slope at rest that are not in the plant."""

SAMPLES = 2000
"""Samples of the response."""

ANALOG_STEP_S = 5e-4
"""Time between two samples of an analog loop."""


@dataclass(frozen=True, eq=False)
class Expected:
    """Response of the closed loop.

    Attributes:
        time_s: Times of the response, (samples,).
        angle_rad: Column angle after a step of 1 N of the pilot's force, (settings, samples).
        critical: Least stable pole: largest magnitude for a sampled loop, largest real part in 1/s for an analog loop; (settings,).
    """

    time_s: NDArray[np.float64] = field(repr=False)
    angle_rad: NDArray[np.float64] = field(repr=False)
    critical: NDArray[np.float64]

    @classmethod
    def of(cls, exported: Exported) -> "Expected":
        """Response of a loader with its law at each setting."""
        loader = linear_part(exported.loader)
        return _sampled(exported, loader) if exported.law.period_s else _analog(exported, loader)


def linear_part(loader: Loader) -> Loader:
    """The loader without effects outside the linear plant."""
    return loader.replace({key: off for key, off in _NOT_IN_PLANT.items() if key in loader.given}, si=True)


def _sampled(exported: Exported, loader: Loader) -> Expected:
    feel = exported.settings
    loops = sampled_loops(loader, exported.law, loader.rows(FEEL_SETTING, feel))
    angles = np.stack(
        [
            _response(matrix, force, loops.base) / loader["column.base_arm"]
            for matrix, force in zip(loops.matrix, loops.by_force, strict=True)
        ]
    )
    return Expected(_times(loops.period_s), angles, np.abs(loops.poles).max(axis=1))


def _analog(exported: Exported, loader: Loader) -> Expected:
    angles, critical = [], []
    for setting, feel in enumerate(exported.settings):
        at_setting = loader.replace(dict(zip(FEEL_SETTING, feel.tolist(), strict=True)), si=True)
        model = loader_model(at_setting, exported.law.numbers.gain_law(at_setting, setting), Linkage.COMPLIANT)
        phi, by_force, _ = transition(model.A, model.B[:, 0], ANALOG_STEP_S)
        base = model.state_labels.index("base_position_m")
        angles.append(_response(phi, by_force, base) / loader["column.base_arm"])
        critical.append(np.linalg.eigvals(model.A).real.max())
    return Expected(_times(ANALOG_STEP_S), np.stack(angles), np.array(critical))


def _times(between_s: float) -> NDArray[np.float64]:
    return np.asarray(between_s * np.arange(1, SAMPLES + 1), dtype=np.float64)


def _response(matrix: NDArray[np.float64], entry: NDArray[np.float64], state: int) -> NDArray[np.float64]:
    """One state after each step with a unit input."""
    x, response = np.zeros(len(matrix)), np.empty(SAMPLES)
    for k in range(SAMPLES):
        x = matrix @ x + entry
        response[k] = x[state]
    return response
