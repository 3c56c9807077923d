"""Bench data: experiments and channels, files, frequency responses from records.

Read in this order: ``experiments`` and ``channels``, inputs and measured quantities; ``responses`` and ``records``, the data;
``data_file``, their files; ``response_checks`` and ``record_checks``, faults in them; ``estimate``, frequency responses from
records; ``plausibility``, mislabeled responses; ``resonance``, a quick estimate of the link.
"""

from forcefeel.public_names import public_names

__getattr__, __dir__, __all__ = public_names(__name__, __file__)
