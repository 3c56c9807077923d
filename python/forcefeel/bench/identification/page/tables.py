"""The tables of an identification: estimates, correlations, what is left of the data, what cannot be told apart."""

import math
from collections.abc import Sequence

from markupsafe import Markup

from forcefeel.bench.identification.as_json import FitSettings
from forcefeel.bench.identification.digits import (
    NOT_DETERMINED,
    error,
    estimated,
    interval,
    nominal,
    percent,
    relative_error,
    unit_of,
)
from forcefeel.bench.identification.findings import change, probability_text, worse
from forcefeel.bench.identification.misfit import beyond_noise, size_text
from forcefeel.bench.identification.result import Estimate, Fitted, Identification, Inseparable, RigidTest, Status
from forcefeel.bench.responses import Response
from forcefeel.loader.parameters import TABLE
from forcefeel.page.table import Cell, Table, heads, words
from forcefeel.page.table import number as number_cell
from forcefeel.page.typography import NONE, number_text, parameter_name, percent_text, symbol_html, unit_text
from forcefeel.units import UnitSystem, to_text

_MINUS = "\N{MINUS SIGN}"
_WHITE, _AGAINST, _TOGETHER = (255, 255, 255), (240, 140, 60), (86, 160, 211)
_SHOWN = 0.005
"""A smaller correlation is none to two digits."""

_HASH = 12
"""Characters of a hash that are enough to know a file by."""


def estimates(found: Identification, units: UnitSystem) -> Table:
    """Every parameter: the file's value, the estimate, how sure it is."""
    numbers = ("Unit", "File", "Estimate", "Change", "Standard error", "of the value", "95 % interval")
    head = (Cell("Parameter"), *(Cell(text, "number") for text in numbers), Cell("Status"))
    return Table(head, tuple(_estimate(one, units) for one in found.estimates))


def _estimate(one: Estimate, units: UnitSystem) -> tuple[Cell, ...]:
    name, unit = words(parameter_name(one.unknown.key)), number_cell(unit_text(unit_of(one, units)))
    file = number_cell(_sign(nominal(one, units)))
    status = words(str(one.status), bad=one.status is not Status.DETERMINED)
    if one.status is Status.UNDETERMINED:
        return (name, unit, file, number_cell(NOT_DETERMINED, bad=True), *[number_cell(NONE)] * 4, status)
    return (
        name,
        unit,
        file,
        number_cell(_sign(estimated(one, one.value, units))),
        number_cell(NONE if one.unknown.is_phase else percent_text(change(one), signed=True)),
        number_cell(error(one, units)),
        number_cell(NONE if one.unknown.is_phase else _share(relative_error(one))),
        number_cell(_sign(interval(one, units))),
        status,
    )


def correlations(found: Identification) -> Table:
    """The correlation of each pair, the stronger the darker."""
    symbols = [symbol_html(TABLE[key].symbol) for key in found.keys]
    rows = []
    for k, symbol in enumerate(symbols):
        cells = [_correlation(float(value)) for value in found.correlation[k]]
        cells[k] = number_cell("1")
        rows.append((Cell(symbol), *cells))
    return Table((Cell(""), *(Cell(symbol, "number") for symbol in symbols)), tuple(rows), "heat")


def _correlation(value: float) -> Cell:
    if not math.isfinite(value):
        return number_cell(NONE)
    hue, share = (_TOGETHER if value > 0 else _AGAINST), min(abs(value), 1.0) ** 2
    mixed = (round(low + share * (high - low)) for low, high in zip(_WHITE, hue, strict=True))
    text = f"{value:+.2f}" if abs(value) >= _SHOWN else "0"
    return Cell(_sign(text), "number", "#" + "".join(f"{part:02X}" for part in mixed))


def inseparable(one: Inseparable) -> Table:
    """How parameters that cannot be told apart move together, the largest 1."""
    rows = [
        (words(parameter_name(key)), number_cell(number_text(weight, 2)))
        for key, weight in zip(one.keys, one.weights, strict=True)
    ]
    return Table(heads("Parameter", "Moves by, in shares of its value"), tuple(rows))


def advice(found: Identification) -> Table:
    """Half the 95 % interval of each parameter with the data as they are, and with each experiment that is advised."""
    head = heads("Parameter", "These data", *(f"Experiment {k}" for k in range(1, len(found.advice) + 1)))
    rows = []
    for one in found.estimates:
        shares = [one.share, *(it.shares.get(one.unknown.key, math.nan) for it in found.advice)]
        rows.append((words(parameter_name(one.unknown.key)), *(number_cell(_half(share)) for share in shares)))
    return Table(head, tuple(rows))


