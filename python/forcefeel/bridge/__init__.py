"""Bridges from aircraft simulators to a running loader, which gets the packets of ``docs/reference/host.md``."""

from forcefeel.public_names import public_names

__getattr__, __dir__, __all__ = public_names(__name__, __file__)
