"""The linear models and what they show: modes, frequency responses, margins, time responses, stability boundary."""

from forcefeel.public_names import public_names

__getattr__, __dir__, __all__ = public_names(__name__, __file__)
