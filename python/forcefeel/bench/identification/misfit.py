"""What a fit leaves of the data: beside the noise that they state, and as a share of what they show."""

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
"""What is left, in deviations that the data state, from which on it is the model's error and not noise."""

UNEXPLAINED = 0.2
"""Share of a response, or of how far a channel moves, beyond which the model is that of another machine."""


def stated_noise(one: Fitted) -> float | None:
    """Noise that a response states for its lines, relative; root mean square in which they weigh as they are known."""
    data = one.data
    if not isinstance(data, Response) or data.deviation is None:
        return None
    return float(np.mean(line_deviation(data) ** -2.0) ** -0.5)


def unexplained(one: Fitted) -> float:
    """What the model misses beyond noise: relative error of a response; of a record a share of its channel's standard deviation."""
    if isinstance(one.data, Response):
        return math.sqrt(max(one.residual_rms**2 - (stated_noise(one) or 0.0) ** 2, 0.0))
    moves = float(one.measured.real.std())
    return missed_and_noise(one)[0] / moves if moves else math.inf


def explained(fitted: Sequence[Fitted]) -> bool:
    """Whether the model is that of the machine, under every experiment."""
    return all(unexplained(one) <= UNEXPLAINED for one in fitted)


def missed_and_noise(one: Fitted) -> tuple[float, float]:
    """Error of the model and noise in a record's residual, root mean squares, SI units.

    The part of the residual that jumps from sample to sample is noise of the bench's sensors. The part that runs on contains noise
    of the controller's sensors, which moves the machine: its size is simulated, and taken off in mean squares.
    """
    runs_on, jumps = runs_on_and_jumps(one.measured.real - one.modelled.real)
    return math.sqrt(max(runs_on**2 - one.simulated_noise**2, 0.0)), math.hypot(jumps, one.simulated_noise)


def runs_on_and_jumps(left: NDArray[np.float64]) -> tuple[float, float]:
    """The part of a residual that runs on and the part that jumps from sample to sample, root mean squares.

    The part that jumps is half the mean square of the residual's steps.

    Source: J. von Neumann et al., The mean square successive difference, Annals of Mathematical Statistics 12 (1941) 153.
    """
    jumps = float(np.mean(np.diff(left) ** 2)) / 2
    return math.sqrt(max(float(np.mean(left**2)) - jumps, 0.0)), math.sqrt(jumps)


def beyond_noise(one: Fitted) -> bool:
    """Whether the model's error exceeds noise: the deviation that a response states, or the noise of ``missed_and_noise``."""
    if isinstance(one.data, Response):
        stated = stated_noise(one)
        return bool(stated) and one.residual_rms > MODEL_ERROR * (stated or 0.0)
    missed, noise = missed_and_noise(one)
    return missed > MODEL_ERROR * noise


def model_error(one: Fitted, units: UnitSystem) -> str:
    """A sentence where what is left is more than noise."""
    if not beyond_noise(one):
        return ""
    if isinstance(one.data, Response):
        return (
            f"{title_of(one)}: the model misses by {percent(one.residual_rms)} (root mean square) where the data state a noise of "
            f"{percent(stated_noise(one) or 0.0)}: this is an error of the model; the standard errors take it for noise."
        )
    error, noise = (size_text(one, size, units) for size in missed_and_noise(one))
    return (
        f"{title_of(one)}: the model's error is {error} beside a noise of {noise} (root mean square). The standard errors treat "
        "this error as random."
    )


def size_text(one: Fitted, size: float, units: UnitSystem) -> str:
    """A residual or a noise of this set: in percent for a response, in the channel's unit for a record."""
    if isinstance(one.data, Response):
        return percent(size)
    unit = channel_unit(one.channel)
    return f"{rounded(unit.from_si(size, units), 2)} {unit.shown(units)}"
