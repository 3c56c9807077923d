"""The optional rows: off unless given, in the loader, its file and its results; and what they ask of one another."""

import json
import math
import re
from itertools import cycle
from pathlib import Path

import numpy as np
import pytest

from forcefeel.errors import InputError
from forcefeel.loader.built_in import elevator
from forcefeel.loader.loader import Loader, load
from forcefeel.loader.parameters import (
    DRIVES,
    ELECTRIC,
    HYDRAULIC,
    OFF,
    TABLE,
    is_switch,
    parts,
    range_text,
    required,
    table,
)
from forcefeel.page.machine import parameters
from forcefeel.units import UnitSystem
from tests.optional_rows import bare, bare_of, companions
from tests.parametrization import mostly_slow

TEN_DIGITS = 1e-9  # relative
SYSTEMS = list(UnitSystem)
LIMITS = {
    key
    for key in TABLE
    if key.startswith("safety.")
    and (not key.startswith("safety.host_") or key in ("safety.host_time", "safety.host_fade"))
} - {"safety.force_rate", "safety.travel_search"}
"""Of a supervisor: what is not given is at its default. Without limits are the rate of force and a host's values."""
EXAMPLE_IS_OFF = {key for key, off in OFF.items() if TABLE[key].default_si == off}


def read(tmp_path: Path, text: str) -> Loader:
    path = tmp_path / "my.toml"
    path.write_text(text, encoding="utf-8")
    return load(path)


def complaints(tmp_path: Path, text: str) -> list[str]:
    with pytest.raises(InputError) as caught:
        read(tmp_path, text)
    return [line.removeprefix(f"{tmp_path / 'my.toml'}: ") for line in str(caught.value).splitlines()]


def with_example(key: str) -> Loader:
    """A loader with one optional row, and what it needs to have an effect."""
    return bare_of(key).replace({**companions(key), key: TABLE[key].default_si}, si=True)


def added(part: str, *lines: str, drive: str = HYDRAULIC) -> str:
    """A bare loader's file with lines in a table."""
    text = bare(drive).to_toml()
    assert text.count(f"\n[{part}]\n") == 1
    return text.replace(f"\n[{part}]\n", "\n".join(["", f"[{part}]", *lines, ""]))


def test_every_row_is_required_or_optional() -> None:
    for drive in DRIVES:
        optional = {key for key in OFF if key in table(drive)}
        assert {*required(drive), *optional} == set(table(drive))
        assert not {*required(drive)} & optional
    assert {*table(HYDRAULIC), *table(ELECTRIC)} == set(TABLE)
    assert {
        "actuator.relief_gain", "column.gravity_angle", "column.stop_stiffness", "column.stop_damping",
        "feel.breakout_travel", "feel.hysteresis_travel", "feel.detent_travel", "feel.soft_stop_stiffness",
        "feel.shaker_frequency", "motor.cogging_periods", "motor.cogging_phase", "motor.cogging_periods_2",
        "motor.cogging_phase_2", "thermal.ambient", "thermal.derating_from", "thermal.winding_limit",
    } | LIMITS == EXAMPLE_IS_OFF  # fmt: skip


def test_elevator_has_no_optional_rows() -> None:
    loader = elevator()
    assert loader.given == ()
    assert all(loader[key] == off for key, off in OFF.items())


@pytest.mark.parametrize("key", OFF)
def test_optional_row_is_set_and_switched_off(key: str) -> None:
    loader, plain = with_example(key), bare_of(key)
    set_here = {**companions(key), key: TABLE[key].default_si}
    expected = {name for name, value in set_here.items() if value != OFF[name]} | {*plain.given}
    assert set(loader.given) == expected
    assert loader.given == tuple(name for name in TABLE if name in expected)
    assert loader.replace(dict.fromkeys(expected - {*plain.given})) == plain


@pytest.mark.parametrize(("key", "units"), mostly_slow([*zip(OFF, cycle(SYSTEMS), strict=False)], 24))
def test_optional_row_round_trips_through_file(tmp_path: Path, key: str, units: UnitSystem) -> None:
    loader = with_example(key)
    text = loader.to_toml(units)
    once = read(tmp_path, text)
    assert once.si_values == pytest.approx(loader.si_values, rel=TEN_DIGITS)
    assert once.given == loader.given
    assert read(tmp_path, once.to_toml(units)) == once
    assert (f"\n{TABLE[key].name} = " in text.split(f"[{TABLE[key].part}]")[1]) or key in EXAMPLE_IS_OFF


