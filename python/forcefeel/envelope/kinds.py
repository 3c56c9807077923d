"""What becomes of each setting of an envelope, and its colour on every map."""

import numpy as np
from numpy.typing import NDArray

from forcefeel.envelope.result import Envelope, Failure

EVERY, NOMINAL = "passes in every case", "passes nominally only"

COLORS = {
    EVERY: "#009E73",
    NOMINAL: "#A9E3CC",
    Failure.FIRST_CROSSING: "#0072B2",
    Failure.CYCLES: "#74C1EE",
    Failure.OVERSHOOTS: "#E69F00",
    Failure.COUNT: "#F6E65A",
    Failure.FALL: "#CC79A7",
    Failure.REST: "#9AA3AD",
    Failure.UNSTABLE: "#2B2B2B",
}
"""Okabe and Ito's hues, which the colour-blind can tell apart; light and dark differ too, for print without colour."""


def kinds(found: Envelope, compensator: str, *, worst: bool) -> NDArray[np.int8]:
    """Places in ``COLORS`` (damping, frequency, stiffness)."""
    order = list(COLORS)
    table = np.array([order.index(kind) for kind in Failure], dtype=np.int8)
    failing = found.failures(compensator, worst=worst)
    every = found.passes(compensator).all(axis=0).reshape(failing.shape)
    passing = np.where(every, order.index(EVERY), order.index(NOMINAL)).astype(np.int8)
    return np.asarray(np.where(failing < 0, passing, table[failing]))
