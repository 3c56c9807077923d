"""What an identification found."""

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
    """What the data say of one parameter."""

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
        status: Whether the data determine it. Of what they do not, the value is where the search happened to end and not to be
            reported; the other numbers are infinite.

    Example:
        >>> import forcefeel as ff
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
    """One set of data beside what the fitted model gives.

    Attributes:
        data: The response or the record.
        channel: Which channel of it; of a response the one it leads to.
        at: Lines in Hz of a response, times in s of a record, (points,).
        measured, modelled: Complex responses, or values over time, SI units, (points,).
        before: What the loader file's model gives, (points,).
        residual_rms: Root mean square of what is left: relative error of a response, SI unit of a record's channel.
        noise: Standard deviation of a point as the fit found it: relative for a response, SI unit for a record.
        simulated_noise: Root mean square by which a record of the fitted loader would still differ from the model, SI unit: the
            controller's sensors are noisy and move the machine, and the engine's steps are finite. Zero for a response.
    """

    data: Response | BenchRecord
    channel: str
    at: NDArray[np.float64]
    measured: NDArray[np.complex128] | NDArray[np.float64]
    modelled: NDArray[np.complex128] | NDArray[np.float64]
    before: NDArray[np.complex128] | NDArray[np.float64]
    residual_rms: float
    noise: float
    simulated_noise: float = 0.0


@dataclass(frozen=True)
class Ended:
    """Where one start of the search ended.

    Attributes:
        start, end: Values of the unknowns, SI units, (unknowns,).
        cost: What is left there: mean logarithm of the noise over all points, in units of what was expected.
        same: Whether it is the place of the best one.
    """

    start: NDArray[np.float64]
    end: NDArray[np.float64]
    cost: float
    same: bool


@dataclass(frozen=True)
class RigidTest:
    """Whether the link's compliance is needed to explain the frequency responses.

    ``F = ((S_r - S_c) / d) / (S_c / (n - p))``, S the sums of squares of the relative errors with rigid and compliant link, d
    parameters fewer; two information criteria more for those who like them.

    Attributes:
        needed: The verdict: F's probability is below ``level``.
        rigid_rms, compliant_rms: Root mean square relative error of gain and phase that each leaves; lines weigh as they are known.
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
    """Parameters that the data cannot tell apart, or do not see.

    Attributes:
        keys: The parameters.
        weights: How they move together, in shares of their values, largest 1: what changes nothing in the data.
        sentence: The same in words.
    """

    keys: tuple[str, ...]
    weights: tuple[float, ...]
    sentence: str


@dataclass(frozen=True)
class Advice:
    """An experiment that would determine what these data do not.

    Attributes:
        sentence: Which, and how well each parameter would then be known.
        shares: Half the 95 % interval of each unknown with it, as a share of its value.
    """

    sentence: str
    shares: Mapping[str, float]


@dataclass(frozen=True, eq=False)
class Identification:
    """A loader identified from bench data.

    Attributes:
        before: The loader as its file has it.
        estimates: One for each parameter, in the order asked for.
        correlation: Of the estimates, (unknowns, unknowns).
        fitted: Data beside the model, in the order given, channel by channel.
        ends: Where each start of the search ended.
        inseparable: What the data cannot tell apart; empty if all is determined.
        advice: What would; empty if all is determined, or nothing known would.
        rigid: Whether the link is compliant; ``None`` where it cannot be judged, and why stands in ``notes``.
        notes: What is worth knowing, a sentence each.
        loader: The loader with the estimates, their standard errors as tolerances and the data's hash as source; ``None`` where a
            parameter is not determined or ended at its bound, or the model does not explain the data.

    Example:
        >>> import forcefeel as ff
        >>> data = [ff.read_bench_data("examples/bench/servo-closed.csv")]
        >>> found = ff.identify(ff.load("examples/bench/loader.toml"), data, "k,c", starts=1)
        >>> found.determined, found.keys
        (True, ('linkage.stiffness', 'linkage.damping'))
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
        """Draws each estimate with its 95 % interval in percent off the file's value, over what the file's tolerances allow.

        Args:
            ax: Matplotlib axes to draw on; of a figure of its own if not given.

        Returns:
            The axes.
        """
        from forcefeel.plots.draw import intervals  # noqa: PLC0415  Matplotlib, for whoever plots

        def off(one: Estimate, value: float) -> float:
            return 100 * (value - one.unknown.nominal) / one.unknown.scale

        lost = [it for it in self.estimates if it.status is Status.UNDETERMINED]
        known = [it for it in self.estimates if it not in lost]
        bounded = [it for it in self.estimates if it.unknown.tolerance]
        return intervals(
            {it.unknown.symbol: (off(it, it.value), off(it, it.low), off(it, it.high)) for it in known},
            {it.unknown.symbol: (off(it, it.unknown.low), off(it, it.unknown.high)) for it in bounded},
            lost=[it.unknown.symbol for it in lost],
            x_label="Off the file's value, %",
            title=f"{self.before.name}: identified",
            ax=ax,
        )

    @property
    def determined(self) -> bool:
        """Whether the data determine every parameter that was asked for."""
        return all(it.status is not Status.UNDETERMINED for it in self.estimates)

    @property
    def within_bounds(self) -> bool:
        """Whether no estimate ended at a bound: one that did is the bound's, not the data's."""
        return all(it.status is not Status.AT_BOUND for it in self.estimates)

    @property
    def keys(self) -> tuple[str, ...]:
        """Rows of the parameters."""
        return tuple(it.unknown.key for it in self.estimates)

    def __getitem__(self, name: str) -> Estimate:
        """The estimate of a parameter by its row or its symbol.

        Raises:
            KeyError: If it was not asked for.
        """
        return next(it for it in self.estimates if name in {it.unknown.key, TABLE[it.unknown.key].symbol})


def data_of(found: Sequence[Fitted]) -> tuple[Response | BenchRecord, ...]:
    """The sets of data, each once."""
    return tuple({id(it.data): it.data for it in found}.values())
