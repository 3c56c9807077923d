"""Inputs of a simulated loader over time: pilot force, release of the grip, and others.

Every input is frozen data with one method, ``sample(time_s, step_s)``, which returns its ``Sampled`` for a run of ``time_s``.
"""

from forcefeel.simulation.inputs.flight import Flight, read_flight
from forcefeel.simulation.inputs.multisine import Multisine
from forcefeel.simulation.inputs.recorded import Recorded, read_recorded
from forcefeel.simulation.inputs.sampled import Sampled, Schedule
from forcefeel.simulation.inputs.signals import Chirp, Doublet, HandsOff, Pulse, Release, Step, StopToStop

Force = Step | Pulse | Doublet | StopToStop | Chirp | Multisine | Recorded | Release | HandsOff
"""Inputs of the pilot at the grip."""

__all__ = [
    "Chirp",
    "Doublet",
    "Flight",
    "Force",
    "HandsOff",
    "Multisine",
    "Pulse",
    "Recorded",
    "Release",
    "Sampled",
    "Schedule",
    "Step",
    "StopToStop",
    "read_flight",
    "read_recorded",
]