@pytest.mark.parametrize("units", SYSTEMS)
@pytest.mark.parametrize("drive", DRIVES)
def test_uncommented_examples_are_valid_together(tmp_path: Path, drive: str, units: UnitSystem) -> None:
    # In place of this row stands the table over the same angle.
    optional = [key for key in OFF if key in table(drive) and key != "surface.per_deflection"]
    names = "|".join(TABLE[key].name for key in optional)
    text = re.sub(rf"(?m)^# ((?:{names}) = )", r"\1", bare(drive).to_toml(units))
    text = text.replace("\ntorque_constant = ", "\ntorque_constant_peak = ")  # as one of the examples has three phases
    loader = read(tmp_path, text)
    assert set(optional) - set(loader.given) <= EXAMPLE_IS_OFF
    for key in optional:
        assert loader[key] == pytest.approx(TABLE[key].default_si, rel=5e-4)  # four digits
    again = read(tmp_path, loader.to_toml(units))
    assert again.given == loader.given
    assert again.si_values == pytest.approx(loader.si_values, rel=TEN_DIGITS)


OPTIONAL_PARTS = {
    HYDRAULIC: {"column_sensor", "controller"},
    ELECTRIC: {"thermal", "brake", "load_cell", "potentiometer", "column_sensor"},
}
"""Parts that a bare file has and may be without; the controller of an electric drive has optional rows only, and needs one."""


@pytest.mark.parametrize(
    ("drive", "part"), [(drive, part) for drive, them in OPTIONAL_PARTS.items() for part in sorted(them)]
)
def test_a_part_with_optional_rows_only_may_be_absent(tmp_path: Path, drive: str, part: str) -> None:
    whole = bare(drive).to_toml()
    text = whole.replace(f"\n[{part}]\n", "\n")
    assert text != whole
    assert read(tmp_path, text) == read(tmp_path, whole)
    assert complaints(tmp_path, f"{part} = 5\n{text}") == [f"{part}: expected the table [{part}], got 5"]


@pytest.mark.parametrize("drive", DRIVES)
def test_missing_required_part_is_refused(tmp_path: Path, drive: str) -> None:
    for part in sorted(set(parts(drive)) - OPTIONAL_PARTS[drive] - {"controller", "grip_sensor", "surface", "safety"}):
        text = re.sub(rf"\n\[{part}\]\n(?:.+\n)*", "\n", bare(drive).to_toml())
        assert complaints(tmp_path, text)[0] == f"{part}: missing value; add the table [{part}]"


# Switches


def test_a_switch_is_true_or_false(tmp_path: Path) -> None:
    assert read(tmp_path, added("valve", "orifice = true"))["valve.orifice"] == 1
    assert read(tmp_path, added("valve", "orifice = false")) == read(tmp_path, elevator().to_toml())
    for given in (True, 1, 1.0, np.float64(1)):
        assert elevator().replace({"valve.orifice": given}, si=True).given == ("valve.orifice",)
    for given in (False, 0, 0.0, None):
        assert elevator().replace({"valve.orifice": given}, si=True) == elevator()
    assert "\norifice = true " in elevator().replace({"valve.orifice": True}).to_toml()


@pytest.mark.parametrize(
    ("given", "shown"),
    [
        ("1", "1"),
        ("0.5", "0.5"),
        ('"true"', "'true'"),
        ('"1 switch"', "'1 switch'"),
        ("[true]", "an array"),
        ("{}", "a table"),
    ],
)
def test_non_boolean_switch_in_file_is_refused(tmp_path: Path, given: str, shown: str) -> None:
    message = f"valve.orifice: expected true or false, got {shown}"
    assert complaints(tmp_path, added("valve", f"orifice = {given}")) == [message]


@pytest.mark.parametrize("given", ["true", "1", 0.5, 2, -1, math.nan, math.inf, [True], {}])
def test_non_boolean_switch_of_loader_is_refused(given: str | float) -> None:
    with pytest.raises(InputError, match=r"^valve\.orifice: expected true or false, got "):
        elevator().replace({"valve.orifice": given}, si=True)


def test_boolean_as_number_is_refused() -> None:
    with pytest.raises(InputError, match=r"^column\.coulomb_friction: expected a number such as '3 lb', got true$"):
        elevator().replace({"column.coulomb_friction": True})


# Off values


def test_off_values_are_accepted_in_loader_values() -> None:
    values = elevator().si_values
    assert np.isinf(values).sum() == sum(map(math.isinf, OFF.values())) > 10
    assert Loader("again", "", values).given == ()


