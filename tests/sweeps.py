"""Sweeps that several test files share: small, and with every nonlinear effect that the engine steps differently."""

import forcefeel as ff
from forcefeel.loader.loader import Loader
from forcefeel.simulation import Scenario
from forcefeel.simulation.inputs import Step
from forcefeel.sweep import Sweep

PUSH = Scenario(Step(427.0, 0.1), duration_s=0.5)
"""The report's pilot force, for half a second: 500 steps."""

PUSH_WORDS = ("--force", "427 N", "--start", "0.1", "--duration", "0.5")
"""The same on the command line."""


def nonlinear() -> Loader:
    """The elevator with orifice, current limit, friction and backlash."""
    return ff.elevator().replace(
        {
            "valve.orifice": True,
            "amplifier.current_limit": "15 mA",
            "column.coulomb_friction": "2 lb",
            "column.static_friction": "3 lb",
            "linkage.backlash": "0.002 in",
            "load_cell.noise": "0.1 lb",
            "controller.period": "1 ms",
        }
    )


def small(runs: int = 400, **options: object) -> Sweep:
    """A Monte Carlo sweep of some hundred runs."""
    return Sweep(nonlinear(), PUSH, runs=runs, **{"law": "original", **options})  # type: ignore[arg-type]
