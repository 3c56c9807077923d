"""The loader file of an identification."""

from dataclasses import replace

from forcefeel.bench.identification.result import Identification, data_of
from forcefeel.bench.records import BenchRecord
from forcefeel.bench.responses import Response
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import TABLE, limits_si
from forcefeel.loader.tolerances import Distribution, Tolerance
from forcefeel.printable import visible

_CUT_AT = 3.0
"""Standard errors at which a tolerance is truncated: 99.7 % of normal errors."""

_SUREST = 1e-6
"""Smallest stated standard error, as a share of the value: data without noise come from a model."""


def fitted_loader(identification: Identification) -> Loader:
    """The loader with the estimates in place of the file's values.

    Each has a normal tolerance of its standard error, for envelopes, sweeps and the next identification.
    The source names the data by their SHA-256.
    """
    values = {estimate.unknown.key: estimate.value for estimate in identification.estimates}
    without = identification.before.with_tolerances(dict.fromkeys(values)).replace(values, si=True)
    loader = without.with_tolerances(
        {
            estimate.unknown.key: normal_about(estimate.unknown.key, estimate.value, estimate.deviation)
            for estimate in identification.estimates
        }
    )
    symbols = ", ".join(estimate.unknown.symbol for estimate in identification.estimates)
    data = "; ".join(_named(measurement) for measurement in data_of(identification.fitted))
    return replace(loader, source=f"{identification.before.source}; {symbols} identified from {data}".lstrip("; "))


def normal_about(key: str, value: float, deviation: float) -> Tolerance:
    """The tolerance of an identified parameter: normal, truncated to the table's range.

    Args:
        key: Of the parameter.
        value: Estimate, SI units.
        deviation: Standard error, SI units; at least the smallest stated one.
    """
    low, high = limits_si(TABLE[key])
    deviation = max(deviation, _SUREST * abs(value))
    low, high = max(low, value - _CUT_AT * deviation), min(high, value + _CUT_AT * deviation)
    return Tolerance(Distribution.NORMAL, low, high, peak=value, deviation=deviation, nominal=value)


def _named(data: Response | BenchRecord) -> str:
    name = visible(data.name)
    return f"{name} (SHA-256 {data.data_hash})" if data.data_hash else name
