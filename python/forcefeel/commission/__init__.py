"""Commissioning of a loader step by step: identification, choice of the law, envelope, tests."""

from forcefeel.public_names import public_names

__getattr__, __dir__, __all__ = public_names(__name__, __file__)
