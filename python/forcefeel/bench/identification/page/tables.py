"""Tables of an identification: estimates, correlations, residuals, inseparable parameters."""

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
"""Smallest correlation that is not zero to two digits."""

_HASH = 12
"""Displayed characters of a hash."""


def estimates(identification: Identification, units: UnitSystem) -> Table:
    """Every parameter: the file's value, the estimate and its accuracy."""
    numbers = ("Unit", "File", "Estimate", "Change", "Standard error", "of the value", "95 % interval")
    head = (Cell("Parameter"), *(Cell(text, "number") for text in numbers), Cell("Status"))
    return Table(head, tuple(_estimate(estimate, units) for estimate in identification.estimates))


def _estimate(estimate: Estimate, units: UnitSystem) -> tuple[Cell, ...]:
    name, unit = words(parameter_name(estimate.unknown.key)), number_cell(unit_text(unit_of(estimate, units)))
    file = number_cell(_sign(nominal(estimate, units)))
    status = words(str(estimate.status), bad=estimate.status is not Status.DETERMINED)
    if estimate.status is Status.UNDETERMINED:
        return (name, unit, file, number_cell(NOT_DETERMINED, bad=True), *[number_cell(NONE)] * 4, status)
    return (
        name,
        unit,
        file,
        number_cell(_sign(estimated(estimate, estimate.value, units))),
        number_cell(NONE if estimate.unknown.is_phase else percent_text(change(estimate), signed=True)),
        number_cell(error(estimate, units)),
        number_cell(NONE if estimate.unknown.is_phase else _share(relative_error(estimate))),
        number_cell(_sign(interval(estimate, units))),
        status,
    )


def correlations(identification: Identification) -> Table:
    """The correlation of each pair, the stronger the darker."""
    symbols = [symbol_html(TABLE[key].symbol) for key in identification.keys]
    rows = []
    for k, symbol in enumerate(symbols):
        cells = [_correlation(float(value)) for value in identification.correlation[k]]
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


def inseparable(group: Inseparable) -> Table:
    """Direction of inseparable parameters, the largest 1."""
    rows = [
        (words(parameter_name(key)), number_cell(number_text(weight, 2)))
        for key, weight in zip(group.keys, group.weights, strict=True)
    ]
    return Table(heads("Parameter", "Moves by, in shares of its value"), tuple(rows))


def advice(identification: Identification) -> Table:
    """Half the 95 % interval of each parameter with these data, and with each advised experiment."""
    head = heads("Parameter", "These data", *(f"Experiment {k}" for k in range(1, len(identification.advice) + 1)))
    rows = []
    for estimate in identification.estimates:
        shares = [
            estimate.share,
            *(option.shares.get(estimate.unknown.key, math.nan) for option in identification.advice),
        ]
        rows.append((words(parameter_name(estimate.unknown.key)), *(number_cell(_half(share)) for share in shares)))
    return Table(head, tuple(rows))


