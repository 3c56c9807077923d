"""A feel from measurements of the aircraft: points of force over position, and a recorded release."""

from forcefeel.public_names import public_names

__getattr__, __dir__, __all__ = public_names(__name__, __file__)
