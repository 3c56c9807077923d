"""The envelope of feels that a loader can render: over the programmed settings, what is stable and what passes."""

from forcefeel.envelope.draws import Draws
from forcefeel.envelope.plan import Plan
from forcefeel.envelope.result import Envelope
from forcefeel.envelope.run import envelope

__all__ = ["Draws", "Envelope", "Plan", "envelope"]
