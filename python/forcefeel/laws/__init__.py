"""What drives a loader: one type of law, made by a design, by hand, or read from its file."""

from forcefeel.public_names import public_names

__getattr__, __dir__, __all__ = public_names(__name__, __file__)
