"""A law closed on a loader: loops at the command, loops of a sampled law, their margins."""

from forcefeel.public_names import public_names

__getattr__, __dir__, __all__ = public_names(__name__, __file__)
