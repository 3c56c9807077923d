"""The programmed feel alone, without servo, linkage and column: the reference of a qualification test."""

import numpy as np
from numpy.typing import NDArray

from forcefeel._core import BOUND_RAD
from forcefeel.errors import InputError
from forcefeel.loader.loader import Loader
from forcefeel.simulation import Scenario
from forcefeel.simulation.engine import prepared

_PART_S = 5e-5
"""Longest substep with constant force; the error of a changing force is of second order in it."""


class FeelAlone:
    """The programmed feel of a loader, moved by scenarios: its feel computer under the torque ``T = R_p F_p`` of the pilot.

    Args:
        loader: The loader with the feel.
    """

    def __init__(self, loader: Loader) -> None:
        self._loader = loader
        self.rows = tuple(key for key in loader.given if key.startswith("feel."))
        if loader.force_curve is not None:
            self.rows += ("feel.force_curve",)

    @property
    def method(self) -> str:
        """Description of the reference."""
        more = f", {', '.join(self.rows)}" if self.rows else ""
        return f"the programmed feel alone: I, B, G{more}"

    def move(self, scenario: Scenario) -> NDArray[np.float64]:
        """Angle at the samples of a scenario, rad: from rest under the first force, or released.

        Raises:
            InputError: If the feel diverges, or the scenario does not fit the loader.
        """
        angle = prepared(self._loader, scenario).feel_alone(self._loader.si_values, _PART_S)
        if not np.all(np.abs(angle) < BOUND_RAD):  # also where it is not a number
            raise InputError(
                f"{self._loader.name}: the programmed feel alone diverges; see {', '.join(self.rows) or 'I, B, G'}"
            )
        samples = round(scenario.duration_s / scenario.sample_s)
        return angle[:: (len(angle) - 1) // samples]