def rigid(test: RigidTest) -> Table:
    """The two models of the link side by side."""
    rows = (
        (
            words("Relative error that is left, root mean square"),
            *map(_percent_cell, (test.rigid_rms, test.compliant_rms)),
        ),
        (words("F and its degrees of freedom"), number_cell(_statistic(test)), number_cell(NONE)),
        (
            words("Probability, were the link rigid"),
            number_cell(probability_text(test).removeprefix("p ").removeprefix("= ")),
            number_cell(NONE),
        ),
        (
            words("Bayesian information criterion, above the other's"),
            number_cell(number_text(test.bic_difference, 3)),
            number_cell("0"),
        ),
    )
    return Table(heads("", "Rigid link", "Compliant link"), rows)


def data(found: Identification, units: UnitSystem) -> Table:
    """Every set of data: what it is, and what the fit leaves of it."""
    head = (
        *(Cell(text, "words") for text in ("Data", "Experiment", "Content")),
        *(Cell(text, "number") for text in ("Points", "Span", "Residual, r.m.s.", "Noise")),
        Cell("SHA-256"),
    )
    return Table(head, tuple(_data(one, units) for one in found.fitted))


def _data(one: Fitted, units: UnitSystem) -> tuple[Cell, ...]:
    given = one.data
    low, high = float(one.at[0]), float(one.at[-1])
    if isinstance(given, Response):
        what = f"{given.output} over {given.input}"
        span = f"{to_text(low, 3)} to {to_text(high, 3)} Hz"
    else:
        what, span = one.channel, f"{to_text(high - low, 3)} s"
    return (
        words(given.name),
        words(str(given.experiment).replace("_", " ")),
        words(what.replace("_", " ")),
        number_cell(f"{len(one.at):,}"),
        number_cell(span),
        number_cell(_quantity(size_text(one, one.residual_rms, units)), bad=beyond_noise(one)),
        number_cell(_quantity(size_text(one, one.noise, units))),
        Cell(given.data_hash[:_HASH] or NONE),
    )


def ends(found: Identification, units: UnitSystem) -> Table:
    """Where each start of the search ended; of a parameter that is not determined there is nothing to show."""
    shown = [(k, one) for k, one in enumerate(found.estimates) if one.status is not Status.UNDETERMINED]
    names = [_heading(one, units) for _, one in shown]
    rows = []
    for k, end in enumerate(found.ends, start=1):
        values = [number_cell(_sign(estimated(one, float(end.end[i]), units))) for i, one in shown]
        left = number_text(worse(found, end), 4)
        rows.append((Cell(str(k)), *values, number_cell(left), words("yes" if end.same else "no", bad=not end.same)))
    numbers = (*names, "Residual, relative to the best")
    return Table((Cell("Start"), *(Cell(text, "number") for text in numbers), Cell("The same place")), tuple(rows))


def settings(given: FitSettings) -> Table:
    """How the fit was made."""
    rows = (
        ("Loss of large residuals", given.loss),
        ("Starts of the search", str(given.starts)),
        ("Normal tolerances of the file as priors", "yes" if given.priors else "no"),
        ("Records turned into frequency responses first", "yes" if given.as_responses else "no"),
        ("Law of the whole loader", given.law),
    )
    return Table((Cell("Setting"), Cell("Value")), tuple((words(name), Cell(value)) for name, value in rows))


def glance(found: Identification) -> Sequence[tuple[str, str]]:
    """The few numbers to see first: what they are, and they."""
    known = [one for one in found.estimates if one.status is not Status.UNDETERMINED]
    same = sum(end.same for end in found.ends)
    errors = [relative_error(one) for one in known if one.value and not one.unknown.is_phase]
    return (
        ("parameters determined", f"{len(known)} of {len(found.estimates)}"),
        ("largest standard error", _share(max(errors)) if errors else NONE),
        ("points of data", f"{sum(len(one.at) for one in found.fitted):,}"),
        ("starts that ended in the same place", f"{same} of {len(found.ends)}"),
    )


def _statistic(test: RigidTest) -> str:
    return f"F({test.degrees[0]}, {test.degrees[1]}) = {number_text(test.f_statistic, 3)}"


def _heading(one: Estimate, units: UnitSystem) -> Markup:
    symbol, unit = symbol_html(one.unknown.symbol), unit_text(unit_of(one, units))
    return Markup("{}, {}").format(symbol, unit) if unit else symbol


def _percent_cell(share: float) -> Cell:
    return number_cell(_share(share))


def _share(share: float) -> str:
    return percent(share) if math.isfinite(share) else NONE


def _half(share: float) -> str:
    """Half an interval in percent; one of the value's own size or more says nothing."""
    if math.isnan(share):
        return NONE
    return f"±{percent(share)}" if share < _SAYS_NOTHING else "nothing"


_SAYS_NOTHING = 10.0
"""Half an interval, of the value: so wide that a number for it would only confuse."""


def _quantity(text: str) -> str:
    """``-0.012 lb in`` with its sign and its unit set."""
    value, _, unit = text.partition(" ")
    return f"{_sign(value)} {unit_text(unit)}"


def _sign(text: str) -> str:
    return text.replace("-", _MINUS)
