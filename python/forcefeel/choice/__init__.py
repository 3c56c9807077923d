"""Choosing for the engineer: every law tried on a loader, scored, and one chosen by a rule that is written down."""

from forcefeel.public_names import public_names

__getattr__, __dir__, __all__ = public_names(__name__, __file__)
