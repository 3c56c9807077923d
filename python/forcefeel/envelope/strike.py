"""Strike: how fast an end stop throws a column back that a hand pushes into it.

A constant force takes the programmed feel to the stop at a rate, here 1 rad/s, and goes on:

    I delta'' + B delta' + G delta = R_p (F - F_b)

``F_b`` is the feel's breakout and dry friction. In the feel's step response ``delta' / delta`` falls with time, whatever the force:
the feel is at the stop where it has fallen to the rate over the stop's angle. The force follows from ``delta`` there.

A stop takes the momentum of the whole column. Where the feel has less inertia, its law may give the column more speed than it came
with. A stop alone returns it at that speed at most, and the feel's spring at ``omega delta``.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from forcefeel.laws.law import Law
from forcefeel.loader.loader import FEEL_SETTING, Loader
from forcefeel.loader.parameters import INDEX
from forcefeel.simulation import Scenario
from forcefeel.simulation.engine import batch_outputs
from forcefeel.simulation.inputs import Step

RATE_RAD_PER_S = 1.0
"""57 deg/s: fast for a hand that moves a column to its stop; at higher rates the drive adds less."""

THROWN_BACK = 2.0
"""A column is thrown back that leaves the stop more than so many times as fast as it came, and as its feel alone would at most."""

MOST_N = 600.0
"""Largest force of a hand."""

_LASTS_S, _COMES = 0.4, 0.5
"""Duration, at least twice the way to the stop; a column that comes at less than this share of the rate strikes nothing."""

_HALVINGS = 40
"""Of the interval of time in which the feel comes to the stop."""

_Array = NDArray[np.float64]


@dataclass(frozen=True)
class Strikes:
    """Settings that strike a stop.

    Attributes:
        came: Largest rate of the column on its way, rad/s; NaN where it does not strike.
        back: Largest rate away from the stop, likewise.
        of_limit: ``back`` over the rate beyond which the column counts as thrown back, likewise.
    """

    came: _Array
    back: _Array
    of_limit: _Array

    @property
    def thrown_back(self) -> NDArray[np.bool_]:
        """Which are thrown back."""
        return np.asarray(self.of_limit > 1)


def push_n(loader: Loader, feel: _Array, stop_rad: float, rate_rad_per_s: float = RATE_RAD_PER_S) -> _Array:
    """Force at the grip that takes each feel I, B, G (settings, 3) to a stop at a rate."""
    inertia, damping, stiffness = feel.T
    frequency, ratio = np.sqrt(stiffness / inertia), damping / (2 * np.sqrt(inertia * stiffness))
    # Of equal poles the two terms would cancel.
    root = np.sqrt(ratio**2 - 1 + 1e-9j)
    first, second = frequency * (-ratio + root), frequency * (-ratio - root)

    def motion(time: _Array) -> tuple[_Array, _Array]:
        """Step response of the angle, and its rate."""
        fast, slow = np.exp(second * time), np.exp(first * time)
        angle = 1 + (second * slow - first * fast) / (first - second)
        return angle.real, (first * second * (slow - fast) / (first - second)).real

    # A free mass takes twice as long as at a constant rate; where the feel's swing turns round, it has no rate left.
    early, late = np.zeros(len(feel)), np.minimum(2 * stop_rad / rate_rad_per_s, np.pi / (frequency * root.imag))
    for _ in range(_HALVINGS):
        middle = (early + late) / 2
        angle, rate = motion(middle)
        is_there = rate * stop_rad < angle * rate_rad_per_s
        early, late = np.where(is_there, early, middle), np.where(is_there, middle, late)
    angle, _ = motion(late)
    against = loader["feel.breakout"] + loader["feel.coulomb_friction"]
    return np.asarray(stiffness * stop_rad / angle / loader["column.grip_arm"] + against)


def strikes(
    there: Loader,
    law: Law,
    feel: _Array,
    rate_rad_per_s: float = RATE_RAD_PER_S,
    *,
    threads: int | None,
) -> Strikes:
    """The settings I, B, G (settings, 3) of a loader that strike its upper end stop at a rate."""
    stop_rad = float(there["column.stop_high"])
    force = push_n(there, feel, stop_rad, rate_rad_per_s)
    rows = there.rows(FEEL_SETTING, feel)
    rows[:, INDEX["pilot.force"]] = force * there["pilot.force"]
    keep = "column_angle_rad", "column_velocity_rad_per_s"
    scenario = Scenario(Step(1.0), duration_s=_LASTS_S)
    run = batch_outputs(there, scenario, rows, law, keep=keep, first_run=None, threads=threads)
    angle, rate = (run[name] for name in keep)
    struck = np.maximum.accumulate(angle >= stop_rad, axis=1)
    came, back = np.where(struck, 0.0, rate).max(axis=1), -np.where(struck, rate, 0.0).min(axis=1)
    none = ~struck[:, -1] | (came < _COMES * rate_rad_per_s) | (force > MOST_N)
    came, back = (np.where(none, np.nan, value) for value in (came, back))
    alone = np.sqrt(feel[:, 2] / feel[:, 0]) * stop_rad
    return Strikes(came, back, back / (THROWN_BACK * np.maximum(came, alone)))
