"""Sizing of a drive: demand of the feel and the rule at the grip, and the capability of the drive there."""

from forcefeel.public_names import public_names

__getattr__, __dir__, __all__ = public_names(__name__, __file__)
