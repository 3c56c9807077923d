"""Frequency responses against the linear model.

The residual of a line is ``ln(G_measured / G_model)``: its real part the gain's relative error, its imaginary part the phase's
error in rad, both over the line's standard deviation. Its slope is ``-G'/G``.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from forcefeel.bench.identification.linear import LinearModel
from forcefeel.bench.identification.observations import Compared, Curve
from forcefeel.bench.responses import Response

_LEAST_DEVIATION = 1e-4
"""Least relative deviation of a line, so that a line of perfect coherence does not outweigh all others."""

_UNKNOWN_DEVIATION = 0.01
"""Default relative deviation of a line; the fit estimates the actual size."""


@dataclass(frozen=True, eq=False)
class ResponseObservation:
    """A response and the model for its comparison.

    Attributes:
        data: The response.
        model: The linear model in the experiment's loop.
        keys: The unknowns.
    """

    data: Response
    model: LinearModel
    keys: Sequence[str]

    @property
    def groups(self) -> tuple[slice, ...]:
        """All lines are of one kind."""
        return (slice(0, 2 * len(self.data.frequency_hz)),)

    @property
    def clusters(self) -> NDArray[np.int64]:
        """Lines are independent of each other."""
        lines = np.arange(len(self.data.frequency_hz))
        return np.concatenate([lines, lines])

    @property
    def own(self) -> NDArray[np.float64]:
        """None."""
        return np.empty(0)

    def compare(self, values: NDArray[np.float64], own: NDArray[np.float64]) -> Compared:
        """Gain's errors, then phase's."""
        value, slopes = self._modeled(values, self.keys)
        with np.errstate(divide="ignore", invalid="ignore"):
            error = np.log(self.data.value / value) / self.deviation
            slope = -(slopes / value) / self.deviation
        return Compared(np.concatenate([error.real, error.imag]), np.concatenate([slope.real, slope.imag], axis=1).T)

    def residual(self, values: NDArray[np.float64], own: NDArray[np.float64]) -> NDArray[np.float64]:
        """The errors without their slopes."""
        return self.compare(values, own).residual

    def residuals(self, values: NDArray[np.float64], own: NDArray[np.float64]) -> Sequence[NDArray[np.float64]]:
        """The errors of several loaders."""
        return [self.residual(*pair) for pair in zip(values, own, strict=True)]

    def curves(self, values: NDArray[np.float64], own: NDArray[np.float64]) -> tuple[Curve, ...]:
        """The measured and modeled response."""
        value, _ = self._modeled(values, ())
        deviation = float(np.sqrt(np.mean(self.deviation**2)))
        return (Curve(self.data.output, self.data.frequency_hz, self.data.value, value, deviation),)

    def simulated_noise(self, values: NDArray[np.float64]) -> Sequence[float]:
        """Zero: a response states its noise itself."""
        return (0.0,)

    def coarse(self) -> "ResponseObservation":
        """Itself: a response is small."""
        return self

    @cached_property
    def deviation(self) -> NDArray[np.float64]:
        """Relative standard deviation of each line, as far as known."""
        return line_deviation(self.data)

    def _modeled(
        self, values: NDArray[np.float64], keys: Sequence[str]
    ) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
        row = self.model.loader.rows(self.keys, values[np.newaxis])[0]
        response = self.model.responses(row, keys, self.data.frequency_hz)
        return response.between(self.data.input, self.data.output, self.data.experiment.drive)


def line_deviation(response: Response) -> NDArray[np.float64]:
    """Relative standard deviation of each line, known from averaging, or in proportion to ``sqrt((1 - g^2) / 2 g^2)``.

    Source: J. S. Bendat, A. G. Piersol, Random Data, 4th ed., table 9.6.
    """
    deviation = response.deviation
    if deviation is None and response.coherence is not None:
        coherence = np.clip(response.coherence, 1e-6, 1.0)
        deviation = np.sqrt((1 - coherence) / (2 * coherence))
    if deviation is None:
        return np.full(len(response.frequency_hz), _UNKNOWN_DEVIATION)
    return np.maximum(deviation, _LEAST_DEVIATION)


def relative_error(response: Response, modeled: NDArray[np.complex128] | NDArray[np.float64]) -> float:
    """Root mean square relative error of gain and phase, weighted by ``1 / deviation^2``."""
    weight = line_deviation(response) ** -2.0
    error = np.abs(np.log(response.value / modeled)) ** 2 / 2
    return float(np.sqrt(np.sum(weight * error) / np.sum(weight)))
