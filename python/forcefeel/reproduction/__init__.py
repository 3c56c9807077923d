"""Every number and claim of the 1974 report, beside what the models give.

The report's matrices and digits are typed in here as an independent witness; nothing else in the package reads them.
"""

from forcefeel.public_names import public_names

__getattr__, __dir__, __all__ = public_names(__name__, __file__)
