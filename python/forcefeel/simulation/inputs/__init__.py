"""What is applied to a simulated loader over time: the pilot's force, the release of the grip, the other inputs.

Every kind is frozen data with one method, ``sample(time_s, step_s)``, that gives its ``Sampled`` for a run of ``time_s``.
"""

from forcefeel.simulation.inputs.multisine import Multisine
from forcefeel.simulation.inputs.recorded import Recorded, read_recorded
from forcefeel.simulation.inputs.sampled import Sampled, Schedule
from forcefeel.simulation.inputs.signals import Chirp, Doublet, HandsOff, Pulse, Release, Step, StopToStop

Force = Step | Pulse | Doublet | StopToStop | Chirp | Multisine | Recorded | Release | HandsOff
"""What a pilot may do to the grip."""

__all__ = [
    "Chirp",
    "Doublet",
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
    "read_recorded",
]
