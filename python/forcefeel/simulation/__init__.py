"""Runs in time of the nonlinear loader: one, or a batch of them."""

from forcefeel.public_names import public_names

__getattr__, __dir__, __all__ = public_names(__name__, __file__)
