"""Comparison of data with the model: residuals and their slopes by the unknowns.

A data set consists of groups of points of equal noise, the lines of a response or the samples of a channel; the fit estimates the
noise. A data set may have unknowns of its own besides those of the loader: the time of a release.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from forcefeel.bench.records import BenchRecord
from forcefeel.bench.responses import Response


@dataclass(frozen=True, eq=False)
class Compared:
    """Data against the model at one point of the unknowns.

    Attributes:
        residual: Measured less modeled over the point's expected deviation, (points,).
        slopes: Its derivatives by unknowns and by the data's own unknowns, (points, unknowns + own).
    """

    residual: NDArray[np.float64]
    slopes: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Curve:
    """Data and model for plots.

    Attributes:
        channel: Which channel.
        at: Lines in Hz or times in s, (points,).
        measured, modeled: Values, SI units, (points,).
        expected: Deviation of a point that the residuals were divided by: relative for a response, SI units for a record.
    """

    channel: str
    at: NDArray[np.float64]
    measured: NDArray[np.complex128] | NDArray[np.float64]
    modeled: NDArray[np.complex128] | NDArray[np.float64]
    expected: float


class Observation(Protocol):
    """A set of data that can be compared with the model."""

    @property
    def data(self) -> Response | BenchRecord:
        """The data."""
        ...

    @property
    def groups(self) -> tuple[slice, ...]:
        """Slices of the residual, one for each group."""
        ...

    @property
    def clusters(self) -> NDArray[np.int64]:
        """A number for each point: errors of equal numbers are correlated, others are independent, (points,)."""
        ...

    @property
    def own(self) -> NDArray[np.float64]:
        """Initial values of the data's own unknowns."""
        ...

    def compare(self, values: NDArray[np.float64], own: NDArray[np.float64]) -> Compared:
        """Compare the data with a loader of these values of the unknowns, SI units."""
        ...

    def residual(self, values: NDArray[np.float64], own: NDArray[np.float64]) -> NDArray[np.float64]:
        """The residual of ``compare`` alone, (points,)."""
        ...

    def residuals(self, values: NDArray[np.float64], own: NDArray[np.float64]) -> Sequence[NDArray[np.float64]]:
        """The same for several loaders and the data's own unknowns with each, a row each."""
        ...

    def curves(self, values: NDArray[np.float64], own: NDArray[np.float64]) -> tuple[Curve, ...]:
        """The same for plots, one curve for each group."""
        ...

    def simulated_noise(self, values: NDArray[np.float64]) -> Sequence[float]:
        """Root mean square difference between data of a loader of these values and the model, SI units, for each group."""
        ...

    def coarse(self) -> "Observation":
        """A smaller set for the search from afar."""
        ...
