"""A signal that determines chosen parameters within the limits, and its predicted errors."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from forcefeel.bench.channels import channel_unit
from forcefeel.bench.excitation.information import named, relative_errors
from forcefeel.bench.excitation.limits import Limit
from forcefeel.bench.excitation.plan import ExcitationPlan
from forcefeel.bench.experiments import Experiment
from forcefeel.bench.identification.digits import percent
from forcefeel.bench.identification.inseparable import DETERMINED
from forcefeel.laws.law import Law
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ELECTRIC
from forcefeel.units import UnitSystem, to_text

EVEN_SHARE = 0.2
"""Share of a multisine's power that is spread evenly over all lines, to reveal the response and a wrong model."""

_BESIDE = (
    "It does not show static friction, cogging and free play: record also a slow sweep of the grip's force through the travel and "
    "back (experiment: sweep), and identify from both."
)

VAGUE = DETERMINED / 1.96
"""Relative standard error of an undetermined parameter: half the 95 % interval is half its value."""


@dataclass(frozen=True)
class LimitUse:
    """A limit and its use by the excitation on the nonlinear loader.

    Attributes:
        limit: The limit.
        peak: Largest magnitude, SI units.
    """

    limit: Limit
    peak: float

    @property
    def share(self) -> float:
        """The peak as a share of the limit."""
        return self.peak / self.limit.value


@dataclass(frozen=True, eq=False)
class Excitation:
    """A signal for the bench.

    Attributes:
        loader: The loader of the design.
        experiment: Loop and drive.
        fit: Keys of the parameters to determine.
        plan: The requirements.
        words: Description: kind, lines, periods.
        time_s: Times of the samples, (samples,).
        signal: V of a test signal or N of a force, straight between the samples, (samples,).
        period_s: Period of a multisine; ``None`` for a chirp.
        frequency_hz: Spectral lines, (lines,).
        power: Mean square of each line in V^2 or N^2, without the transient first period, (lines,).
        noise: Standard deviation of the white noise assumed by the prediction, SI units, by measured channel.
        information: Fisher information of the relative parameters, (parameters, parameters).
        uses: The limits with the peaks of the nonlinear loader.
        efficiency: D-efficiency ``(det M / det M*)^(1/p)`` against the best spectrum without evenly spread power, M* its
            information within the same r.m.s. limits; of a chirp against the best multisine.
        even_efficiency: The same of a spectrum of even lines.
        law: Law of the whole loader; ``None`` for that of ``bench_law``, or without one.
    """

    loader: Loader = field(repr=False)
    experiment: Experiment
    fit: tuple[str, ...]
    plan: ExcitationPlan
    words: str
    time_s: NDArray[np.float64] = field(repr=False)
    signal: NDArray[np.float64] = field(repr=False)
    period_s: float | None
    frequency_hz: NDArray[np.float64] = field(repr=False)
    power: NDArray[np.float64] = field(repr=False)
    noise: Mapping[str, float]
    information: NDArray[np.float64] = field(repr=False)
    uses: tuple[LimitUse, ...]
    efficiency: float
    even_efficiency: float
    law: Law | None = field(default=None, repr=False)

    @property
    def law_remark(self) -> str:
        """Remark that the law was made for another loader, or empty: ``Law.made_for_another``."""
        return self.law.made_for_another(self.loader) if self.law is not None else ""

    @property
    def standard_errors(self) -> dict[str, float]:
        """Predicted standard error of each parameter, relative to its value."""
        return dict(zip(self.fit, relative_errors(self.information).tolist(), strict=True))

    @property
    def peak(self) -> float:
        """The signal's largest magnitude, V or N."""
        return float(np.abs(self.signal).max())

    @property
    def binding(self) -> LimitUse:
        """The limit with the largest use."""
        return max(self.uses, key=lambda use: use.share)

    @property
    def vague(self) -> tuple[str, ...]:
        """Undetermined parameters."""
        return tuple(key for key, error in self.standard_errors.items() if not error < VAGUE)

    @property
    def verdict(self) -> str:
        """The predicted errors, in a sentence."""
        if self.vague:
            parameters = ", ".join(named(key) for key in self.vague)
            return f"Not determined: {parameters}. Use a longer time, wider limits or another experiment."
        worst = max(self.standard_errors, key=self.standard_errors.__getitem__)
        return (
            f"All parameters are determined; the largest standard error is {percent(self.standard_errors[worst])}, of "
            f"{named(worst)}."
        )

    def findings(self, units: UnitSystem) -> tuple[str, ...]:
        """Further findings, a sentence each."""
        use = self.binding
        binds = (
            f"The active limit is the {use.limit.name}: {use.limit.text(use.peak, units)} of "
            f"{use.limit.text(use.limit.value, units)}"
        )
        against = "the optimal spectrum within the same r.m.s. limits"
        even = f"a flat spectrum has {percent(self.even_efficiency)}"
        if self.period_s is None:
            cost = f"The chirp's spectrum has {percent(self.efficiency)} of the information of {against}; {even}"
        else:
            cost = (
                f"{percent(EVEN_SHARE)} of the power is spread evenly over all lines to reveal model errors. The spectrum has "
                f"{percent(self.efficiency)} of the information of {against}; {even}"
            )
        noise = ", ".join(f"{name} {_channel_text(name, value, units)}" for name, value in self.noise.items())
        return (
            f"{binds}.",
            f"{cost}.",
            *([self.law_remark] if self.law_remark else []),
            *([_BESIDE] if self.loader.drive == ELECTRIC else []),
            f"The errors are those of white noise alone ({noise}) on the linear model; model errors add to them.",
        )


def _channel_text(channel: str, value: float, units: UnitSystem) -> str:
    unit = channel_unit(channel)
    return f"{to_text(unit.from_si(value, units), 2)} {unit.shown(units)}"
