"""A figure of a design as data: labeled curves, without a picture."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from forcefeel.tables.labeled_arrays import LabeledArrays

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
        curves: Arrays of each curve over time or frequency, with units, by its label; ``.dataset`` is one of xarray.
    """

    key: str
    title: str
    kind: Kind
    curves: dict[str, LabeledArrays]
