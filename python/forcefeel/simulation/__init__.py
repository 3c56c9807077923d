"""Runs in time of the nonlinear loader: one, or a batch of them."""

from forcefeel.simulation.engine import SHARED, simulate, simulate_batch
from forcefeel.simulation.outcome import Measures, Run, RunStatus
from forcefeel.simulation.scenario import FeelChange, Scenario

__all__ = ["SHARED", "FeelChange", "Measures", "Run", "RunStatus", "Scenario", "simulate", "simulate_batch"]
