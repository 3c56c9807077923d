"""Whether a drive is large enough: what feel and rule ask of it at the grip, and what it gives there."""

from forcefeel.public_names import public_names

__getattr__, __dir__, __all__ = public_names(__name__, __file__)
