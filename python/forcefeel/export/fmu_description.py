"""``modelDescription.xml`` and the documentation of an FMU, for FMI 2.0 or 3.0, from the library's own table of variables."""

from collections.abc import Mapping
from dataclasses import dataclass
from importlib.metadata import version as version_of

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel._core import FmuVariable
from forcefeel.export.exported import Exported
from forcefeel.laws.sampled.sampled_law import SAMPLED, SampledLaw
from forcefeel.loader.loader import FEEL_SETTING
from forcefeel.loader.parameters import TABLE, meaning, unit
from forcefeel.loader.sensors import has_grip_sensor
from forcefeel.loader.surface import has_surface
from forcefeel.simulation.inputs.flight import FLIGHT_UNITS
from forcefeel.templating import environment
from forcefeel.units import ANGLE, ANGULAR_VELOCITY, FORCE, LENGTH, PRESSURE, TORQUE, Unit, UnitSystem, dimensions

_SHOWN = {shown_unit.si: shown_unit for shown_unit in (ANGLE, ANGULAR_VELOCITY, LENGTH, FORCE, PRESSURE, TORQUE)}
"""Display units of variables outside the parameter table."""

_SIGNALS = {"load_pressure", "actuator_flow", "valve_current", "motor_current", "motor_voltage"}
"""Outputs that depend directly on a command without delay."""

_SENSED = ("sensed_load_cell_force", "sensed_drive_position", "sensed_column_base", "sensed_grip_force")
"""Sampled signals of a law, in the order of its numbers."""

_CELSIUS_AT_ZERO_K = 273.15


@dataclass(frozen=True)
class Description:
    """What an FMU says of itself.

    Attributes:
        xml: ``modelDescription.xml``.
        page: ``documentation/index.html``: what it computes, its variables, the platforms that it has a library for.
    """

    xml: str
    page: str


def description(exported: Exported, kind: str, version: str, about: Mapping[str, object]) -> Description:
    """Model description and documentation of an FMU.

    Args:
        exported: The law with its loader.
        kind: ``loader``, ``law`` or ``machine``.
        version: Version of FMI, ``2.0`` or ``3.0``.
        about: Identifier, token, description, ``step_s`` and ``delay_s``; the names of its platforms.
    """
    loader, feel = exported.loader, exported.settings
    variables = _core.fmu_variables(kind, loader.rows(FEEL_SETTING, feel)[0], len(feel))
    clocked = kind == "law" and version == "3.0"
    rows = [
        _variable(variable, loader.drive) | {"clocked": clocked and variable.causality in {"input", "output"}}
        for variable in variables
    ]

    def direct(output: str) -> set[str]:
        return _in_an_event(exported, output) if clocked else _at_once(exported, output, about)

    outputs = [
        {"index": index, "reference": variable.reference, "inputs": _named(direct(variable.name), variables)}
        for index, variable in enumerate(variables, start=1)
        if variable.causality == "output"
    ]
    values = {
        **about,
        "version": version,
        "loader": loader.name,
        "fingerprint": loader.fingerprint,
        "law": exported.law.name,
        "release": version_of("forcefeel"),
        "units": _units(rows),
        "clock": _core.FMU_CLOCK if clocked else None,
        "variables": rows,
        "outputs": outputs,
    }
    templates = environment(html=True)
    xml, page = (
        templates.get_template(f"export/fmu/{name}.j2").render(values)
        for name in (f"fmi{version[0]}.xml", "documentation.html")
    )
    return Description(xml, page)


def _variable(variable: FmuVariable, drive: str) -> dict[str, object]:
    row = TABLE.get(variable.name)
    means = variable.meaning if row is None else f"{row.symbol}: {meaning(row, drive)}"
    display_unit = (
        _SHOWN.get(variable.unit, Unit(variable.unit, variable.unit, variable.unit)) if row is None else unit(row)
    )
    low, high = variable.range or (None, None)
    start: str | None = None if variable.start is None else repr(variable.start)
    if variable.start is not None and variable.kind != "Real":
        start = str(int(variable.start)) if variable.kind == "Integer" else str(bool(variable.start)).lower()
    if variable.kind == "Real" and variable.start is not None and low is not None and high is not None:
        low, high = (
            min(low, variable.start),
            max(high, variable.start),
        )  # a limit with ten digits may be off by rounding

    def number(value: float | None) -> str | None:
        return None if value is None else str(int(value)) if variable.kind == "Integer" else repr(value)

    return {
        "reference": variable.reference,
        "name": variable.name,
        "means": means,
        "causality": variable.causality,
        "variability": variable.variability,
        "kind": variable.kind,
        "unit": variable.unit,
        "shown": display_unit,
        "display": display_unit.metric if variable.unit and display_unit.metric != variable.unit else "",
        "start": start,
        "low": number(low),
        "high": number(high),
    }


