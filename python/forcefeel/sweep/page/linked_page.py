"""The report of a sweep over linked pairs: ``sweep.html``, ``summary.json`` and ``runs.csv``."""

from importlib.metadata import version
from math import isfinite
from pathlib import Path

import numpy as np

from forcefeel._core import Parameter
from forcefeel.conclusions import capital, interval_text, share_text
from forcefeel.json_values import json_text, json_value
from forcefeel.loader.links import LINK_TABLE
from forcefeel.loader.parameters import TABLE, unit
from forcefeel.page.folder import OutputFolder
from forcefeel.page.palette import COMPENSATED
from forcefeel.page.picture import Picture
from forcefeel.page.render import render
from forcefeel.page.table import Cell, Table, heads, number, words
from forcefeel.page.typography import unit_text
from forcefeel.sweep.findings import correlation_text, number_of
from forcefeel.sweep.linked_result import LINKED_MEASURES, STATUSES, LinkedSweepResult, linked_sweep_conclusions
from forcefeel.sweep.page.plots import histogram
from forcefeel.sweep.summary import QUANTILES
from forcefeel.tables.csv_table import csv_text
from forcefeel.units import Json, UnitSystem, quantity

LINKED_FOLDER = OutputFolder("the sweep", ("sweep.html", "summary.json", "runs.csv"))
"""Files of the report."""

_STRONGEST = 12
"""Most rows of the table of correlations."""


def row_of(key: str) -> Parameter:
    """The row of a loader or a link that a varied key names."""
    of, _, name = key.partition(".")
    return LINK_TABLE[name] if of == "link" else TABLE[name]


def linked_sweep_json(result: LinkedSweepResult, units: UnitSystem) -> dict[str, Json]:
    """Everything but the runs, every number with its unit."""
    sweep = result.sweep
    shown = {
        name: {
            "unit": spread.unit.shown(units),
            "runs": spread.runs,
            **{
                mark: spread.unit.from_si(value, units) if isfinite(value) else None
                for mark, value in (("nominal", spread.nominal), ("lowest", spread.lowest), ("highest", spread.highest))
            },
            "quantiles": {
                f"{share:g}": spread.unit.from_si(value, units)
                for share, value in zip(QUANTILES, spread.quantiles, strict=True)
            },
        }
        for name, spread in result.spreads.items()
    }
    return {
        "forcefeel": version("forcefeel"),
        "units": str(units),
        "project": sweep.project.name,
        "link": sweep.link,
        "between": list(sweep.joint.between),
        "laws": [law.name for law in sweep.designed],
        "runs": sweep.runs,
        "seed": sweep.seed,
        "conclusions": json_value(linked_sweep_conclusions(result, units), units),
        "statuses": [json_value(share, units) for share in result.shares],
        "measures": shown,
        "rank_correlations": {name: dict(result.ranking(name)) for name in result.spreads},
        "significance_level": result.chance,
        "varied": {
            key: {
                "distribution": str(tolerance.distribution),
                "low": quantity(tolerance.low, unit(row_of(key)), units),
                "high": quantity(tolerance.high, unit(row_of(key)), units),
            }
            for key, tolerance in sweep.varied.items()
        },
    }


def linked_sweep_page(result: LinkedSweepResult, units: UnitSystem, *, command: str = "") -> str:
    """The whole page."""
    pictures = []
    for name, spread in result.spreads.items():
        values = result.runs[name].to_numpy()
        title = capital(LINKED_MEASURES[name][0])
        along = f"{title}, {spread.unit.shown(units)}"
        drawn, beyond = histogram(values[np.isfinite(values)], spread, along, units, COMPENSATED)
        remark = f"Not in view: {beyond:,} runs farther out." if beyond else ""
        meaning = f"{spread.runs:,} pairs; nominal {number_of(spread.unit, spread.nominal, units)}."
        pictures.append(Picture.of(f"spread-{name}", title, meaning, drawn, remark))
    return render(
        "sweep/page/linked.html.j2",
        command=command,
        sweep=result.sweep,
        conclusions=linked_sweep_conclusions(result, units),
        statuses=_statuses(result),
        distributions=pictures,
        spreads=_spreads(result, units),
        correlations=_correlations(result),
        tolerances=_tolerances(result, units),
    )


