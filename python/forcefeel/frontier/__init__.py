"""Frontier of a loader: feels that this hardware cannot render, the reasons, and the gains from tighter tolerances or new parts."""

from forcefeel.public_names import public_names

__getattr__, __dir__, __all__ = public_names(__name__, __file__)
