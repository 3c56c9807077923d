"""The smallest friction: what the hand feels of the machine when no friction is programmed.

The grip is pushed slowly, neutral - one side - the other - neutral, at the loader's own setting, and the angle is held against
that of I, B and G alone under the same force, which leaves out what their damping makes. Half the difference between the way
down and the way back, times G / R_p, is the force of friction that is felt,

    F = (d_down - d_back) G / (2 R_p),      d = theta - theta_ideal at no force,

the column's own dry friction as far as the loop leaves it, play and lag. What trembles about it is noise: its r.m.s. value,
times G / R_p, is what a programmed friction must exceed to be felt.
"""

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from forcefeel.envelope.plan import Plan
from forcefeel.laws.law import Law
from forcefeel.loader.feel_settings import own_feel
from forcefeel.loader.parameters import TABLE, unit
from forcefeel.qualification.plan.sweep_force import SweepForce
from forcefeel.simulation import RunStatus, Scenario, simulate
from forcefeel.simulation.programmed_feel import ideal_response

SWEEP_S = 40.0
"""Length of the sweep: slow beside any programmed feel."""

_WINDOW_S = 0.5
"""About the moment of no force; there the angle's error is averaged."""

_STEP_S, _SAMPLE_S = 1e-3, 5e-3
FORCE = unit(TABLE["pilot.force"])


@dataclass(frozen=True)
class SmallestFriction:
    """What is felt with no friction programmed, at the loader's own setting.

    Attributes:
        felt_n: Friction felt at the grip; not a number where the run diverged.
        noise_n: R.m.s. of what trembles about it, as force at the grip.
        column_n: Dry friction of the column's own, at the grip.
        force_n: Greatest force of the sweep.
    """

    felt_n: Annotated[float, FORCE]
    noise_n: Annotated[float, FORCE]
    column_n: Annotated[float, FORCE]
    force_n: Annotated[float, FORCE]


def smallest_friction(plan: Plan) -> SmallestFriction:
    """The friction that is felt when none is programmed, with the plan's first law.

    Args:
        plan: The envelope; of its loader the own I, B, G, without the optional rows of the feel.
    """
    loader = plan.loader
    name = next(iter(plan.laws))
    per_rad = loader["feel.stiffness"] / loader["column.grip_arm"]  # force at the grip per radian
    force = per_rad * plan.release_rad
    scenario = Scenario(SweepForce(-force, force).over(SWEEP_S), SWEEP_S, _STEP_S, _SAMPLE_S)
    run = simulate(loader, scenario, _own_law(plan, name))
    if run.status is RunStatus.DIVERGED:
        return SmallestFriction(np.nan, np.nan, loader["column.coulomb_friction"], force)
    apart = run.history["column_angle_rad"].values - ideal_response(loader, scenario)
    down, back = _window(apart, SWEEP_S / 2), _window(apart, SWEEP_S - _WINDOW_S / 2)
    tremble = np.sqrt(np.mean(np.concatenate([_detrended(down), _detrended(back)]) ** 2))
    return SmallestFriction(
        felt_n=per_rad * abs(float(down.mean() - back.mean())) / 2,
        noise_n=per_rad * float(tremble),
        column_n=loader["column.coulomb_friction"],
        force_n=force,
    )


def _own_law(plan: Plan, name: str) -> Law:
    """The law that is designed for the loader's own setting."""
    return Law.of(plan.laws[name], plan.loader, own_feel(plan.loader), name).single(plan.loader)


def _window(values: NDArray[np.float64], about_s: float) -> NDArray[np.float64]:
    first = round((about_s - _WINDOW_S / 2) / _SAMPLE_S)
    return values[first : first + round(_WINDOW_S / _SAMPLE_S)]


def _detrended(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Less the straight line through it: the way itself is no noise."""
    time = np.arange(len(values), dtype=np.float64)
    return np.asarray(values - np.polynomial.Polynomial.fit(time, values, 1)(time))
