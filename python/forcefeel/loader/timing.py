"""The controller's period and delay in steps of a run."""

import numpy as np

from forcefeel.loader.consistency import parts_of_period
from forcefeel.loader.loader import Loader

WHOLE = 1e-9
"""Relative; a quotient of two decimal numbers that is whole but for rounding."""


def controller_steps(loader: Loader, longest_s: float) -> tuple[float, tuple[int, int]]:
    """A step that divides the controller's period and its delay, no longer than so much, and both in such steps.

    Raises:
        InputError: As ``parts_of_period``; no loader has such a delay.
    """
    period, delay = loader["controller.period"], loader["controller.delay"]
    parts = parts_of_period(period, delay)
    steps = parts * int(np.ceil(period / longest_s / parts * (1 - WHOLE)))
    return period / steps, (steps, round(delay / period * steps))
