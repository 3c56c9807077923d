"""Designs of sampled laws: regulator, feed-forward from the feel and observer, made for the sampled plant with its delay.

The plant does not see the feel, so that a setting I, B, G shares its two Riccati equations with all settings of its inertia and
has one small linear equation of its own.
"""

from forcefeel.designs.laws import design
from forcefeel.designs.methods import METHODS, Method, method
from forcefeel.designs.plant import SampledPlant
from forcefeel.designs.tuning import OBSERVER, RECOVERED, ROBUST, Power, Tuning

__all__ = [
    "METHODS",
    "OBSERVER",
    "RECOVERED",
    "ROBUST",
    "Method",
    "Power",
    "SampledPlant",
    "Tuning",
    "design",
    "method",
]
