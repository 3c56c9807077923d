"""Runs of a loader without any optional row: linear, and so exact at the samples."""

import control
import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel._core import Compensator
from forcefeel.loader import Loader
from forcefeel.models import Linkage, loader_model
from forcefeel.simulation.scenario import Scenario, Steps


def applies(loader: Loader, scenario: Scenario) -> bool:
    """Whether the run is one of the linear models: nothing optional, and nothing but the pilot's force at work."""
    others = (scenario.trim_rad, scenario.dynamic_pressure_pa, scenario.shaker, scenario.feel_changes or None)
    return not loader.given and not loader.curves and all(other is None for other in others)


def run(loader: Loader, law: Compensator, scenario: Scenario) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Outputs (outputs, samples) and measures of the run.

    ``x_{k+1} = Phi x_k + Gamma_0 u_k + Gamma_1 (u_{k+1} - u_k)`` with the exponential of the model's matrices, exact for a force
    that changes evenly within each step.
    """
    model = loader_model(loader, law, Linkage.COMPLIANT)
    steps = Steps.of(scenario, loader)
    force = steps.inputs[:, 0].copy()
    phi, level, ramp = _transition(np.asarray(model.A), np.asarray(model.B)[:, 0], steps.step_s)
    states = np.empty((len(force) + 1, len(phi)))
    states[0] = 0.0
    if steps.held or steps.start_force_n:
        per_force = _at_rest(model)
        angle, until = steps.held or (0.0, 0)
        hand = angle / float(np.asarray(model.C)[0] @ per_force)
        states[0] = per_force * (hand + steps.start_force_n)
        force[:until] += hand
    with np.errstate(over="ignore", invalid="ignore"):
        for k, (now, then) in enumerate(force):
            states[k + 1] = phi @ states[k] + level * now + ramp * (then - now)
        pilot_force = np.append(force[:, 0], force[-1, 1])
        outputs = _outputs(model, states, pilot_force)
    measured = _core.simulation_measure(outputs[:, :: steps.every], scenario.sample_s)
    return outputs[:, :: steps.every], measured


def _transition(
    a: NDArray[np.float64], b: NDArray[np.float64], step_s: float
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Phi, Gamma_0 and Gamma_1 over one step."""
    n = len(a)
    # States in SI units differ by ten powers of ten: balance them, or rounding eats the small ones.
    balanced, (scale, _) = scipy.linalg.matrix_balance(a, permute=False, separate=True)
    block = np.zeros((n + 2, n + 2))
    block[:n, :n] = balanced * step_s
    block[:n, n] = b / scale * step_s
    block[n, n + 1] = 1.0
    whole = scipy.linalg.expm(block)
    phi = whole[:n, :n] * scale[:, np.newaxis] / scale
    return phi, whole[:n, n] * scale, whole[:n, n + 1] * scale


def _at_rest(model: control.StateSpace) -> NDArray[np.float64]:
    """The state at rest under a force of one newton."""
    balanced, (scale, _) = scipy.linalg.matrix_balance(np.asarray(model.A), permute=False, separate=True)
    return np.asarray(-scale * np.linalg.solve(balanced, np.asarray(model.B)[:, 0] / scale))


def _outputs(model: control.StateSpace, states: NDArray[np.float64], force: NDArray[np.float64]) -> NDArray[np.float64]:
    """The engine's outputs, in its order, from the model's."""
    c, d = np.asarray(model.C), np.asarray(model.D)[:, :1]
    signals = dict(zip(model.output_labels, c @ states.T + d * force, strict=True))
    signals |= dict(zip(model.state_labels, states.T, strict=True)) | {"pilot_force_n": force}
    per_base = c[0, model.state_labels.index("base_position_m")]
    signals["column_velocity_rad_per_s"] = per_base * signals["base_velocity_m_per_s"]
    return np.array([signals[_signal(name, signals)] for name, _ in _core.simulation_outputs()])


def _signal(name: str, signals: dict[str, NDArray[np.float64]]) -> str:
    """The model's name, which ends with the unit, of an output of the engine."""
    return next(signal for signal in signals if signal.startswith(name))
