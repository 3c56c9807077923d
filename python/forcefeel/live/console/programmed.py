"""Reference of the column: force over position of the programmed feel alone in both directions, with the rule's tolerance."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from forcefeel.errors import InputError
from forcefeel.loader.arms import ARM_ROWS
from forcefeel.loader.axes import rule_axis, usual_axis
from forcefeel.loader.loader import Loader
from forcefeel.qualification import Record, load_rules, measure_sweep
from forcefeel.qualification.plan.feel_alone import FeelAlone
from forcefeel.qualification.plan.motions import Motions, first_force
from forcefeel.qualification.plan.plan import STATIC, duration_s, trials
from forcefeel.qualification.plan.run import QualificationSetup
from forcefeel.qualification.sweep import SweepFeatures
from forcefeel.qualification.throw import Throw
from forcefeel.qualification.tolerance import Tolerance
from forcefeel.units import ANGLE, FORCE, Json, UnitSystem

_POINTS = 201


@dataclass(frozen=True, eq=False)
class Programmed:
    """A slow sweep of the programmed feel alone.

    Attributes:
        throw: Travel of the sweep.
        record: The sweep by the rule.
        features: Its measured figures.
        tolerance: Tolerance of the force.
    """

    throw: Throw
    record: Record
    features: SweepFeatures
    tolerance: Tolerance

    @classmethod
    @lru_cache(maxsize=8)  # takes a second; a test uses the sweep that is already drawn
    def of(cls, loader: Loader, setup: QualificationSetup) -> "Programmed":
        """Sweep of a loader's feel, hands off, as in a qualification.

        Raises:
            InputError: If the feel alone diverges, or cannot be swept.
        """
        rules = load_rules(setup.rule)
        planned = trials(rules, setup.axis or rule_axis(usual_axis(loader.name)))
        static = next((trial.test for trial in planned if trial.key == STATIC), None)
        tolerance = None if static is None else static.tolerance("force")
        if tolerance is None:
            raise InputError(f"rule: {rules.id} has no static force test of this axis")
        loader = loader.replace({row: None for row in ARM_ROWS if loader[row] != 0})
        throw = Throw.of(loader, setup.throw_rad)
        motions = Motions.of(loader, setup.dynamic_pressure_pa)
        first = first_force(loader, throw)
        record = motions.swept(FeelAlone(loader), throw, first, duration_s(rules, "slow"), "programmed feel")
        return cls(throw, record, measure_sweep(record, points=_POINTS), tolerance)

    def force_at(self, angle_rad: float) -> float:
        """Force at the grip that moves the programmed feel from neutral to an angle, N."""
        swept = self.features
        outward = swept.force_up_n if angle_rad > 0 else swept.force_down_n
        known = np.isfinite(outward)
        return float(np.interp(angle_rad, swept.position[known], outward[known]))

    def as_json(self, system: UnitSystem) -> Json:
        """The curve in the page's units."""
        swept, scale = self.features, FORCE.from_si(1.0, system)
        # The outermost points are the turns, with one direction only.
        kept = np.isfinite(swept.force_up_n) & np.isfinite(swept.force_down_n)
        ways = {"up": swept.force_up_n[kept], "down": swept.force_down_n[kept]}
        curve: dict[str, Json] = {"angle": plot_values(swept.position[kept] * ANGLE.from_si(1.0, system))}
        for name, force in ways.items():
            limit = self.tolerance.limit(force, system=system)
            curve[name] = plot_values(force * scale)
            curve[f"{name}_low"], curve[f"{name}_high"] = (
                plot_values((force - limit) * scale),
                plot_values((force + limit) * scale),
            )
        return {**curve, "tolerance": self.tolerance.text(system)}


def plot_values(values: NDArray[np.float64]) -> Json:
    """Numbers for a plot: five digits, ``None`` for non-finite numbers."""
    return [float(f"{value:.5g}") if np.isfinite(value) else None for value in values.tolist()]
