"""A law handed on: as C, as matrices with the loop that they close, or as a sheet of parameters, with what must come out."""

from forcefeel.public_names import public_names

__getattr__, __dir__, __all__ = public_names(__name__, __file__)
