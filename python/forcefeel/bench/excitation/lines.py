"""Information of each spectral line on the parameters, and its share of the limits."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from forcefeel.bench.channels import inputs, outputs
from forcefeel.bench.excitation.information import check_separable, line_information
from forcefeel.bench.excitation.limits import Limit
from forcefeel.bench.excitation.optimal_power import PowerProblem
from forcefeel.bench.excitation.plan import ExcitationPlan
from forcefeel.bench.experiments import Experiment
from forcefeel.bench.identification.linear import channel_responses
from forcefeel.errors import InputError
from forcefeel.laws.law import LawLike
from forcefeel.loader.loader import Loader

CREST = 2.0
"""Assumed ratio of peak to r.m.s.; phases come near it, and the peaks set the final scale."""


@dataclass(frozen=True, eq=False)
class Lines:
    """Responses of each line: information of the measured channels, responses of the limited ones.

    Attributes:
        frequency_hz: (lines,).
        information: M_i per sample, (lines, parameters, parameters).
        limited: Responses of the limited channels, (limits, lines).
        limit: The limits, SI units, (limits,).
        sigma: Noise of each measured channel, SI units, (channels,).
        travel: Response of the column's angle, (lines,).
    """

    frequency_hz: NDArray[np.float64]
    information: NDArray[np.float64]
    limited: NDArray[np.complex128]
    limit: NDArray[np.float64]
    sigma: NDArray[np.float64]
    travel: NDArray[np.complex128]

    def problem(self, even_share: float) -> PowerProblem:
        """The power problem with a share of evenly spread power."""
        cost, budget = np.abs(self.limited) ** 2, (self.limit / CREST) ** 2
        free = PowerProblem(self.information, cost, budget, np.zeros(len(self.frequency_hz)))
        return free.with_floor(even_share * free.even())


def lines_of(
    loader: Loader,
    keys: tuple[str, ...],
    experiment: Experiment,
    plan: ExcitationPlan,
    frequency_hz: NDArray[np.float64],
    law: LawLike,
    limits: Sequence[Limit],
) -> Lines:
    """Responses of each line, checked to determine the parameters.

    Raises:
        InputError: If a measured channel or the effect of a parameter is zero in this experiment.
        NotSeparableError: If parameters are inseparable.
    """
    responses = channel_responses(loader, experiment.loop, keys, frequency_hz, law=law)
    drive, seen = list(inputs(loader.drive)).index(experiment.drive), list(outputs(loader.drive))
    measured = [seen.index(name) for name in plan.channels]
    value = responses.value[measured, drive]
    theta = np.array([loader[key] for key in keys])
    slopes = theta[:, np.newaxis, np.newaxis] * responses.slopes[:, measured, drive]
    channels = {
        **dict(zip(seen, responses.value[:, drive], strict=True)),
        str(experiment.drive): np.ones(len(frequency_hz)),
    }
    limited = np.array([channels[bound.channel] for bound in limits])
    limit = np.array([bound.value for bound in limits])
    even = float(np.min((limit / CREST) ** 2 / np.sum(np.abs(limited) ** 2, axis=1)))
    sigma = _noise(plan, np.sqrt(even * np.sum(np.abs(value) ** 2, axis=1)))
    check_separable(keys, slopes, value, sigma, loader, str(experiment))
    return Lines(frequency_hz, line_information(slopes, sigma), limited, limit, sigma, channels["column_angle"])


def _noise(plan: ExcitationPlan, rms: NDArray[np.float64]) -> NDArray[np.float64]:
    """Standard deviation of the noise of each measured channel: as stated, or a share of its r.m.s. under even lines."""
    for name, moved in zip(plan.channels, rms.tolist(), strict=True):
        if not moved:
            raise InputError(f"measure: {name} does not move in this experiment; measure another channel")
    return np.array(
        [
            plan.noise.get(name, plan.noise_share * moved)
            for name, moved in zip(plan.channels, rms.tolist(), strict=True)
        ]
    )
