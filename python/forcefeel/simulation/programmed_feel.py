"""The programmed feel alone, I, B and G of eq. (11), with the pilot's arm where there is one, under the force of a run."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel.loader.arms import ARM_ROWS
from forcefeel.loader.loader import FEEL_SETTING, Loader
from forcefeel.loader.parameters import INDEX
from forcefeel.simulation import Run, Scenario
from forcefeel.simulation.inputs import Doublet, Pulse, Recorded, Release, Step
from forcefeel.simulation.scenario import Steps, on_samples

_FEEL = [INDEX[key] for key in FEEL_SETTING]


def has_arm(loader: Loader) -> bool:
    """Whether there is an arm at the grip."""
    return any(loader[row] != 0 for row in ARM_ROWS)


def with_arm(loader: Loader, feel: NDArray[np.float64], arm: Sequence[float]) -> NDArray[np.float64]:
    """I, B, G, a row each or one, with an arm's mass, damping and spring rate, times ``R_p^2``, added.

    The arm stays at the grip, so it is part of the column that is measured and of the one that is programmed.
    """
    return np.asarray(feel + loader["column.grip_arm"] ** 2 * np.array(arm))


def programmed(loader: Loader) -> NDArray[np.float64]:
    """The loader's values with its arm added to I, B and G."""
    values = loader.si_values.copy()
    values[_FEEL] = with_arm(loader, values[_FEEL], [loader[row] for row in ARM_ROWS])
    return values


def spring_is_g(run: Run) -> bool:
    """Whether the programmed spring is G about zero all through the run: no curve in its place, no trim, no change of the feel."""
    scenario = run.scenario
    return not (run.loader.curves or scenario.trim_rad is not None or scenario.feel_changes)


def ideal_angle(run: Run) -> NDArray[np.float64] | None:
    """Column angle of the ideal feel at the run's samples, rad; ``None`` where it does not apply.

    It applies if the spring is G about a constant neutral, and the input is not a sweep or a multisine.
    """
    if not spring_is_g(run) or not isinstance(run.scenario.force, Step | Pulse | Doublet | Recorded | Release):
        return None
    return ideal_response(run.loader, run.scenario)


def ideal_response(loader: Loader, scenario: Scenario) -> NDArray[np.float64]:
    """Column angle, rad, of I, B and G alone, with the arm where there is one, at the samples of a scenario.

    ``x_{k+1} = Phi x_k + Gamma_0 u_k + Gamma_1 (u_{k+1} - u_k)``, exact for a force that changes evenly within each step.
    """
    steps = Steps.of(on_samples(scenario), loader)
    a, b, c, _ = _core.ideal_feel(programmed(loader))
    n = len(a)
    at_rest = -np.linalg.solve(a, b[:, 0])  # under a force of 1 N
    angle, until = steps.held or (0.0, 0)
    hand = angle / float(c[0] @ at_rest)
    force = steps.inputs["force"].copy()
    force[:until] += hand
    # The force is one more state, whose rate is the input.
    whole = np.zeros((n + 1, n + 1))
    whole[:n] = np.column_stack([a, b])
    phi, ramp = _core.discretize(whole, np.eye(n + 1)[:, n:], steps.step_s)
    x = np.append(at_rest * (hand + steps.start_force_n), 0.0)
    states = np.empty((len(force) + 1, n))
    for k, (now, then) in enumerate(force):
        states[k], x[n] = x[:n], now
        x = phi @ x + ramp[:, 0] * ((then - now) / steps.step_s)
    states[-1] = x[:n]
    return np.asarray(states @ c[0])[:: steps.every]
