"""The computations of the 1974 report for any loader: gains, boundary, responses, sensitivity, conclusions."""

from forcefeel.public_names import public_names

__getattr__, __dir__, __all__ = public_names(__name__, __file__)
