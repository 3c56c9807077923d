"""Export of a law as C, firmware, FMU, matrices Structured Text or drive settings, with expected results."""

from forcefeel.public_names import public_names

__getattr__, __dir__, __all__ = public_names(__name__, __file__)
