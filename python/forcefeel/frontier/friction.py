"""Smallest friction: friction at the grip without programmed friction.

A slow force sweep, neutral - one side - other side - neutral, moves the grip at the loader's own setting. The angle of I, B and G
alone under the same force is subtracted, which removes the effect of their damping. Half the difference between the strokes down
and back, times G / R_p, is the felt friction,

    F = (d_down - d_back) G / (2 R_p),      d = theta - theta_ideal at no force,

from the remaining dry friction of the column, play and lag. A programmed friction must exceed the noise about it to be felt: r.m.s.
value times G / R_p.
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
"""Duration of the sweep: slow compared with any programmed feel."""

_WINDOW_S = 0.5
"""Window about zero force in which the angle's error is averaged."""

_STEP_S, _SAMPLE_S = 1e-3, 5e-3
FORCE = unit(TABLE["pilot.force"])


@dataclass(frozen=True)
class SmallestFriction:
    """Friction at the grip without programmed friction, at the loader's own setting.

    Attributes:
        felt_n: Felt friction at the grip; NaN if the run diverged.
        noise_n: R.m.s. noise about it, as force at the grip.
        column_n: Dry friction of the column, at the grip.
        force_n: Largest force of the sweep.
    """

    felt_n: Annotated[float, FORCE]
    noise_n: Annotated[float, FORCE]
    column_n: Annotated[float, FORCE]
    force_n: Annotated[float, FORCE]


def smallest_friction(plan: Plan) -> SmallestFriction:
    """Compute the friction at the grip without programmed friction, with the plan's first law.

    Args:
        plan: The envelope; its loader has the own I, B, G, without the optional rows of the feel.
    """
    loader = plan.loader
    name = next(iter(plan.laws))
    per_rad = loader["feel.stiffness"] / loader["column.grip_arm"]  # force at the grip per radian
    force = per_rad * plan.release_rad
    scenario = Scenario(SweepForce(-force, force).over(SWEEP_S), SWEEP_S, _STEP_S, _SAMPLE_S)
    run = simulate(loader, scenario, _own_law(plan, name))
    if run.status is RunStatus.DIVERGED:
        return SmallestFriction(np.nan, np.nan, loader["column.coulomb_friction"], force)
    apart = run.outputs["column_angle_rad"] - ideal_response(loader, scenario)
    down, back = _window(apart, SWEEP_S / 2), _window(apart, SWEEP_S - _WINDOW_S / 2)
    tremble = np.sqrt(np.mean(np.concatenate([_detrended(down), _detrended(back)]) ** 2))
    return SmallestFriction(
        felt_n=per_rad * abs(float(down.mean() - back.mean())) / 2,
        noise_n=per_rad * float(tremble),
        column_n=loader["column.coulomb_friction"],
        force_n=force,
    )


def _own_law(plan: Plan, name: str) -> Law:
    """Law designed for the loader's own setting."""
    return Law.of(plan.laws[name], plan.loader, own_feel(plan.loader), name).single(plan.loader)


def _window(values: NDArray[np.float64], about_s: float) -> NDArray[np.float64]:
    first = round((about_s - _WINDOW_S / 2) / _SAMPLE_S)
    return values[first : first + round(_WINDOW_S / _SAMPLE_S)]


def _detrended(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Values minus their linear trend, which is motion, not noise."""
    time = np.arange(len(values), dtype=np.float64)
    return np.asarray(values - np.polynomial.Polynomial.fit(time, values, 1)(time))
