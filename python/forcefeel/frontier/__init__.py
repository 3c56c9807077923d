"""The frontier of a loader: what cannot be rendered on this hardware and why, and what tighter tolerances or parts would buy."""

from forcefeel.public_names import public_names

__getattr__, __dir__, __all__ = public_names(__name__, __file__)
