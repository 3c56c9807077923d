"""Sweeps: many machines of one design, or one machine at many settings, through one scenario."""

from forcefeel.public_names import public_names

__getattr__, __dir__, __all__ = public_names(__name__, __file__)
