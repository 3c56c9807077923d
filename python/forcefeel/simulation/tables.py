"""A run for machines and tables: its measures with names people read, its history in units, all of it as plain data."""

import re
from dataclasses import dataclass
from importlib.metadata import version
from math import isfinite
from typing import Any, get_type_hints

import numpy as np
from numpy.typing import NDArray

from forcefeel.conclusions import of_result
from forcefeel.json_values import json_value
from forcefeel.simulation import Run
from forcefeel.simulation.findings import input_text, run_conclusions
from forcefeel.simulation.limits_met import known_measures, limit_times, why_no_overshoot
from forcefeel.simulation.outcome import in_words
from forcefeel.units import BY_SI, MOTOR_CURRENT, PERCENT, Json, UnitSystem, to_text

NAMES = {
    "maximum_angle_rad": "largest column angle",
    "time_of_maximum_s": "time of the largest",
    "minimum_angle_rad": "smallest column angle",
    "time_of_minimum_s": "time of the smallest",
    "final_angle_rad": "final angle (mean over the last tenth)",
    "equilibrium_angle_rad": "equilibrium angle (dry friction aside)",
    "overshoot": "overshoot",
    "settling_time_s": "within 5 % from",
    "period_s": "period",
    "periods": "periods that it is the mean of",
    "last_swing_rad": "oscillation in the last tenth",
    "peak_current_a": "largest current",
    "peak_pressure_pa": "largest load pressure",
    "peak_flow_m3_per_s": "largest flow",
    "peak_voltage_v": "largest voltage",
    "peak_speed_rad_per_s": "largest speed of the motor",
    "diverged_at_s": "diverged at",
}
"""Each measure in words."""


@dataclass(frozen=True)
class Column:
    """One quantity of a history.

    Attributes:
        name: In words, ``column angle``.
        unit: Of the values.
        values: One per sample.
    """

    name: str
    unit: str
    values: NDArray[np.float64]


@of_result
def measure_rows(run: Run, units: UnitSystem, digits: int = 4) -> tuple[tuple[str, str, str], ...]:
    """Name, value and unit of each measure that there is; a dash for an overshoot that there cannot be, and why."""
    measures, hints = known_measures(run), get_type_hints(type(run.measures), include_extras=True)
    rows = []
    for key, name in NAMES.items():
        if key not in hints:
            continue  # of another drive
        value, measured_in = getattr(measures, key), hints[key].__metadata__[0]
        if key == "overshoot" and (why := why_no_overshoot(run)):
            rows.append((f"{name} ({why})", "–", ""))
        if not isfinite(value):
            continue
        if key == "overshoot":
            measured_in = PERCENT
        rows.append((name, to_text(measured_in.from_si(value, units), digits), measured_in.shown(units)))
    return tuple(rows)


def columns(run: Run, units: UnitSystem) -> tuple[Column, ...]:
    """Time and every output, up to where the run diverged, by the names that readers of records know."""
    known = np.isfinite(run.outputs["column_angle_rad"])
    table = []
    for name in ("time_s", *run.outputs):
        unit = MOTOR_CURRENT if name == "motor_current_a" else BY_SI[run.outputs.unit(name)]
        table.append(
            Column(in_words(name, unit.si), unit.shown(units), run.outputs[name][known] * unit.from_si(1.0, units))
        )
    return tuple(table)


def run_json(run: Run, units: UnitSystem, law: str) -> dict[str, Json]:
    """Everything about a run but its history, every number with its unit."""
    force = run.scenario.force
    scenario = dict(_dict_json(run.scenario, units))
    scenario["force"] = {
        "kind": re.sub("(?<!^)(?=[A-Z])", "-", type(force).__name__).lower(),  # as --input has it: stop-to-stop
        "words": input_text(force, units),
        **_dict_json(force, units),
    }
    return {
        "forcefeel": version("forcefeel"),
        "units": str(units),
        "status": str(run.status),
        "conclusions": json_value(run_conclusions(run, units), units),
        "softened": json_value(run.softened, units),
        "measures": json_value(known_measures(run), units),
        "limits": json_value(limit_times(run), units),
        "method": run.method,
        "law": law,
        "scenario": scenario,
        "loader": json_value(run.loader, units),
    }


def _dict_json(result: Any, units: UnitSystem) -> dict[str, Json]:
    document = json_value(result, units)
    return document if isinstance(document, dict) else {}
