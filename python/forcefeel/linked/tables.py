"""A run of two linked loaders for machines and tables."""

from importlib.metadata import version
from math import isfinite
from typing import get_type_hints

from forcefeel.json_values import json_value
from forcefeel.linked.findings import hands_text, linked_conclusions
from forcefeel.linked.result import SIDES, LinkedRun
from forcefeel.loader.links import LINK_TABLE
from forcefeel.loader.parameters import unit
from forcefeel.simulation.outcome import in_words
from forcefeel.simulation.tables import Column
from forcefeel.units import BY_SI, MOTOR_CURRENT, TORQUE, Json, UnitSystem, quantity, to_text

NAMES = {
    "peak_link_torque_n_m": "largest torque of the link",
    "peak_link_force_n": "peak link force at the first grip",
    "peak_force_fight_n": "force fight of the hands",
    "largest_difference_rad": "largest position difference",
    "final_difference_rad": "position difference at the end (mean over the last tenth)",
    "first_final_angle_rad": "first column, final angle (mean over the last tenth)",
    "second_final_angle_rad": "second column, final angle (mean over the last tenth)",
    "first_priority_s": "priority of the first pilot",
    "second_priority_s": "priority of the second pilot",
    "dual_input_s": "dual input",
    "gave_way_at_s": "link gives way at",
    "diverged_at_s": "diverged at",
}
"""Each measure in words."""

_UNLESS_ZERO = ("first_priority_s", "second_priority_s", "dual_input_s")
"""Measures that most links do not have."""


def measure_rows(run: LinkedRun, units: UnitSystem) -> tuple[tuple[str, str, str], ...]:
    """Name, value and unit of each measure that there is."""
    hints, rows = get_type_hints(type(run.measures), include_extras=True), []
    for key, name in NAMES.items():
        value, measured_in = getattr(run.measures, key), hints[key].__metadata__[0]
        if isfinite(value) and (value or key not in _UNLESS_ZERO):
            rows.append((name, to_text(measured_in.from_si(value, units), 4), measured_in.shown(units)))
    return tuple(rows)


def columns(run: LinkedRun, units: UnitSystem) -> tuple[Column, ...]:
    """Time and every output of both sides and of the link."""
    table = []
    for name in ("time_s", *run.outputs):
        measured_in = TORQUE if name.endswith("_n_m") else BY_SI[run.outputs.unit(name)]
        if name.endswith("motor_current_a"):
            measured_in = MOTOR_CURRENT
        text = name.removesuffix("_n_m").replace("_", " ") if measured_in is TORQUE else in_words(name, measured_in.si)
        table.append(Column(text, measured_in.shown(units), run.outputs[name] * measured_in.from_si(1.0, units)))
    return tuple(table)


def linked_json(run: LinkedRun, units: UnitSystem) -> dict[str, Json]:
    """Everything about a run but its history, every number with its unit."""
    link = run.link
    rows = {name: quantity(link[name], unit(row), units) for name, row in LINK_TABLE.items()}
    return {
        "forcefeel": version("forcefeel"),
        "units": str(units),
        "status": "diverged" if run.diverged else "done",
        "conclusions": json_value(linked_conclusions(run, units), units),
        "measures": json_value(run.measures, units),
        "hands": hands_text(run, units),
        "link": {
            "name": link.name,
            "between": list(link.between),
            "kind": str(link.kind),
            "after_breakout": str(link.after_breakout),
            **rows,
        },
        "laws": {side: law.name for side, law in zip(SIDES, run.laws, strict=True)},
        "loaders": {side: json_value(loader, units) for side, loader in zip(SIDES, run.loaders, strict=True)},
    }