@pytest.mark.parametrize("key", [key for key, off in OFF.items() if math.isinf(off)])
def test_infinite_value_is_refused(tmp_path: Path, key: str) -> None:
    row = TABLE[key]
    text = added(row.part, f'{row.name} = "inf {row.unit_us}"', drive=row.drive or HYDRAULIC)
    [message] = complaints(tmp_path, text)
    assert message.endswith(", which is not finite")
    with pytest.raises(InputError, match=r"which is not finite$"):
        bare_of(key).replace({key: OFF[key]}, si=True)
    values = bare_of(key).si_values.copy()
    values[list(TABLE).index(key)] = -OFF[key]
    with pytest.raises(InputError, match=rf"^{key}: expected .+, got "):
        Loader("bad", "", values)


def test_a_period_of_zero_is_refused(tmp_path: Path) -> None:
    said = "expected 0.01 to 100 ms, got"
    [message] = complaints(tmp_path, added("controller", 'period = "0 ms"'))
    assert message == f"controller.period: out of range: {said} '0 ms'; leave the row out for an analog controller"
    for given in ("0 ms", 0.0):
        with pytest.raises(InputError) as caught:
            elevator().replace({"controller.period": given}, si=True)
        assert (
            str(caught.value)
            == f"controller.period: {said} 0 ms; give None, or off on the command line, for an analog controller"
        )
    assert elevator().replace({"controller.period": "1 ms"}).replace({"controller.period": None}) == elevator()


@pytest.mark.parametrize("key", [key for key in OFF if "friction" in key])
def test_negative_friction_is_refused(key: str) -> None:
    with pytest.raises(InputError) as caught:
        bare_of(key).replace({key: -1.0}, si=True)
    assert str(caught.value).startswith(f"{key}: expected {range_text(TABLE[key])}, got -")


@pytest.mark.parametrize("key", [key for key, row in TABLE.items() if row.off_si is None])
def test_a_required_row_cannot_be_switched_off(key: str) -> None:
    with pytest.raises(InputError, match=rf"^{key}: expected a number such as .+, got None$"):
        bare_of(key).replace({key: None})


# What rows ask of one another

STOPS = "; leave one out where there is no such stop"
SAME = "; leave it out where both are the same"


@pytest.mark.parametrize(
    ("changes", "messages"),
    [
        (
            {"column.stop_low": "-5 deg", "column.stop_high": "5 deg"},
            [],
        ),
        (
            {"column.stop_low": "0 deg", "column.stop_high": "0 deg"},
            [f"column.stop_low: expected less than column.stop_high, which is 0 deg, got 0 deg{STOPS}"],
        ),
        (
            {"feel.soft_stop_low": "5 deg", "feel.soft_stop_high": "-5 deg"},
            [f"feel.soft_stop_low: expected less than feel.soft_stop_high, which is -5 deg, got 5 deg{STOPS}"],
        ),
        (
            {"feel.hard_stop_low": "5 deg", "feel.hard_stop_high": "5.0000000001 deg"},
            [f"feel.hard_stop_low: expected less than feel.hard_stop_high, which is 5 deg, got 5 deg{STOPS}"],
        ),
        ({"feel.hard_stop_low": "-5 deg"}, []),
        ({"column.coulomb_friction": "3 lb"}, []),
        ({"column.static_friction": "3 lb"}, []),
        ({"column.coulomb_friction": "3 lb", "column.static_friction": "3 lb"}, []),
        ({"column.coulomb_friction": "3 lb", "column.static_friction": "13.34466485 N"}, []),
        (
            {"column.coulomb_friction": "3 lb", "column.static_friction": "2 lb"},
            [f"column.static_friction: expected at least column.coulomb_friction, which is 3 lb, got 2 lb{SAME}"],
        ),
        (
            {"feel.coulomb_friction": "3 lb", "feel.static_friction": "2 lb"},
            [f"feel.static_friction: expected at least feel.coulomb_friction, which is 3 lb, got 2 lb{SAME}"],
        ),
        ({"controller.period": "1 ms"}, []),
        ({"controller.period": "1 ms", "controller.input_range": "5 V", "controller.input_bits": 12}, []),
        (
            {"controller.period": "1 ms", "controller.input_range": "5 V"},
            [
                "controller.input_range: has no effect without controller.input_bits; "
                "give controller.input_bits too, such as '16', or leave controller.input_range out"
            ],
        ),
        (
            {"controller.period": "1 ms", "controller.output_bits": 12},
            [
                "controller.output_bits: has no effect without controller.output_range; "
                "give controller.output_range too, such as '10 V', or leave controller.output_bits out"
            ],
        ),
        (
            {"column.stop_damping": "5 lb in s/rad"},
            [
                "column.stop_damping: has no effect without column.stop_low or column.stop_high; "
                "give column.stop_low too, such as '-20 deg', or leave column.stop_damping out"
            ],
        ),
        ({"column.stop_damping": "5 lb in s/rad", "column.stop_high": "5 deg"}, []),
    ],
)
def test_incompatible_rows_are_named_with_remedy(
    tmp_path: Path, changes: dict[str, str | float], messages: list[str]
) -> None:
    by_part: dict[str, list[str]] = {}
    for key, value in changes.items():
        by_part.setdefault(TABLE[key].part, []).append(f'{TABLE[key].name} = "{value}"')
    [(part, lines)] = by_part.items()
    if not messages:
        loader = read(tmp_path, added(part, *lines))
        assert loader == read(tmp_path, elevator().to_toml()).replace(changes, si=True)
        return
    assert complaints(tmp_path, added(part, *lines)) == messages
    with pytest.raises(InputError) as caught:
        elevator().replace(changes, si=True)
    assert str(caught.value).splitlines() == messages


