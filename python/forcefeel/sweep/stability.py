"""Linear stability over a grid of settings: the least damped mode of the nominal loader at each."""

import numpy as np
import xarray as xr

from forcefeel import _core
from forcefeel._core import Compensator
from forcefeel.parameters import INDEX, TABLE
from forcefeel.sweep.plan import Sweep

MOST_POINTS = 40_000
"""Points above which no map is made: half a minute."""


def damping_map(sweep: Sweep) -> xr.DataArray | None:
    """Damping ratio ``-Re p / |p|`` of the least damped pole at each point of the grid; below zero where it is unstable.

    Of the linear model with the compliant link and the sweep's law, the loader at its nominal values; ``None`` for a grid of
    more than 40,000 points.
    """
    if np.prod(sweep.shape) > MOST_POINTS:
        return None
    found = np.empty(sweep.shape)
    values = sweep.loader.values.copy()
    for place in np.ndindex(*sweep.shape):
        for key, k in zip(sweep.axes, place, strict=True):
            values[INDEX[key]] = sweep.axes[key][k]
        law = sweep.compensator or Compensator.original(values)
        poles = np.linalg.eigvals(_core.compliant(values, law)[0])
        found[place] = np.min(-poles.real / np.maximum(np.abs(poles), np.finfo(float).tiny))
    coordinates = {key: (key, np.array(axis), {"units": TABLE[key].unit_si}) for key, axis in sweep.axes.items()}
    return xr.DataArray(found, coordinates, tuple(sweep.axes), "least_damping_ratio")
