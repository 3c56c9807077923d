"""Result of an identification."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from forcefeel.bench.identification.unknowns import Unknown
from forcefeel.bench.records import BenchRecord
from forcefeel.bench.responses import Response
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import TABLE, value_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class Status(StrEnum):
    """Status of one parameter."""

    DETERMINED = "determined"
    AT_BOUND = "at its bound"
    UNDETERMINED = "not determined"


@dataclass(frozen=True)
class Estimate:
    """One parameter as identified, SI units.

    Attributes:
        unknown: The parameter, its bounds and its prior.
        value: Estimate.
        deviation: Its standard error, prior included.
        low, high: Its 95 % interval, by Student's t.
        share: Half the 95 % interval from the data alone, without prior, as a share of the value's size.
        status: Whether the data determine it. Otherwise the value is an arbitrary end of the search, not to be reported, and the
            other numbers are infinite.

    Example:
        >>> data = [ff.read_bench_data("examples/bench/servo-closed.csv")]
        >>> found = ff.identify(ff.load("examples/bench/loader.toml"), data, "k,c", starts=1)
        >>> found["k"].low < found["k"].value < found["k"].high
        True
    """

    unknown: Unknown
    value: float
    deviation: float
    low: float
    high: float
    share: float
    status: Status

    def __str__(self) -> str:
        row = TABLE[self.unknown.key]
        if self.status is Status.UNDETERMINED:
            return f"{row.symbol} {self.status}"
        return f"{row.symbol} = {value_text(row, self.value, 5)} ± {100 * abs(self.deviation / self.value):.2g} %"


@dataclass(frozen=True, eq=False)
class Fitted:
    """One set of data with the fitted model.

    Attributes:
        data: The response or the record.
        channel: The channel; of a response its output.
        at: Lines in Hz of a response, times in s of a record, (points,).
        measured, modeled: Complex responses, or values over time, SI units, (points,).
        before: Model of the loader file, (points,).
        residual_rms: Root mean square residual: relative for a response, SI unit for a record's channel.
        noise: Estimated standard deviation of a point: relative for a response, SI unit for a record.
        simulated_noise: Root mean square by which a record of the fitted loader would still differ from the model, SI unit: the
            controller's sensors are noisy and move the machine, and the engine's steps are finite. Zero for a response.
    """

    data: Response | BenchRecord
    channel: str
    at: NDArray[np.float64]
    measured: NDArray[np.complex128] | NDArray[np.float64]
    modeled: NDArray[np.complex128] | NDArray[np.float64]
    before: NDArray[np.complex128] | NDArray[np.float64]
    residual_rms: float
    noise: float
    simulated_noise: float = 0.0


@dataclass(frozen=True)
class Ended:
    """End of one start of the search.

    Attributes:
        start, end: Values of the unknowns, SI units, (unknowns,).
        cost: Cost there: mean logarithm of the noise over all points, in units of the expected noise.
        same: Whether it is the best end.
    """

    start: NDArray[np.float64]
    end: NDArray[np.float64]
    cost: float
    same: bool


@dataclass(frozen=True)
class RigidTest:
    """Test whether the frequency responses require the link's compliance.

    ``F = ((S_r - S_c) / d) / (S_c / (n - p))``, S the sums of squares of the relative errors with rigid and compliant link, d
    parameters fewer.

    Attributes:
        needed: The verdict: F's probability is below ``level``.
        rigid_rms, compliant_rms: Root mean square relative error of gain and phase of each, weighted by the accuracy of the lines.
        f_statistic, probability: F and its probability if the link were rigid.
        degrees: Its two degrees of freedom.
        bic_difference: Bayesian information criterion of the rigid link less that of the compliant one; above 10 is decisive.
        level: Level of the test.
    """

    needed: bool
    rigid_rms: float
    compliant_rms: float
    f_statistic: float
    probability: float
    degrees: tuple[int, int]
    bic_difference: float
    level: float


@dataclass(frozen=True)
class Inseparable:
    """Parameters that the data cannot separate, or do not depend on.

    Attributes:
        keys: The parameters.
        weights: Direction without effect on the data, in shares of their values, largest 1.
        sentence: Description.
    """

    keys: tuple[str, ...]
    weights: tuple[float, ...]
    sentence: str


@dataclass(frozen=True)
class Advice:
    """An experiment that would determine undetermined parameters.

    Attributes:
        sentence: Description, with the resulting accuracy of each parameter.
        shares: Half the 95 % interval of each unknown with it, as a share of its value.
    """

    sentence: str
    shares: Mapping[str, float]


@dataclass(frozen=True, eq=False)
class Identification:
    """A loader identified from bench data.

    Attributes:
        before: The loader of the file.
        estimates: One for each parameter, in the requested order.
        correlation: Correlation of the estimates, (unknowns, unknowns).
        fitted: Data with the model, in the given order, channel by channel.
        ends: End of each start of the search.
        inseparable: Inseparable parameters; empty if all are determined.
        advice: Further experiments; empty if all parameters are determined, or no experiment helps.
        rigid: Test of the link; ``None`` if not possible, with the reason in ``notes``.
        notes: Remarks, a sentence each.
        loader: The loader with the estimates, their standard errors as tolerances and the data's hash as source; ``None`` if a
            parameter is undetermined or ended at its bound, or the model does not explain the data.
    """

    before: Loader
    estimates: tuple[Estimate, ...]
    correlation: NDArray[np.float64]
    fitted: tuple[Fitted, ...]
    ends: tuple[Ended, ...]
    inseparable: tuple[Inseparable, ...]
    advice: tuple[Advice, ...]
    rigid: RigidTest | None
    notes: tuple[str, ...]
    loader: Loader | None = field(default=None)

    def __repr__(self) -> str:
        each = "; ".join(map(str, self.estimates))
        return f"<Identification of {self.before.name!r}: {each}>"

    def plot(self, ax: "Axes | None" = None) -> "Axes":
        """Plot each estimate and its 95 % interval in percent off the file's value, with the file's tolerances.

        Args:
            ax: Matplotlib axes; default, a new figure.

        Returns:
            The axes.
        """
        from forcefeel.plots.draw import intervals  # noqa: PLC0415  Matplotlib, only for plots

        def relative(estimate: Estimate, value: float) -> float:
            return 100 * (value - estimate.unknown.nominal) / estimate.unknown.scale

        lost = [estimate for estimate in self.estimates if estimate.status is Status.UNDETERMINED]
        determined = [estimate for estimate in self.estimates if estimate not in lost]
        bounded = [estimate for estimate in self.estimates if estimate.unknown.tolerance]
        return intervals(
            {
                estimate.unknown.symbol: (
                    relative(estimate, estimate.value),
                    relative(estimate, estimate.low),
                    relative(estimate, estimate.high),
                )
                for estimate in determined
            },
            {
                estimate.unknown.symbol: (
                    relative(estimate, estimate.unknown.low),
                    relative(estimate, estimate.unknown.high),
                )
                for estimate in bounded
            },
            lost=[estimate.unknown.symbol for estimate in lost],
            x_label="Off the file's value, %",
            title=f"{self.before.name}: identified",
            ax=ax,
        )

    @property
    def determined(self) -> bool:
        """Whether the data determine every requested parameter."""
        return all(estimate.status is not Status.UNDETERMINED for estimate in self.estimates)

    @property
    def within_bounds(self) -> bool:
        """Whether no estimate ended at a bound, where the bound, not the data, sets it."""
        return all(estimate.status is not Status.AT_BOUND for estimate in self.estimates)

    @property
    def keys(self) -> tuple[str, ...]:
        """Rows of the parameters."""
        return tuple(estimate.unknown.key for estimate in self.estimates)

    def __getitem__(self, name: str) -> Estimate:
        """The estimate of a parameter by its row or its symbol.

        Raises:
            KeyError: If it was not requested.
        """
        return next(
            estimate
            for estimate in self.estimates
            if name in {estimate.unknown.key, TABLE[estimate.unknown.key].symbol}
        )


def data_of(fitted: Sequence[Fitted]) -> tuple[Response | BenchRecord, ...]:
    """The sets of data, each once."""
    return tuple({id(part.data): part.data for part in fitted}.values())
