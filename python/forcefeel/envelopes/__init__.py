"""The envelope of feels that a loader can render: over the programmed settings, what is stable and what passes."""

from forcefeel.envelopes.draws import Draws
from forcefeel.envelopes.plan import Plan
from forcefeel.envelopes.result import Envelope
from forcefeel.envelopes.run import envelope

__all__ = ["Draws", "Envelope", "Plan", "envelope"]
