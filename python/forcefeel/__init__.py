"""forcefeel designs, proves and runs the force feel of aircraft simulator controls.

The names that most users need are here; ``__init__.pyi`` lists them. All other public names are in the modules named after the
commands: ``forcefeel.linear``, ``forcefeel.laws``, ``forcefeel.bench``, ... A module is a noun, a function a verb:
``forcefeel.envelope`` is a module, and ``forcefeel.find_envelope`` computes one. Each name is imported when it is first used.
Examples assume ``import forcefeel as ff``, ``import numpy as np`` and ``from pathlib import Path``.
"""

from forcefeel.public_names import public_names

__getattr__, __dir__, __all__ = public_names(__name__, __file__)
