"""The tables of a run: its measures, the effects in play, the scenario."""

from math import isfinite

from markupsafe import Markup

from forcefeel.conclusions import capital
from forcefeel.loader.curves import CURVES
from forcefeel.loader.parameters import TABLE, is_switch, meaning
from forcefeel.page.table import Cell, Table, number, words
from forcefeel.page.typography import NONE, parameter_text, prose_html, unit_text
from forcefeel.simulation import Run
from forcefeel.simulation.findings import input_text
from forcefeel.simulation.inputs import Schedule
from forcefeel.simulation.tables import measure_rows
from forcefeel.units import ANGLE, PERCENT, PRESSURE, Unit, UnitSystem, to_text

_LAWS = {
    "original": "the original position loop, eq. (13)",
    "published": "state feedback, eq. (20), with gains over the published horizon",
    "converged": "state feedback, eq. (20), with gains over an endless horizon",
}
_METHODS = {
    "exact": "exact at the samples: the loader has no optional effect, so it is linear",
    "stepped": "Runge-Kutta steps of fixed length",
}


def measured(run: Run, system: UnitSystem) -> Table:
    """The measures."""
    rows = [
        (words(capital(name)), number(value.replace("-", "\N{MINUS SIGN}")), Cell(unit_text(unit)))
        for name, value, unit in measure_rows(run, system, digits=3)
    ]
    return Table((Cell("Measure"), Cell("Value", "number"), Cell("Unit")), tuple(rows))


def effects(run: Run, system: UnitSystem) -> Table | None:
    """The optional rows and curves that the loader gives; ``None`` if there are none."""
    loader = run.loader
    rows = [
        (
            words(_effect(f"{TABLE[key].part.replace('_', ' ')}: {meaning(TABLE[key], loader.drive)}", key)),
            number(_value(run, key, system)),
        )
        for key in loader.given
    ]
    for name, curve in loader.curves.items():
        x, y = (unit_text(unit) or "1" for unit in CURVES[name].units(system))
        effect = words(_effect(f"feel: {CURVES[name].meaning}", CURVES[name].key))
        rows.append((effect, number(f"{len(curve.x)} points, {y} over {x}")))
    return Table((Cell("Effect"), Cell("Value", "number")), tuple(rows)) if rows else None


def scenario(run: Run, system: UnitSystem, law: str, whose: str = "") -> Table:
    """What was done to the loader, and by which law it was driven; ``whose`` says which of several loaders have the same."""
    run_scenario, loader = run.scenario, run.loader
    rows = [
        ("Pilot", input_text(run_scenario.force, system)),
        ("Length of the run", f"{run_scenario.duration_s:.6g} s"),
        ("Law", ", ".join(filter(None, (_LAWS.get(law, law), whose)))),
        ("Controller", _controller(run)),
        ("Solution", _METHODS[run.method]),
        ("Samples", f"every {1000 * run_scenario.sample_s:.6g} ms"),
    ]
    if run.method == "stepped":
        rows.insert(5, ("Longest step", f"{1000 * run_scenario.step_s:.6g} ms"))
    schedules = (
        ("Trim", run_scenario.trim_rad, ANGLE),
        ("Dynamic pressure", run_scenario.dynamic_pressure_pa, PRESSURE),
        ("Stick shaker on", run_scenario.shaker, PERCENT),
    )
    rows += [(name, _over_time(schedule, unit, system)) for name, schedule, unit in schedules if schedule is not None]
    if run_scenario.flight is not None:
        rows.append(
            ("Flight", f"{run_scenario.flight.name}: {', '.join(run_scenario.flight.states).replace('_', ' ')}")
        )
    for change in run_scenario.feel_changes:
        values = ", ".join(f"{key} = {_changed(value)}" for key, value in change.changes.items())
        rows.append(("Feel changed", f"from {change.at_s:g} s on, over {change.fade_s:g} s: {values}"))
    if any(loader[f"{sensor}.noise"] for sensor in ("load_cell", "potentiometer", "column_sensor")):
        rows.append(("Seed of the noise", str(run_scenario.seed)))
    return Table((Cell("Item"), Cell("Value")), tuple((Cell(name), words(prose_html(text))) for name, text in rows))


def _controller(run: Run) -> str:
    period, delay = run.loader["controller.period"], run.loader["controller.delay"]
    if not period:
        return "analog"
    return f"digital, period {1000 * period:.6g} ms, delay {1000 * delay:.6g} ms"


def _over_time(schedule: Schedule, unit: Unit, system: UnitSystem) -> str:
    unit_name = unit.shown(system)
    values = [f"{to_text(unit.from_si(value, system))} {unit_name}" for value in schedule.values]
    if len(values) == 1:
        return values[0]
    return ", ".join(f"{value} at {time:g} s" for time, value in zip(schedule.times_s, values, strict=True))


def _changed(value: object) -> str:
    return "off" if value is None else str(value)


def _value(run: Run, key: str, system: UnitSystem) -> str:
    if is_switch(TABLE[key]):
        return "yes" if run.loader[key] else "no"
    return parameter_text(run.loader, key, system) if isfinite(run.loader[key]) else NONE


def _effect(meaning: str, key: str) -> Markup:
    """An effect and its row in the loader file."""
    return prose_html(meaning) + Markup(" <small>{}</small>").format(key)
