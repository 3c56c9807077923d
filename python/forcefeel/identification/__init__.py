"""A loader from bench data: what was measured, how it is compared with the model, and how sure the parameters are.

To read in this order: ``experiments`` and ``channels``, what a bench does and sees; ``bench_file``, its files; ``estimate``,
frequency responses from records; ``suspicions``, data that are not what they are said to be; ``linear`` and ``record_run``, the
model and its slopes; ``problem`` and ``confidence``, the fit; ``fit``, all of it; ``resonance``, the quick way.
"""
