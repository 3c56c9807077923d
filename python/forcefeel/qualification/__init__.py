"""Qualification of control feel: rules as data, measuring on records, verdicts."""

from forcefeel.public_names import public_names

__getattr__, __dir__, __all__ = public_names(__name__, __file__)
