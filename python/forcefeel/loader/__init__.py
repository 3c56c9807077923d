"""The loader: its file, its parameters and tolerances, its curves, and the built-in ones."""

from forcefeel.public_names import public_names

__getattr__, __dir__, __all__ = public_names(__name__, __file__)
