"""What a bench measures: its experiments and channels, its files, frequency responses from its records.

To read in this order: ``experiments`` and ``channels``, what is done and seen; ``responses`` and ``records``, what comes of it;
``data_file``, their files, and ``response_checks``, ``record_checks``, what is wrong with them; ``estimate``, frequency responses
from records; ``plausibility``, responses that are not what they are said to be; ``resonance``, the quick way to a link.
"""

from forcefeel.public_names import public_names

__getattr__, __dir__, __all__ = public_names(__name__, __file__)
