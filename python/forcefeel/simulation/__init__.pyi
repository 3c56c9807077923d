"""Public names; ``__init__.py`` fetches them when first used."""

from forcefeel.simulation.engine import simulate as simulate
from forcefeel.simulation.engine import simulate_batch as simulate_batch
from forcefeel.simulation.findings import run_conclusions as run_conclusions
from forcefeel.simulation.inputs.flight import Flight as Flight
from forcefeel.simulation.inputs.flight import read_flight as read_flight
from forcefeel.simulation.inputs.multisine import Multisine as Multisine
from forcefeel.simulation.inputs.recorded import Recorded as Recorded
from forcefeel.simulation.inputs.recorded import read_recorded as read_recorded
from forcefeel.simulation.inputs.sampled import Schedule as Schedule
from forcefeel.simulation.inputs.signals import Chirp as Chirp
from forcefeel.simulation.inputs.signals import Doublet as Doublet
from forcefeel.simulation.inputs.signals import HandsOff as HandsOff
from forcefeel.simulation.inputs.signals import Pulse as Pulse
from forcefeel.simulation.inputs.signals import Release as Release
from forcefeel.simulation.inputs.signals import Step as Step
from forcefeel.simulation.inputs.signals import StopToStop as StopToStop
from forcefeel.simulation.limits_met import LimitTimes as LimitTimes
from forcefeel.simulation.limits_met import limit_times as limit_times
from forcefeel.simulation.linear import simulate_linear_batch as simulate_linear_batch
from forcefeel.simulation.outcome import Measures as Measures
from forcefeel.simulation.outcome import Run as Run
from forcefeel.simulation.outcome import RunStatus as RunStatus
from forcefeel.simulation.page.page import write_simulation as write_simulation
from forcefeel.simulation.scenario import FeelChange as FeelChange
from forcefeel.simulation.scenario import Scenario as Scenario
