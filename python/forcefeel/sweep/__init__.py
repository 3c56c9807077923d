"""Sweeps: many machines of one design, or one machine at many settings, through one scenario."""

from forcefeel.sweep.plan import Sweep
from forcefeel.sweep.result import SweepResult
from forcefeel.sweep.run import run_sweep

__all__ = ["Sweep", "SweepResult", "run_sweep"]
