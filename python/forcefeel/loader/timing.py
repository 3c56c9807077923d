"""The controller's period and delay in steps of a run."""

import numpy as np

from forcefeel import _core
from forcefeel.loader.consistency import parts_of_period
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ELECTRIC

WHOLE = 1e-9
"""Relative; a quotient of two decimal numbers that is whole but for rounding."""

_CURRENT = 2
"""Place of the current among the states of ``_core.electric_plant``."""

_LARGEST_RATE = 1.5
"""Steps times the fastest pole of a motor and its link, whose steps are of Runge-Kutta's kind: they are stable up to 2.78."""


def longest_step_s(loader: Loader) -> float:
    """The longest step in which a loader may be run; infinite for a valve, whose stiff part is exact, as is a motor's current."""
    if loader.drive != ELECTRIC:
        return np.inf
    a, *_ = _core.electric_plant(loader.si_values)
    moving = np.delete(np.delete(a, _CURRENT, axis=0), _CURRENT, axis=1)
    return float(_LARGEST_RATE / np.abs(np.linalg.eigvals(moving)).max())


def controller_steps(loader: Loader, longest_s: float) -> tuple[float, tuple[int, int]]:
    """A step that divides the controller's period and its delay, no longer than so much or than the drive bears; both in steps.

    Raises:
        InputError: As ``parts_of_period``; no loader has such a delay.
    """
    period, delay = loader["controller.period"], loader["controller.delay"]
    parts, longest_s = parts_of_period(period, delay), min(longest_s, longest_step_s(loader))
    steps = parts * int(np.ceil(period / longest_s / parts * (1 - WHOLE)))
    return period / steps, (steps, round(delay / period * steps))