SENSED = [
    f"{sensor}.{name}" for sensor in ("load_cell", "potentiometer", "column_sensor") for name in ("noise", "resolution")
]
SAMPLED = [f"controller.{name}" for name in ("delay", "antiwindup", "input_bits", "output_range")]
ALONE = [
    *(("controller.period", key) for key in (*SENSED, *SAMPLED)),
    ("actuator.relief_pressure", "actuator.relief_gain"),
    ("column.gravity_torque", "column.gravity_angle"),
    ("feel.breakout", "feel.breakout_travel"),
    ("feel.hysteresis", "feel.hysteresis_travel"),
    ("feel.detent_force", "feel.detent_angle"),
    ("feel.detent_force", "feel.detent_travel"),
    ("feel.soft_stop_low", "feel.soft_stop_stiffness"),
    ("feel.soft_stop_low", "feel.soft_stop_damping"),
    ("feel.shaker_force", "feel.shaker_frequency"),
    ("motor.cogging_torque", "motor.cogging_periods"),
    ("motor.cogging_torque_2", "motor.cogging_phase_2"),
    ("thermal.winding_capacity", "thermal.derating_from"),
    ("thermal.winding_capacity", "winding.temperature_coefficient"),
    ("brake.torque", "brake.engaged"),
]  # fmt: skip


@pytest.mark.parametrize(("needed", "key"), ALONE)
def test_row_without_required_companion_is_refused(needed: str, key: str) -> None:
    row = TABLE[key]
    with pytest.raises(InputError) as caught:
        bare_of(key).replace({key: True if is_switch(row) else (row.default_si or row.maximum_si) * 0.9}, si=True)
    assert str(caught.value).startswith(f"{key}: has no effect without {needed}")
    assert f"; give {needed} too, such as '" in str(caught.value)


def test_loader_from_values_has_same_row_checks() -> None:
    values = elevator().si_values.copy()
    values[list(TABLE).index("controller.delay")] = 1e-3
    with pytest.raises(InputError, match=r"^controller\.delay: has no effect without controller\.period;"):
        Loader("bad", "", values)


# Results


def test_json_contains_set_rows_and_no_infinite_value() -> None:
    loader = elevator().replace({"feel.hard_stop_high": "18 deg", "valve.orifice": True})
    for units in SYSTEMS:
        found = loader.as_json(units)
        json.dumps(found, allow_nan=False)
        assert "infinite" not in json.dumps(found)
        values = found["values"]
        assert isinstance(values, dict)
        assert list(values) == [key for key in TABLE if key in required(HYDRAULIC) or key in loader.given]
        assert values["feel.hard_stop_high"] == {"value": pytest.approx(18), "unit": "deg"}
        assert values["valve.orifice"] == {"value": 1.0, "unit": ""}


def test_report_table_shows_set_rows() -> None:
    loader = elevator().replace({"feel.hard_stop_high": "18 deg", "valve.orifice": True})
    loader = loader.with_tolerances({"column.stop_high": {"uniform": ["10 deg", "20 deg"]}})
    rows = [[str(cell.text) for cell in row] for row in parameters(loader, UnitSystem.US).rows]
    assert len(rows) == len(required(HYDRAULIC)) + 3
    assert ["18", "deg", "–", "–"] in [row[2:] for row in rows]
    assert ["yes", "", "–", "–"] in [row[2:] for row in rows]
    assert ["–", "", "10 deg to 20 deg", "–"] in [row[2:] for row in rows]
    assert ["6107.86", "lb/in", "−20 % to +20 %", "the same (appendix)"] in [row[2:] for row in rows]
    assert len(parameters(elevator(), UnitSystem.SI).rows) == len(required(HYDRAULIC))
