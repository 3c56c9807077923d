"""Two pilots' controls joined by a link: both loaders in one run."""

from forcefeel.public_names import public_names

__getattr__, __dir__, __all__ = public_names(__name__, __file__)
