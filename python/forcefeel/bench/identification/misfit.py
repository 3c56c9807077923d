"""Residual of a fit against the stated noise, and as a share of the signal."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from forcefeel.bench.channels import channel_unit
from forcefeel.bench.identification.digits import percent, rounded, title_of
from forcefeel.bench.identification.response_observation import line_deviation
from forcefeel.bench.identification.result import Fitted
from forcefeel.bench.responses import Response
from forcefeel.units import UnitSystem

MODEL_ERROR = 2.0
"""Residual over the stated deviation above which it is an error of the model."""

UNEXPLAINED = 0.2
"""Largest residual of a valid model, as a share of a response or of the standard deviation of a channel."""


def stated_noise(fitted: Fitted) -> float | None:
    """Stated noise of a response, relative; root mean square weighted by the accuracy of the lines."""
    data = fitted.data
    if not isinstance(data, Response) or data.deviation is None:
        return None
    return float(np.mean(line_deviation(data) ** -2.0) ** -0.5)


def unexplained(fitted: Fitted) -> float:
    """Error of the model beyond noise: relative for a response, a share of the channel's standard deviation for a record."""
    if isinstance(fitted.data, Response):
        return math.sqrt(max(fitted.residual_rms**2 - (stated_noise(fitted) or 0.0) ** 2, 0.0))
    moves = float(fitted.measured.real.std())
    return missed_and_noise(fitted)[0] / moves if moves else math.inf


def explained(fitted: Sequence[Fitted]) -> bool:
    """Whether the model explains the data of every experiment."""
    return all(unexplained(part) <= UNEXPLAINED for part in fitted)


def missed_and_noise(fitted: Fitted) -> tuple[float, float]:
    """Error of the model and noise in a record's residual, root mean squares, SI units.

    The part of the residual that jumps from sample to sample is noise of the bench's sensors. The part that runs on contains noise
    of the controller's sensors, which moves the machine: its size is simulated, and taken off in mean squares.
    """
    runs_on, jumps = runs_on_and_jumps(fitted.measured.real - fitted.modeled.real)
    return math.sqrt(max(runs_on**2 - fitted.simulated_noise**2, 0.0)), math.hypot(jumps, fitted.simulated_noise)


def runs_on_and_jumps(residual: NDArray[np.float64]) -> tuple[float, float]:
    """The part of a residual that runs on and the part that jumps from sample to sample, root mean squares.

    The part that jumps is half the mean square of the residual's steps.

    Source: J. von Neumann et al., The mean square successive difference, Annals of Mathematical Statistics 12 (1941) 153.
    """
    jumps = float(np.mean(np.diff(residual) ** 2)) / 2
    return math.sqrt(max(float(np.mean(residual**2)) - jumps, 0.0)), math.sqrt(jumps)


def beyond_noise(fitted: Fitted) -> bool:
    """Whether the model's error exceeds noise: the deviation that a response states, or the noise of ``missed_and_noise``."""
    if isinstance(fitted.data, Response):
        stated = stated_noise(fitted)
        return bool(stated) and fitted.residual_rms > MODEL_ERROR * (stated or 0.0)
    missed, noise = missed_and_noise(fitted)
    return missed > MODEL_ERROR * noise


def model_error(fitted: Fitted, units: UnitSystem) -> str:
    """A sentence if the residual exceeds the noise."""
    if not beyond_noise(fitted):
        return ""
    if isinstance(fitted.data, Response):
        return (
            f"{title_of(fitted)}: the model misses by {percent(fitted.residual_rms)} (root mean square), the noise of the data is "
            f"{percent(stated_noise(fitted) or 0.0)}: this is an error of the model; the standard errors count it as noise."
        )
    error, noise = (size_text(fitted, size, units) for size in missed_and_noise(fitted))
    return (
        f"{title_of(fitted)}: the model's error is {error} beside a noise of {noise} (root mean square). The standard errors treat "
        "this error as random."
    )


def size_text(fitted: Fitted, size: float, units: UnitSystem) -> str:
    """A residual or a noise of this set: in percent for a response, in the channel's unit for a record."""
    if isinstance(fitted.data, Response):
        return percent(size)
    unit = channel_unit(fitted.channel)
    return f"{rounded(unit.from_si(size, units), 2)} {unit.shown(units)}"
