"""Pilot, loader and aircraft in lock step: the loader's supervised loop on its simulated machine, the aircraft by JSBSim."""

from forcefeel.public_names import public_names

__getattr__, __dir__, __all__ = public_names(__name__, __file__)
