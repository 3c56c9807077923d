"""Laws over the flight envelope of an aircraft: designed at knots, interpolated between them, checked on a refined grid.

For the report's gains at many settings see ``forcefeel.laws.analog.gain_schedule``.
"""

from forcefeel.public_names import public_names

__getattr__, __dir__, __all__ = public_names(__name__, __file__)
