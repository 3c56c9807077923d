"""The programmed feel alone, without servo, linkage and column: what a qualification test holds the loader against.

A feel of I, B and G is reckoned exactly. One with nonlinear rows is run by the engine's own feel computer: on the same loader
with a column of next to no weight, no friction and no stops, the load cell feels the pilot's force alone, and the programmed
displacement moves as the feel would by itself.
"""

from dataclasses import replace
from math import ceil

import numpy as np
from numpy.typing import NDArray

from forcefeel._core import Compensator
from forcefeel.arms import ARM_ROWS
from forcefeel.errors import InputError
from forcefeel.ideal_run import ideal_response
from forcefeel.inputs import Release
from forcefeel.loader import Loader
from forcefeel.models import state_feedback
from forcefeel.qualify.throw import Throw
from forcefeel.run_limits import feel_position
from forcefeel.simulation import RunStatus, Scenario, simulate

_LIGHT = 1e-3
"""Share of the column's weight that is left: the feel's inertia seems larger by this share of both's ratio."""

_STEPS_S = (1e-4, 2e-5)
"""Steps that follow so light a column; a shorter one where the first does not."""

_WHOLE = 1e-9
"""Relative; a quotient that is whole but for rounding."""

_OTHER_PARTS = (
    "amplifier.",
    "valve.",
    "actuator.",
    "linkage.",
    "column.",
    "load_cell.",
    "potentiometer.",
    "controller.",
)

_HELD_ROUNDS, _HELD = 12, 1e-9
"""Rounds in which the angle is found at which the feel, and not the column, is held; share that is near enough."""

_WITHOUT_EFFECT = ("feel.trim_rate", "feel.shaker_force", "feel.shaker_frequency")
"""Rows that do nothing without trim and shaker."""

_NEEDED_BY = {
    "feel.breakout_travel": "feel.breakout",
    "feel.hysteresis_travel": "feel.hysteresis",
    "feel.detent_angle": "feel.detent_force",
    "feel.detent_travel": "feel.detent_force",
}
"""Rows that do nothing without another."""

_STOPS = {
    "feel.soft_stop_low": "low_rad",
    "feel.soft_stop_high": "high_rad",
    "feel.hard_stop_low": "low_rad",
    "feel.hard_stop_high": "high_rad",
}


def nonlinear_rows(loader: Loader, throw: Throw) -> tuple[str, ...]:
    """The rows that make the programmed feel more than I, B and G within the throw."""
    found = [key for key in loader.given if key.startswith("feel.") and key not in _WITHOUT_EFFECT]
    found = [key for key in found if key not in _NEEDED_BY or loader[_NEEDED_BY[key]] != 0]
    found = [key for key in found if key not in _STOPS or abs(loader[key]) < abs(getattr(throw, _STOPS[key]))]
    soft = any(key.startswith("feel.soft_stop") and key in _STOPS for key in found)
    found = [key for key in found if soft or not key.startswith("feel.soft_stop")]
    return (*found, *(["feel.force_curve"] if loader.force_curve is not None else []))


class FeelAlone:
    """The programmed feel of a loader, moved by scenarios.

    Args:
        loader: Whose feel; its arm is left out.
        throw: Within which it is asked for.
        dynamic_pressure_pa: For a feel that depends on it.
    """

    def __init__(self, loader: Loader, throw: Throw, dynamic_pressure_pa: float | None = None) -> None:
        self.rows = nonlinear_rows(loader, throw)
        loader = loader.replace(dict.fromkeys(ARM_ROWS))
        if self.rows:
            self._loader, self._law = _light(loader)
            return
        factor = 1.0
        if loader.stiffness_factor is not None and dynamic_pressure_pa is not None:
            factor = float(loader.stiffness_factor.held(np.array([dynamic_pressure_pa]))[0])
        stiffness = factor * loader["feel.stiffness"]
        self._loader = replace(loader.replace({"feel.stiffness": stiffness}), stiffness_factor=None)

    @property
    def method(self) -> str:
        """How it is found, in words."""
        if not self.rows:
            return "the programmed I, B and G alone, in closed form"
        return f"the feel computer alone, on a column without weight or friction, with {', '.join(self.rows)}"

    def move(self, scenario: Scenario) -> NDArray[np.float64]:
        """Its angle at the samples of a scenario, rad.

        Raises:
            InputError: If it does not come to anything: the engine cannot follow it.
        """
        if not self.rows:
            return ideal_response(self._loader, replace(scenario, dynamic_pressure_pa=None))
        if not isinstance(scenario.force, Release):
            return self._run(scenario)
        target = held = scenario.force.angle_rad
        for _ in range(_HELD_ROUNDS):
            found = self._run(replace(scenario, force=replace(scenario.force, angle_rad=held)))
            if abs(found[0] - target) <= _HELD * abs(target):
                break
            held *= target / found[0] if found[0] else 2.0
        return found

    def _run(self, scenario: Scenario) -> NDArray[np.float64]:
        for longest_s in _STEPS_S:
            step_s = scenario.sample_s / ceil(scenario.sample_s / longest_s * (1 - _WHOLE))
            run = simulate(self._loader, replace(scenario, step_s=step_s), self._law)
            if run.status is not RunStatus.DIVERGED:
                return np.array(run.history[feel_position(run)].values)
        raise InputError(f"{self._loader.name}: the programmed feel alone diverged; see {', '.join(self.rows)}")


def _light(loader: Loader) -> tuple[Loader, Compensator]:
    """The loader with nothing but its feel, and a law whose displacement is an angle."""
    off = [key for key in loader.given if key.startswith(_OTHER_PARTS)]
    light = loader.replace(dict.fromkeys(off) | {"column.inertia": _LIGHT * loader["column.inertia"]})
    per_piston = light["potentiometer.gain"]
    follow = per_piston * light["linkage.ratio"] * light["column.base_arm"]  # e = K_3 (alpha R_b delta - x_p), eq. (13)
    gains = np.array([-per_piston, 0.0, follow, 0.0, 0.0, 0.0, 0.0])
    return light, state_feedback(light, gains)