def write_linked_sweep(result: LinkedSweepResult, out: Path, units: UnitSystem, *, command: str = "") -> Path:
    """Write ``sweep.html``, ``summary.json`` and ``runs.csv``, whole or not at all.

    Args:
        result: The sweep.
        out: The folder; made if it is not there.
        units: The units of every number.
        command: The command, for the page.

    Returns:
        The path of the page.

    Raises:
        InputError: If ``out`` is a file, or cannot be made or written.

    Example:
        >>> project = ff.loader.read_project("examples/cockpit/transport-column.toml")
        >>> pushed = ff.linked.LinkedScenario(ff.Scenario(ff.Step("40 lb"), 0.5))
        >>> found = ff.sweep.run_linked_sweep(ff.sweep.LinkedSweep(project, "pitch", pushed, ("robust", "robust"), runs=16))
        >>> ff.sweep.write_linked_sweep(found, Path("pairs"), ff.UnitSystem.US).name
        'sweep.html'
    """
    LINKED_FOLDER.check(out)
    varied = [*result.sweep.varied]
    of = {
        **{key: unit(row_of(key)) for key in varied},
        **{name: spread.unit for name, spread in result.spreads.items()},
    }
    columns = [result.runs[name].to_numpy() * measured.from_si(1.0, units) for name, measured in of.items()]
    status = [STATUSES[k] for k in result.runs["status"].to_numpy()]
    table = [["" if np.isnan(value) else f"{value:.9g}" for value in column.tolist()] for column in columns]
    head = [f"{name} ({measured.shown(units)})".replace(" ()", "") for name, measured in of.items()]
    LINKED_FOLDER.write(
        out,
        {
            "runs.csv": csv_text([*head, "status"], zip(*table, status, strict=True), ""),
            "summary.json": json_text(linked_sweep_json(result, units)),
            "sweep.html": linked_sweep_page(result, units, command=command),
        },
    )
    return out / "sweep.html"


def _statuses(result: LinkedSweepResult) -> Table:
    rows = [
        (
            words(row.status.capitalize()),
            number(f"{row.runs:,}"),
            number(share_text(row.share)),
            number(interval_text(row.low, row.high)),
        )
        for row in result.shares
        if row.runs
    ]
    return Table(heads("Link", "Pairs", "Share", "Of all such pairs, 95 % sure"), tuple(rows))


def _spreads(result: LinkedSweepResult, units: UnitSystem) -> Table:
    rows = []
    for name, spread in result.spreads.items():
        values = (spread.nominal, spread.lowest, *spread.quantiles, spread.highest)
        title = f"{capital(LINKED_MEASURES[name][0])}, {unit_text(spread.unit.shown(units))}"
        rows.append((words(title), *(number(number_of(spread.unit, value, units)) for value in values)))
    marks = (f"{100 * share:g} %" for share in QUANTILES)
    return Table(heads("Measure", "Nominal", "Lowest", *marks, "Highest"), tuple(rows))


def _correlations(result: LinkedSweepResult) -> Table:
    """The rows with the strongest correlation with any measure."""
    table = result.correlations
    strength = np.nan_to_num(np.abs(table.values), nan=0.0).max(axis=0)
    rows = []
    for k in np.argsort(-strength, kind="stable")[:_STRONGEST]:
        cells = (number("–" if np.isnan(rho) else correlation_text(float(rho))) for rho in table.values[:, k])
        rows.append((words(str(table["parameter"].values[k])), *cells))
    return Table(heads("", *(capital(LINKED_MEASURES[str(name)][0]) for name in table["measure"].values)), tuple(rows))


def _tolerances(result: LinkedSweepResult, units: UnitSystem) -> Table:
    rows = []
    for key, tolerance in result.sweep.varied.items():
        measured = unit(row_of(key))
        ends = (number(number_of(measured, value, units)) for value in (tolerance.low, tolerance.high))
        rows.append((words(key), *ends, Cell(unit_text(measured.shown(units))), words(str(tolerance.distribution))))
    return Table(heads("Row", "Lowest", "Highest", "Unit", "Distribution"), tuple(rows))
