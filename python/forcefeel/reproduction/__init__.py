"""Comparison of every number and claim of the 1974 report with the models.

The report's matrices and digits are an independent reference; no other package reads them.
"""

from forcefeel.public_names import public_names

__getattr__, __dir__, __all__ = public_names(__name__, __file__)
