"""First minutes with a drive on its bus: nodes, host, delay, watchdog, directions."""

from forcefeel.public_names import public_names

__getattr__, __dir__, __all__ = public_names(__name__, __file__)