def rigid(test: RigidTest) -> Table:
    """The two models of the link side by side."""
    rows = (
        (
            words("Residual relative error, root mean square"),
            *map(_percent_cell, (test.rigid_rms, test.compliant_rms)),
        ),
        (words("F and its degrees of freedom"), number_cell(_statistic(test)), number_cell(NONE)),
        (
            words("Probability if the link is rigid"),
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


def data(identification: Identification, units: UnitSystem) -> Table:
    """Every data set, with the residual of the fit."""
    head = (
        *(Cell(text, "words") for text in ("Data", "Experiment", "Content")),
        *(Cell(text, "number") for text in ("Points", "Span", "Residual, r.m.s.", "Noise")),
        Cell("SHA-256"),
    )
    return Table(head, tuple(_data(fitted, units) for fitted in identification.fitted))


def _data(fitted: Fitted, units: UnitSystem) -> tuple[Cell, ...]:
    measurement = fitted.data
    low, high = float(fitted.at[0]), float(fitted.at[-1])
    if isinstance(measurement, Response):
        quantity = f"{measurement.output} over {measurement.input}"
        span = f"{to_text(low, 3)} to {to_text(high, 3)} Hz"
    else:
        quantity, span = fitted.channel, f"{to_text(high - low, 3)} s"
    return (
        words(measurement.name),
        words(str(measurement.experiment).replace("_", " ")),
        words(quantity.replace("_", " ")),
        number_cell(f"{len(fitted.at):,}"),
        number_cell(span),
        number_cell(_quantity(size_text(fitted, fitted.residual_rms, units)), bad=beyond_noise(fitted)),
        number_cell(_quantity(size_text(fitted, fitted.noise, units))),
        Cell(measurement.data_hash[:_HASH] or NONE),
    )


def ends(identification: Identification, units: UnitSystem) -> Table:
    """End of each start of the search, without undetermined parameters."""
    determined = [
        (k, estimate)
        for k, estimate in enumerate(identification.estimates)
        if estimate.status is not Status.UNDETERMINED
    ]
    names = [_heading(estimate, units) for _, estimate in determined]
    rows = []
    for k, end in enumerate(identification.ends, start=1):
        values = [number_cell(_sign(estimated(estimate, float(end.end[i]), units))) for i, estimate in determined]
        relative_cost = number_text(worse(identification, end), 4)
        rows.append(
            (Cell(str(k)), *values, number_cell(relative_cost), words("yes" if end.same else "no", bad=not end.same))
        )
    numbers = (*names, "Residual, relative to the best")
    return Table((Cell("Start"), *(Cell(text, "number") for text in numbers), Cell("The same place")), tuple(rows))


def settings(fit_settings: FitSettings) -> Table:
    """How the fit was made."""
    rows = (
        ("Loss of large residuals", fit_settings.loss),
        ("Starts of the search", str(fit_settings.starts)),
        ("Normal tolerances of the file as priors", "yes" if fit_settings.priors else "no"),
        ("Records converted into frequency responses first", "yes" if fit_settings.as_responses else "no"),
        ("Law of the whole loader", fit_settings.law),
    )
    return Table((Cell("Setting"), Cell("Value")), tuple((words(name), Cell(value)) for name, value in rows))


def glance(identification: Identification) -> Sequence[tuple[str, str]]:
    """Names and values of the key numbers."""
    determined = [estimate for estimate in identification.estimates if estimate.status is not Status.UNDETERMINED]
    same = sum(end.same for end in identification.ends)
    errors = [relative_error(estimate) for estimate in determined if estimate.value and not estimate.unknown.is_phase]
    return (
        ("parameters determined", f"{len(determined)} of {len(identification.estimates)}"),
        ("largest standard error", _share(max(errors)) if errors else NONE),
        ("points of data", f"{sum(len(fitted.at) for fitted in identification.fitted):,}"),
        ("starts that ended at the best optimum", f"{same} of {len(identification.ends)}"),
    )


def _statistic(test: RigidTest) -> str:
    return f"F({test.degrees[0]}, {test.degrees[1]}) = {number_text(test.f_statistic, 3)}"


def _heading(estimate: Estimate, units: UnitSystem) -> Markup:
    symbol, unit = symbol_html(estimate.unknown.symbol), unit_text(unit_of(estimate, units))
    return Markup("{}, {}").format(symbol, unit) if unit else symbol


def _percent_cell(share: float) -> Cell:
    return number_cell(_share(share))


def _share(share: float) -> str:
    return percent(share) if math.isfinite(share) else NONE


def _half(share: float) -> str:
    """Half an interval in percent; without a number from the size of the value on."""
    if math.isnan(share):
        return NONE
    return f"±{percent(share)}" if share < _SAYS_NOTHING else "nothing"


_SAYS_NOTHING = 10.0
"""Half an interval relative to the value from which on no number is shown."""


def _quantity(text: str) -> str:
    """``-0.012 lb in`` with its sign and its unit set."""
    value, _, unit = text.partition(" ")
    return f"{_sign(value)} {unit_text(unit)}"


def _sign(text: str) -> str:
    return text.replace("-", _MINUS)
