"""A sweep as plain data for JSON: its summary, with units."""

from importlib.metadata import version
from math import isfinite

import numpy as np

from forcefeel.json_values import json_value
from forcefeel.laws.law import ORIGINAL
from forcefeel.loader.parameters import TABLE, unit
from forcefeel.simulation.findings import input_text
from forcefeel.sweep.findings import sweep_conclusions
from forcefeel.sweep.plan import Sweep
from forcefeel.sweep.result import SweepResult
from forcefeel.sweep.summary import QUANTILES, Spread, Summary
from forcefeel.units import Json, UnitSystem, quantity


def sweep_json(result: SweepResult, summary: Summary, units: UnitSystem) -> dict[str, Json]:
    """Summary of the runs, and the plan of the sweep."""
    sweep = result.sweep
    return {
        "forcefeel": version("forcefeel"),
        "units": str(units),
        "loader": sweep.loader.name,
        "input": input_text(sweep.scenario.force, units),
        "runs": sweep.total,
        "machines_at_each_point": sweep.machines,
        "seed": sweep.seed,
        "law": whose_law(sweep),
        "conclusions": json_value(sweep_conclusions(result, summary, units), units),
        "statuses": [_without_unknown(json_value(share, units)) for share in summary.shares],
        "measures": {name: _spread(spread, units) for name, spread in summary.spreads.items() if spread.runs},
        "rank_correlations": _correlations(summary),
        "significance_level": summary.chance,
        "varied": {
            key: {
                "distribution": str(tolerance.distribution),
                "low": quantity(tolerance.low, unit(TABLE[key]), units),
                "high": quantity(tolerance.high, unit(TABLE[key]), units),
            }
            for key, tolerance in sweep.varied.items()
        },
        "grid": {
            key: {
                "unit": unit(TABLE[key]).shown(units),
                "values": [unit(TABLE[key]).from_si(value, units) for value in values],
            }
            for key, values in sweep.axes.items()
        },
    }


def whose_law(sweep: Sweep) -> str:
    """Assignment of laws to machines."""
    if sweep.redesigned:
        return "designed anew for each setting of the feel"
    return "by each machine's own parameters" if sweep.nominal_law.numbers.kind == ORIGINAL else "one for all machines"


def _without_unknown(share: Json) -> Json:
    """The share without the interval if the runs are no random sample."""
    if not isinstance(share, dict):
        return share
    return {
        key: value
        for key, value in share.items()
        if not isinstance(value, dict) or isinstance(value["value"], int | float)
    }


def _spread(spread: Spread, units: UnitSystem) -> dict[str, Json]:
    measured_in = spread.unit

    def converted(value: float) -> float | None:
        return measured_in.from_si(value, units) if isfinite(value) else None

    return {
        "unit": measured_in.shown(units),
        "runs": spread.runs,
        "nominal": converted(spread.nominal),
        "lowest": converted(spread.lowest),
        "highest": converted(spread.highest),
        "quantiles": {f"{share:g}": converted(value) for share, value in zip(QUANTILES, spread.quantiles, strict=True)},
    }


def _correlations(summary: Summary) -> dict[str, Json]:
    """Correlations of each measure that has any."""
    table = summary.correlations
    return {
        str(name): {
            str(key): float(rho) for key, rho in zip(table["parameter"].values, row, strict=True) if np.isfinite(rho)
        }
        for name, row in zip(table["measure"].values, table.values, strict=True)
        if np.isfinite(row).any()
    }
