"""Identification of a loader from bench data.

Read in this order: ``unknowns``, the parameters; ``linear`` and ``record_run``, the model and its slopes; ``observations``, the
comparison with data; ``problem``, ``search`` and ``friction_jumps``, the fit; ``confidence``, its standard errors;
``inseparable`` and ``advice``, inseparable parameters and experiments that separate them; ``rigid``, the test of the link;
``fit``, the whole identification.
"""
