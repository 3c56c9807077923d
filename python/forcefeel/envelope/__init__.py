"""The envelope of feels that a loader can render: over the programmed settings, what is stable and what passes."""

from forcefeel.public_names import public_names

__getattr__, __dir__, __all__ = public_names(__name__, __file__)
