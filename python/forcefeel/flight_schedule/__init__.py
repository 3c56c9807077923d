"""Laws over the settings an aircraft runs through: designed at knots, interpolated between them, checked on a refined grid.

Not ``forcefeel.laws.analog.gain_schedule``, which is the report's gains for many settings.
"""

from forcefeel.public_names import public_names

__getattr__, __dir__, __all__ = public_names(__name__, __file__)
