"""Tables of a sweep: status, spread and correlations of the measures, varied parameters."""

from math import isfinite

import numpy as np

from forcefeel.conclusions import interval_text, share_text
from forcefeel.loader.parameters import TABLE, unit
from forcefeel.loader.tolerances import Distribution, Tolerance
from forcefeel.page.table import Cell, Table, heads, number, words
from forcefeel.page.typography import NONE, change_text, number_text, parameter_name, quantity_text, unit_text
from forcefeel.simulation import RunStatus
from forcefeel.sweep import SweepResult
from forcefeel.sweep.findings import correlation_text, number_of
from forcefeel.sweep.page.plots import axis_title, title
from forcefeel.sweep.result import IMPOSSIBLE
from forcefeel.sweep.summary import QUANTILES, Summary
from forcefeel.units import UnitSystem

_WARM, _COLD = (240, 140, 60), (70, 140, 200)
_MEANINGS = {
    "settled": "the last oscillation is within 5 % of the total motion",
    "moving": "still oscillates or drifts at the end of the run",
    "diverged": "left every bound: unstable",
    "impossible": "values contradict each other; not run",
}


def statuses(summary: Summary) -> Table:
    """Status of the runs, with confidence intervals of a random sample."""
    shares = [share for share in summary.shares if share.runs or share.status != IMPOSSIBLE]
    sure = any(isfinite(share.low) for share in shares)
    rows = []
    for row in shares:
        interval = number(interval_text(row.low, row.high))
        count = number(f"{row.runs:,}", bad=row.status == RunStatus.DIVERGED and row.runs > 0)
        cells = (words(row.status.capitalize()), count, number(share_text(row.share)), *([interval] if sure else []))
        rows.append((*cells, words(_MEANINGS[row.status])))
    heading = ["Of all such loaders, 95 % sure"] if sure else []
    return Table((*heads("Status", "Runs", "Share", *heading), Cell("Meaning")), tuple(rows))


def spreads(summary: Summary, measures: tuple[str, ...], system: UnitSystem) -> Table:
    """Quantiles of each measure."""
    rows = []
    for name in measures:
        spread = summary.spreads[name]
        values = (spread.nominal, spread.lowest, *spread.quantiles, spread.highest)
        cells = (number(number_of(spread.unit, value, system)) for value in values)
        rows.append((words(axis_title(name, spread.unit, system)), *cells))
    marks = (f"{100 * share:g} %" for share in QUANTILES)
    return Table(heads("Measure", "Nominal", "Lowest", *marks, "Highest"), tuple(rows))


def correlations(summary: Summary, measures: tuple[str, ...], system: UnitSystem) -> Table:
    """Rank correlations: the stronger, the darker the cell; those within chance are pale."""
    table = summary.correlations.sel(measure=list(measures))
    strength = np.nan_to_num(np.abs(table.values)).max(axis=0)
    order = np.argsort(-strength, kind="stable")
    rows = []
    for k in order:
        key = str(table["parameter"].values[k])
        rows.append(
            (words(parameter_name(key)), *(_correlation(float(rho), summary.chance) for rho in table.values[:, k]))
        )
    titles = map(title, measures)
    return Table(heads("", *titles), tuple(rows), "heat")


def _correlation(rho: float, chance: float) -> Cell:
    if not isfinite(rho):
        return number(NONE)
    text = correlation_text(rho)
    if abs(rho) <= chance:
        return Cell(text, "number faint")
    toward = _WARM if rho > 0 else _COLD
    mixed = (round(255 + min(abs(rho), 1.0) * (channel - 255)) for channel in toward)
    return Cell(text, "number", "#" + "".join(f"{channel:02X}" for channel in mixed))


def tolerances(result: SweepResult, system: UnitSystem) -> Table:
    """Drawn parameters: distribution, bounds and source."""
    rows = []
    for key, tolerance in result.sweep.varied.items():
        rows.append(
            (
                *_span(result, key, (tolerance.low, tolerance.high), system),
                words(_distribution(tolerance, key, system)),
                words("this sweep" if key in result.sweep.vary else "loader file"),
            )
        )
    kinds = {"Nominal": "number", "From": "number", "To": "number"}
    names = ("Parameter", "Nominal", "From", "To", "Unit", "Distribution", "Source")
    return Table(tuple(Cell(name, kinds.get(name, "")) for name in names), tuple(rows))


def grid(result: SweepResult, system: UnitSystem) -> Table:
    """The settings of the grid."""
    rows = [
        (*_span(result, key, (values[0], values[-1]), system), number(str(len(values))))
        for key, values in result.sweep.axes.items()
    ]
    return Table(
        (
            Cell("Setting"),
            Cell("The loader's", "number"),
            Cell("From", "number"),
            Cell("To", "number"),
            Cell("Unit"),
            Cell("Values", "number"),
        ),
        tuple(rows),
    )


def _span(result: SweepResult, key: str, ends: tuple[float, float], system: UnitSystem) -> tuple[Cell, ...]:
    """A parameter, the loader's value, its range, the unit."""
    measured_in = unit(TABLE[key])
    values = (
        number_text(measured_in.from_si(value, system)) if isfinite(value) else "none"
        for value in (result.sweep.loader[key], *ends)
    )
    return words(parameter_name(key)), *map(number, values), Cell(unit_text(measured_in.shown(system)))


def _distribution(tolerance: Tolerance, key: str, system: UnitSystem) -> str:
    """The distribution with its peak and standard deviation, and the bounds as shares where they are such."""
    text = str(tolerance.distribution)
    measured_in = unit(TABLE[key])
    if tolerance.nominal is not None:
        low, high = ((bound - tolerance.nominal) / abs(tolerance.nominal) for bound in (tolerance.low, tolerance.high))
        same = abs(low + high) < 1e-9
        text += f", ±{change_text(high).removeprefix('+')}" if same else f", {change_text(low)} to {change_text(high)}"
    if tolerance.distribution is Distribution.NORMAL and tolerance.deviation is not None:
        text += f", σ = {quantity_text(tolerance.deviation, measured_in, system, 3)}"
    if tolerance.peak is not None and tolerance.peak != tolerance.nominal:
        text += f", most at {quantity_text(tolerance.peak, measured_in, system, 3)}"
    return text
