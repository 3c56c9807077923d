"""Envelope of a loader: the programmed feels at which a law is stable and passes the rule."""

from forcefeel.public_names import public_names

__getattr__, __dir__, __all__ = public_names(__name__, __file__)
