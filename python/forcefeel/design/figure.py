"""A figure of a design as data: labeled curves, without a picture."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
import xarray as xr

FREQUENCIES_HZ = np.geomspace(0.1, 100.0, 1201)
"""Frequencies of the responses; 400 a decade show a mode of damping ratio 0.1 without corners."""


class Kind(StrEnum):
    """What a figure shows."""

    VALVE = "valve"
    FREQUENCY = "frequency"
    TIME = "time"


@dataclass(frozen=True)
class Figure:
    """One figure as data.

    Attributes:
        key: ``figure-02`` and so on, the report's number.
        title: What it shows.
        kind: How to draw it.
        curves: A data set per curve, by its label; units stand in the variables' ``units`` attribute.
    """

    key: str
    title: str
    kind: Kind
    curves: dict[str, xr.Dataset]
