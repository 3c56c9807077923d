"""Designs of sampled laws: regulator, feed-forward from the feel and observer, made for the sampled plant with its delay.

The plant does not see the feel, so that a setting I, B, G shares its two Riccati equations with all settings of its inertia and
has one small linear equation of its own.
"""

from forcefeel.laws.sampled.law_designs import LAW_DESIGNS, LawDesign, law_design
from forcefeel.laws.sampled.observer_law import design
from forcefeel.laws.sampled.plant import SampledPlant
from forcefeel.laws.sampled.rules import robust_tuning
from forcefeel.laws.sampled.tuning import OBSERVER, RECOVERED, Power, Tuning

__all__ = [
    "LAW_DESIGNS",
    "OBSERVER",
    "RECOVERED",
    "LawDesign",
    "Power",
    "SampledPlant",
    "Tuning",
    "design",
    "law_design",
    "robust_tuning",
]
