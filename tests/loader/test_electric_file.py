"""The file of an electric loader: what it may not say, and that what it says comes back."""

import math
import tomllib
from pathlib import Path
from typing import Any

import pytest
import tomlkit

import forcefeel as ff
from forcefeel.errors import InputError
from forcefeel.loader.axes import ELECTRIC_AXES
from forcefeel.loader.built_in import digital_elevator, electric, elevator, open_loader
from forcefeel.loader.loader import Loader, load
from forcefeel.loader.parameters import ALTERNATIVES, ELECTRIC, TABLE, absent, has
from forcefeel.units import UnitSystem
from tests.optional_rows import bare

TEN_DIGITS = 1e-9  # relative; what a file holds
ROUNDING = 4e-15  # relative; a conversion to SI multiplies about ten times
INCH, POUND = 0.0254, 4.4482216152605  # m, N
FINGERPRINTS = {
    "elevator-1974": "d41212ddab14c8a90f142c6f1da09b24c804f303a498dbc031d18f0d288365e2",
    "elevator-2khz": "82de90f02485e23a91bc5de8d6ddb5d172725bc47839d8084dd14a6c19a5d91e",
}
"""By these a saved law knows its loader; a new row of the table, off, leaves them as they are."""
OFF: Any = None
"""In a change: the key is taken out."""
MOTOR_TABLES = (
    "motor, winding, current_loop, transmission, thermal, brake, linkage, column, load_cell, potentiometer, column_sensor, "
    "grip_sensor, controller, feel, surface, pilot, safety"
)
SERVO_TABLES = (
    "amplifier, valve, actuator, linkage, column, load_cell, potentiometer, column_sensor, grip_sensor, controller, feel, surface, "
    "pilot, safety"
)
HEAT = {
    "winding_resistance": "1 K/W",
    "housing_resistance": "1.5 K/W",
    "winding_capacity": "100 J/K",
    "housing_capacity": "1000 J/K",
}
PERIOD = {"period": "0.5 ms"}


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where a test writes its file."""
    return tmp_path_factory.mktemp("loaders") / "my.toml"


def read(path: Path, changes: dict[str, Any], loader: Loader | None = None) -> Loader:
    """A bare motor's file, or another loader's, with some tables changed, and read."""
    document: dict[str, Any] = tomllib.loads((loader or bare(ELECTRIC)).to_toml())
    for key, given in changes.items():
        if isinstance(given, dict):
            document.setdefault(key, {}).update(given)
            for name in [name for name, value in document[key].items() if value is OFF]:
                del document[key][name]
        elif given is OFF:
            del document[key]
        else:
            document[key] = given
    path.write_text(tomlkit.dumps(document), encoding="utf-8")
    return load(path)


def complaints(path: Path, changes: dict[str, Any], loader: Loader | None = None) -> list[str]:
    with pytest.raises(InputError) as caught:
        read(path, changes, loader)
    return [line.removeprefix(f"{path}: ") for line in str(caught.value).splitlines()]


def of_other(key: str, which: str, this: str, tables: str) -> str:
    article = "an electric" if which == "electric" else "a hydraulic"
    return (
        f'{key}: unknown key; it is of {article} drive, and this file says drive = "{this}", of which the tables are {tables}; '
        f'take it out, or say drive = "{which}"'
    )


KT_CHOICE = (
    "give either torque_constant, or torque_constant_peak, or torque_constant_rms, or speed_constant, or speed_constant_peak, or "
    "speed_constant_rms, or voltage_constant, or voltage_constant_peak, or voltage_constant_rms"
)
WINDING_CHOICE = (
    "give either resistance and inductance, or resistance_line_to_line and inductance_line_to_line, or resistance_phase and "
    "inductance_phase"
)
TRAVEL_CHOICE = "give either travel, or lead, or lead and gear_ratio, or radius, or radius and gear_ratio"
BRUSHED = (
    "is of a motor with three phases; add [motor] three_phase = true, or state what a brushed motor's data sheet gives"
)


@pytest.mark.parametrize(
    ("changes", "messages"),
    [
        ({"drive": "steam"}, ["drive: expected hydraulic or electric, got 'steam'"]),
        ({"drive": 1}, ["drive: expected hydraulic or electric, got 1"]),
        ({"valve": {"orifice": True}}, [of_other("valve", "hydraulic", "electric", MOTOR_TABLES)]),
        ({"load_cell": {"gain": "0.005 V/lb"}}, [of_other("load_cell.gain", "hydraulic", "electric", MOTOR_TABLES)]),
        (
            {"controller": {"output_bits": 16}},
            [of_other("controller.output_bits", "hydraulic", "electric", MOTOR_TABLES)],
        ),
        ({"motor": {"kt": "0.3 N m/A"}}, None),
        (
            {"motor": {"torque_constant": OFF}},
            [f'motor: missing value; add torque_constant = "3.0667 lb in/A"; {KT_CHOICE}'],
        ),
        (
            {"motor": {"torque_constant_rms": "0.49 N m/A", "three_phase": True}},
            [f"motor: stated in more than one way (torque_constant, torque_constant_rms); {KT_CHOICE}"],
        ),
        (
            {"motor": {"three_phase": True}},
            [
                "motor.torque_constant: of a motor with three phases, per peak or per r.m.s. ampere, 1.41 times apart? Expected "
                "torque_constant_peak or torque_constant_rms"
            ],
        ),
        (
            {"motor": {"torque_constant": OFF, "three_phase": True}},
            [f'motor: missing value; add torque_constant_peak = "3.0667 lb in/A"; {KT_CHOICE}'],
        ),
        (
            {
                "motor": {
                    "torque_constant": OFF,
                    "torque_constant_peak": "0.3 N m/A",
                    "torque_constant_rms": "0.4 N m/A",
                }
            },
            [f"motor: stated in more than one way (torque_constant_peak, torque_constant_rms); {KT_CHOICE}"],
        ),
        (
            {"motor": {"torque_constant": OFF, "torque_constant_peak": "0.49 N m/A"}},
            [f"motor.torque_constant_peak: {BRUSHED}"],
        ),
        (
            {"motor": {"torque_constant": OFF, "torque_constant_rms": "0.49 N m/A"}},
            [f"motor.torque_constant_rms: {BRUSHED}"],
        ),
        (
            {"winding": {"resistance_line_to_line": "3 ohm"}},
            [
                f"winding: stated in more than one way (resistance, inductance, resistance_line_to_line); {WINDING_CHOICE}"
            ],
        ),
        (
            {
                "winding": {
                    "resistance": OFF,
                    "inductance": OFF,
                    "resistance_line_to_line": "3 ohm",
                    "inductance_line_to_line": "6 mH",
                }
            },
            [f"winding.resistance_line_to_line: {BRUSHED}", f"winding.inductance_line_to_line: {BRUSHED}"],
        ),
        ({"winding": OFF}, ["winding: missing value; add the table [winding]"]),
        (
            {"winding": {"inductance": OFF}},
            [f'winding: missing value; add inductance = "3.285 mH"; {WINDING_CHOICE}'],
        ),
        ({"transmission": OFF}, ["transmission: missing value; add the table [transmission]"]),
        (
            {"transmission": {"gear_ratio": 5.0}},
            [f"transmission: stated in more than one way (travel, gear_ratio); {TRAVEL_CHOICE}"],
        ),
        (
            {"transmission": {"travel": OFF, "gear_ratio": 5.0}},
            [f'transmission: missing value; add lead = "4.9474 in"; {TRAVEL_CHOICE}'],
        ),
        (
            {"current_loop": {"peak_time": "2 s"}},
            [
                "current_loop.peak_time: has no effect without current_loop.continuous_current; give "
                "current_loop.continuous_current too, such as '6 A', or leave current_loop.peak_time out"
            ],
        ),
        (
            {"transmission": {"travel": "0 mm"}},
            ["transmission.travel: out of range: expected 0.0001 to 100 in (0.000254 to 254 cm), got '0 mm'"],
        ),
        (
            {"transmission": {"travel": "20 mm", "lead": "20 mm"}},
            [
                f"transmission: stated in more than one way (travel, lead); {TRAVEL_CHOICE}",
            ],
        ),
        (
            {"transmission": {"efficiency": 0}},
            ["transmission.efficiency: out of range: expected 0.05 to 1, got 0"],
        ),
        ({"linkage": {"ratio": 0}}, ["linkage.ratio: out of range: expected 0.01 to 1, got 0"]),
        (
            {"motor": {"torque_constant": "0.3"}},
            [
                "motor.torque_constant: expected a number with its unit such as '3.0667 lb in/A', got '0.3', which has no unit",
            ],
        ),
        (
            {"winding": {"resistance": "3 mH"}},
            [
                "winding.resistance: expected a number with its unit such as '1.535 ohm', got '3 mH': 'mH' measures an inductance, "
                "not a resistance",
            ],
        ),
        (
            {"thermal": {name: HEAT[name] for name in ("winding_resistance", "housing_resistance")}},
            [
                f"thermal.{one}: has no effect without thermal.{other}; give thermal.{other} too, such as '{example}', or leave "
                f"thermal.{one} out"
                for one, other, example in (
                    ("winding_resistance", "winding_capacity", "100 J/K"),
                    ("housing_resistance", "winding_capacity", "100 J/K"),
                )
            ],
        ),
        (
            {"thermal": {"ambient": "30 degC"}},
            [
                "thermal.ambient: has no effect without thermal.winding_capacity; give thermal.winding_capacity too, such as "
                "'100 J/K', or leave thermal.ambient out"
            ],
        ),
        (
            {"thermal": {**HEAT, "derating_from": "140 degC"}},
            [
                "thermal.derating_from: expected less than thermal.winding_limit, which is 130 degC, got 140 degC; set them apart"
            ],
        ),
        (
            {"thermal": {**HEAT, "ambient": "90 degC", "derating_from": "80 degC"}},
            [
                "thermal.ambient: expected less than thermal.derating_from, which is 80 degC, got 90 degC; set them apart"
            ],
        ),
        (
            {"thermal": {**HEAT, "ambient": "300 K"}},
            [
                "thermal.ambient: expected a number with its unit such as '25 degC', got '300 K': 'K' does not measure a "
                "temperature"
            ],
        ),
        (
            {"controller": OFF},
            [
                "controller.period: missing value; an electric drive takes its command from a digital controller; add [controller] "
                'period = "0.5 ms" and delay = "0.5 ms"'
            ],
        ),
        (
            {"motor": {"coulomb_friction": "2 lb in", "static_friction": "1 lb in"}},
            [
                "motor.static_friction: expected at least motor.coulomb_friction, which is 2 lb in, got 1 lb in; leave it out "
                "where both are the same"
            ],
        ),
        (
            {"motor": {"cogging_periods": 12}},
            [
                "motor.cogging_periods: has no effect without motor.cogging_torque; give motor.cogging_torque too, such as "
                "'0.2 lb in', or leave motor.cogging_periods out"
            ],
        ),
        (
            {"brake": {"engaged": True}},
            [
                "brake.engaged: has no effect without brake.torque; give brake.torque too, such as '20 lb in', or leave "
                "brake.engaged out"
            ],
        ),
        (
            {"tolerances": {"valve.current_gain": "10 %"}},
            [
                "tolerances.valve.current_gain: is of a loader with a hydraulic drive; this one has the other; leave it out"
            ],
        ),
        (
            {"tolerances": {"motor.three_phase": "10 %"}},
            ["tolerances.motor.three_phase: a switch is on or off; leave its tolerance out"],
        ),
    ],
    ids=str,
)
def test_bad_value_of_electric_file_gives_one_line_error(
    path: Path, changes: dict[str, Any], messages: list[str] | None
) -> None:
    said = complaints(path, changes)
    if messages is None:
        known = "torque_constant, inertia, three_phase, viscous_friction"
        assert [line.split(known)[0] for line in said] == ["motor.kt: unknown key; known are "]
        assert said[0].endswith("voltage_constant_rms")
    else:
        assert said == messages


@pytest.mark.parametrize(
    ("changes", "key"),
    [({"motor": {"inertia": "1 kg cm^2"}}, "motor"), ({"brake": {"engaged": True}}, "brake")],
    ids=str,
)
def test_electric_key_in_hydraulic_file_raises_input_error(path: Path, changes: dict[str, Any], key: str) -> None:
    assert complaints(path, changes, elevator()) == [of_other(key, "electric", "hydraulic", SERVO_TABLES)]
    said = "tolerances.motor.inertia: is of a loader with an electric drive; this one has the other; leave it out"
    assert complaints(path, {"tolerances": {"motor.inertia": "5 %"}}, elevator()) == [said]


def test_electric_file_without_tables_names_required_tables(path: Path) -> None:
    said = complaints(path, {"drive": "electric"}, elevator())
    for part in ("motor", "winding", "current_loop", "transmission"):
        assert f"{part}: missing value; add the table [{part}]" in said
    for part in ("amplifier", "valve", "actuator"):
        assert of_other(part, "hydraulic", "electric", MOTOR_TABLES) in said


@pytest.mark.parametrize(
    ("loader", "key", "message"),
    [
        (
            bare(ELECTRIC),
            "actuator.area",
            "actuator.area: is of a loader with a hydraulic drive; motor has an electric drive",
        ),
        (
            elevator(),
            "motor.inertia",
            "motor.inertia: is of a loader with an electric drive; elevator-1974 has a hydraulic drive",
        ),
    ],
    ids=["electric", "hydraulic"],
)
def test_row_of_other_drive_is_refused(loader: Loader, key: str, message: str) -> None:
    row = TABLE[key]
    with pytest.raises(InputError) as caught:
        loader.replace({key: row.default_si}, si=True)
    assert str(caught.value).startswith(f"{message}, with the parts ")
    with pytest.raises(InputError) as caught:
        loader.with_tolerances({key: "10 %"})
    assert str(caught.value).startswith(f"tolerances.{message}, with the parts ")
    values = loader.si_values.copy()
    values[list(TABLE).index(key)] = row.default_si
    if key == "actuator.area":
        with pytest.raises(
            InputError, match=r"^actuator\.area: expected 0, as a loader with an electric drive has no such row"
        ):
            Loader("both", "", values)
    assert loader[key] == absent(row)


def test_unknown_row_error_lists_rows_of_drive() -> None:
    with pytest.raises(InputError, match=r"'volume'; the parameters are motor\.torque_constant"):
        bare(ELECTRIC).replace({"volume": 1.0}, si=True)
    with pytest.raises(
        InputError, match=r"did you mean transmission\.stiffness or linkage\.stiffness or feel\.stiffness\?"
    ):
        bare(ELECTRIC).replace({"stiffness": 1.0}, si=True)


# What is stated in another way


def test_three_phase_torque_constant_is_written_as_peak(path: Path) -> None:
    """A file made from a loader that was given it per r.m.s. ampere says peak, and means the same."""
    loader = electric("aileron-wheel")
    text = loader.to_toml(UnitSystem.SI)
    assert '\ntorque_constant_peak = "0.3464823228 N m/A"\n' in text
    assert "\ntorque_constant = " not in text
    path.write_text(text, encoding="utf-8")
    assert load(path)["motor.torque_constant"] == pytest.approx(0.49 / math.sqrt(2))


def test_motor_data_sheet_values_are_converted(path: Path) -> None:
    loader = read(
        path,
        {
            "motor": {"torque_constant": OFF, "torque_constant_rms": "0.49 N m/A", "three_phase": True},
            "winding": {
                "resistance": OFF,
                "inductance": OFF,
                "resistance_line_to_line": "3.07 ohm",
                "inductance_line_to_line": "6.57 mH",
            },
            "transmission": {"travel": OFF, "lead": "20 mm"},
        },
    )
    # A sine of the peak I has I / sqrt(2) r.m.s.; two phases of a star lie between two lines
    assert loader["motor.torque_constant"] == pytest.approx(0.49 / math.sqrt(2), rel=ROUNDING)
    assert loader["winding.resistance"] == pytest.approx(3.07 / 2, rel=ROUNDING)
    assert loader["winding.inductance"] == pytest.approx(6.57e-3 / 2, rel=ROUNDING)
    assert loader["transmission.travel"] == pytest.approx(0.02 / (2 * math.pi), rel=ROUNDING)


def test_derived_values_are_checked_against_range(path: Path) -> None:
    changes = {"transmission": {"travel": OFF, "lead": "0.001 in"}, "motor": {"torque_constant": "0.0005 lb in/A"}}
    assert complaints(path, {"motor": changes["motor"]})[0].startswith(
        "motor.torque_constant: out of range: expected 0.001 to"
    )
    del changes["motor"]
    assert read(path, changes)["transmission.travel"] == pytest.approx(0.001 * INCH / (2 * math.pi), rel=ROUNDING)


# Round trips


@pytest.mark.parametrize("units", list(UnitSystem))
@pytest.mark.parametrize("name", ELECTRIC_AXES)
def test_built_in_loader_round_trips_through_file(path: Path, name: str, units: UnitSystem) -> None:
    loader = electric(name)
    path.write_text(loader.to_toml(units), encoding="utf-8")
    back = load(path)
    assert (back.name, back.source, back.drive) == (name, loader.source, ELECTRIC)
    assert back.si_values == pytest.approx(loader.si_values, rel=TEN_DIGITS, abs=0)
    assert set(back.tolerances) == set(loader.tolerances)
    path.write_text(back.to_toml(units), encoding="utf-8")
    assert load(path) == back
    for key, row in TABLE.items():
        assert has(ELECTRIC, row) or loader[key] == absent(row)


@pytest.mark.parametrize("name", ELECTRIC_AXES)
def test_built_in_loader_states_illustrative_values(name: str) -> None:
    assert "llustrative" in electric(name).source


def test_unknown_built_in_loader_error_lists_valid_names() -> None:
    with pytest.raises(InputError, match=r"^name: expected elevator-electric, .+, got 'rudder'$"):
        electric("rudder")


def test_motor_alternatives_are_all_tested() -> None:
    parts = {"motor", "winding", "current_loop", "transmission"}
    assert {row.name for row in ALTERNATIVES.values() if row.part in parts} == {
        "torque_constant_peak", "torque_constant_rms", "speed_constant", "speed_constant_peak",
        "speed_constant_rms", "resistance_line_to_line", "inductance_line_to_line", "lead",
        "voltage_constant", "voltage_constant_peak", "voltage_constant_rms", "resistance_phase", "inductance_phase",
        "current_limit_peak", "current_limit_rms", "continuous_current_peak", "continuous_current_rms", "supply_voltage",
        "radius", "gear_ratio", "backlash_angle",
    }  # fmt: skip


# Laws that were saved


@pytest.mark.parametrize(("name", "made"), [("elevator-1974", elevator), ("elevator-2khz", digital_elevator)])
def test_hydraulic_loader_keeps_its_fingerprint(name: str, made: Any) -> None:
    assert made().fingerprint == FINGERPRINTS[name]


def test_motor_row_changes_fingerprint() -> None:
    loader = ff.loader.electric("desktop-yoke")
    assert loader.replace({"motor.inertia": "81 kg cm^2"}).fingerprint != loader.fingerprint
    assert ff.loader.electric("desktop-yoke").fingerprint == loader.fingerprint


LB_N = 4.4482216152605
LIMITS_LB = {
    # 14 CFR 25.143(d), short term: wheel by two hands, stick by one; 25.397(c), 80 D in. lb at a wheel's rim being 160 lb.
    "elevator-electric": (75, 300),
    "aileron-wheel": (50, 160),
    "desktop-yoke": (50, 160),
    "rudder-pedals": (150, 300),
    "sidestick-pitch": (50, 250),
    "sidestick-roll": (25, 100),
}


@pytest.mark.parametrize("name", LIMITS_LB)
def test_supervisor_forces_match_axis_limits(name):
    loader = ff.loader.electric(name)
    at_cell = loader["safety.absolute_force"] * loader["column.grip_arm"] / loader["column.base_arm"]
    assert at_cell < loader["safety.force_range"]  # or the load cell would not show it
    found = loader["safety.force_limit"] / LB_N, loader["safety.absolute_force"] / LB_N
    assert found == pytest.approx(LIMITS_LB[name], rel=1e-9)  # rounding of the units


def test_folder_of_results_does_not_hide_a_built_in_loader(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """``simulate aileron-wheel --out aileron-wheel``, twice."""
    (tmp_path / "aileron-wheel").mkdir()
    monkeypatch.chdir(tmp_path)
    assert open_loader("aileron-wheel").name == "aileron-wheel"
    (tmp_path / "cockpit.toml").write_text('[axes]\nroll = "aileron-wheel"\n')
    assert ff.loader.read_project("cockpit.toml").loaders["roll"].name == "aileron-wheel"
