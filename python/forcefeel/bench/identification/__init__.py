"""A loader from bench data: how they are compared with the model, and how sure the parameters are.

To read in this order: ``unknowns``, what is to be found; ``linear`` and ``record_run``, the model and its slopes; ``observations``,
data against it; ``problem``, ``search`` and ``friction_jumps``, the fit; ``confidence``, how sure it is; ``inseparable`` and
``advice``, what the data cannot tell apart and what would; ``rigid``, whether the link is compliant; ``fit``, all of it.
"""