def _units(rows: list[dict[str, object]]) -> list[dict[str, object]]:
    """Each unit with its powers of the base units and its display units."""
    readings_of: dict[str, dict[str, float]] = {"s": {}}
    for row in rows:
        display_unit = row["shown"]
        if isinstance(display_unit, Unit) and row["unit"]:
            readings = readings_of.setdefault(str(row["unit"]), {})
            for system in (UnitSystem.SI, UnitSystem.US):
                if display_unit.shown(system) != display_unit.si:
                    readings[display_unit.shown(system)] = display_unit.from_si(1.0, system)
    return [{"name": name, "base": _base(name), "readings": readings} for name, readings in readings_of.items()]


def _base(name: str) -> dict[str, str]:
    """Powers of kg, m, s, A, K and rad, and the offset of a temperature."""
    powers = dict.fromkeys(("kg", "m", "s", "A", "K", "rad"), 0)
    of = {
        "[length]": {"m": 1},
        "[time]": {"s": 1},
        "[force]": {"kg": 1, "m": 1, "s": -2},
        "[angle]": {"rad": 1},
        "[current]": {"A": 1},
        "[voltage]": {"kg": 1, "m": 2, "s": -3, "A": -1},
        "[temperature]": {"K": 1},
        "[celsius]": {"K": 1},
    }
    for dimension, power in dimensions(name).items():
        for base, exponent in of[dimension].items():
            powers[base] += exponent * power
    written = {base: str(power) for base, power in powers.items() if power}
    return written | ({"offset": repr(_CELSIUS_AT_ZERO_K)} if name == "degC" else {})


def _at_once(exported: Exported, output: str, about: Mapping[str, object]) -> set[str]:
    """Inputs with direct feedthrough to an output."""
    follows: set[str] = set()
    if has_grip_sensor(exported.loader) and output == "sensed_grip_force":
        follows = {"pilot_force"}
    if about["delay_s"] == 0 and output in _SIGNALS:
        follows = {"pilot_force", "command"}
    return follows


def _in_an_event(exported: Exported, output: str) -> set[str]:
    """Inputs with direct feedthrough to an output of the law at a clock tick, from the law's numbers.

    Trim, factor, shaker and flight act on the feel in the following period; the current neutral is a state of the law.
    """
    numbers = exported.sampled()
    command, torque = _sensors(numbers, numbers.command), _sensors(numbers, numbers.torque)
    if exported.law.cancellation is not None:
        command |= {"sensed_drive_position"}
    if numbers.knows_friction:
        torque |= _sensors(numbers, numbers.friction[:, : numbers.torque.shape[1]])
    if numbers.knows_contact:
        # Whether there is contact depends on the torque and on the column.
        torque |= set(_SENSED[:SAMPLED])
        command |= torque
    if output in {"command", "feel_torque"}:
        return command if output == "command" else torque
    gives_way = exported.loader["controller.antiwindup"] > 0
    flight = set(FLIGHT_UNITS) if has_surface(exported.loader) else set()
    return torque | (command if gives_way else set()) | {"trim", "stiffness_factor", "shaker"} | flight


def _sensors(numbers: SampledLaw, rows: NDArray[np.float64]) -> set[str]:
    """Sensors with nonzero columns in rows on [xi; F_c, x_p, theta; delta; delta'], with F_g after theta if sampled."""
    columns = rows[:, numbers.states : -2].T
    return {name for name, column in zip(_SENSED, columns, strict=False) if column.any()}


def _named(names: set[str], variables: list[FmuVariable]) -> list[dict[str, int]]:
    """Index and reference of inputs."""
    return [
        {"index": index, "reference": variable.reference}
        for index, variable in enumerate(variables, start=1)
        if variable.causality == "input" and variable.name in names
    ]
