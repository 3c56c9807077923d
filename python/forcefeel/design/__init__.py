"""What the 1974 report computed, for any loader: gains, boundary, responses, sensitivity, what to conclude."""

from forcefeel.public_names import public_names

__getattr__, __dir__, __all__ = public_names(__name__, __file__)
