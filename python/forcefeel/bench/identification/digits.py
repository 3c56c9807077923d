"""Format of the numbers of an identification: digits by the standard error, channels in display units."""

import math

from forcefeel.bench.channels import channel_unit
from forcefeel.bench.identification.result import Estimate, Fitted
from forcefeel.bench.responses import Response
from forcefeel.loader.parameters import TABLE, unit
from forcefeel.units import Unit, UnitSystem, to_text

NOT_DETERMINED = "not determined"
"""Placeholder of an undetermined estimate."""

_FEWEST, _MOST = 3, 4
"""Significant digits of an estimate."""

_MOST_DECIMALS, _LARGE = 9, 1e7
"""Range outside of which an interval is written with powers of ten."""


def gain_unit(response: Response, units: UnitSystem) -> tuple[str, float]:
    """The unit of a response's gain, such as ``deg/V``, and how many of it one of the SI unit is."""
    source, target = channel_unit(response.input), channel_unit(response.output)
    return f"{target.shown(units)}/{source.shown(units)}", target.from_si(1.0, units) / source.from_si(1.0, units)


def title_of(fitted: Fitted) -> str:
    """Title of a data set: the file's name and the channel."""
    data = fitted.data
    if isinstance(data, Response):
        # A response that was estimated from a record has its channels in its name.
        named = data.output in data.name
        return data.name if named else f"{data.name}, {_words(data.output)} over {_words(data.input)}"
    return f"{data.name}, {_words(fitted.channel)}"


def digits_of(value: float, deviation: float) -> int:
    """Significant digits of a value that leave two of its standard error, but three at least and four at most.

    ``floor(lg |value|) - floor(lg deviation) + 2``.
    """
    if not (value and deviation > 0 and math.isfinite(value) and math.isfinite(deviation)):
        return _MOST
    needed = math.floor(math.log10(abs(value))) - math.floor(math.log10(deviation)) + 2
    return max(_FEWEST, min(_MOST, needed))


def nominal(estimate: Estimate, units: UnitSystem) -> str:
    """The file's value, without its unit."""
    return to_text(_unit(estimate).from_si(estimate.unknown.nominal, units), _MOST)


def estimated(estimate: Estimate, value: float, units: UnitSystem) -> str:
    """A value that the search found, with the digits that the standard error leaves, without its unit."""
    return rounded(_unit(estimate).from_si(value, units), digits_of(value, estimate.deviation))


def interval(estimate: Estimate, units: UnitSystem) -> str:
    """The 95 % interval, its ends with the decimals that show two digits of the standard error, without its unit."""
    deviation, low, high = (
        _unit(estimate).from_si(value, units) for value in (estimate.deviation, estimate.low, estimate.high)
    )
    decimals = 1 - math.floor(math.log10(deviation)) if deviation > 0 and math.isfinite(deviation) else 0
    if 0 <= decimals <= _MOST_DECIMALS and max(abs(low), abs(high)) < _LARGE:
        return f"{low:.{decimals}f} to {high:.{decimals}f}"
    return f"{to_text(low, _MOST)} to {to_text(high, _MOST)}"


def error(estimate: Estimate, units: UnitSystem) -> str:
    """The standard error, two digits, without its unit."""
    return rounded(_unit(estimate).from_si(estimate.deviation, units), 2)


def percent(share: float) -> str:
    """A share in percent, two digits."""
    return f"{rounded(100 * share, 2)} %" if math.isfinite(share) else "infinitely many %"


def relative_error(estimate: Estimate) -> float:
    """The standard error as a share of the value, of a phase in rad; infinite for a value of zero."""
    if estimate.unknown.is_phase:
        return estimate.deviation
    return estimate.deviation / abs(estimate.value) if estimate.value else math.inf


def unit_of(estimate: Estimate, units: UnitSystem) -> str:
    """The unit of the parameter."""
    return _unit(estimate).shown(units)


def rounded(value: float, digits: int) -> str:
    """``value`` with so many significant digits, zeros at the end among them; powers of ten as ``to_text`` has them."""
    text = to_text(value, digits)
    if "e" in text or not math.isfinite(value) or value == 0:
        return text
    magnitude = math.floor(math.log10(abs(float(text))))
    return f"{value:.{max(digits - 1 - magnitude, 0)}f}"


def _words(channel: str) -> str:
    return channel.replace("_", " ")


def _unit(estimate: Estimate) -> Unit:
    return unit(TABLE[estimate.unknown.key])
