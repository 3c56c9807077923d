"""Setting a loader up: identified from its bench, a law chosen for what is known of it, checked and tested, step by step."""

from forcefeel.public_names import public_names

__getattr__, __dir__, __all__ = public_names(__name__, __file__)
