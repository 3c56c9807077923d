"""The loader file: round trips, other ways to state a part, and what a user reads when something is wrong."""

import dataclasses
import math
import re
import tomllib
from itertools import cycle
from pathlib import Path

import numpy as np
import pytest
import tomlkit
from hypothesis import given
from hypothesis import strategies as st

from forcefeel.errors import MOST_LINES, InputError
from forcefeel.loader.built_in import elevator
from forcefeel.loader.curves import CURVES
from forcefeel.loader.loader import Loader, load
from forcefeel.loader.parameters import (
    ALTERNATIVES,
    DRIVES,
    HYDRAULIC,
    PARTS,
    TABLE,
    absent,
    alternatives,
    has,
    is_switch,
    limits_si,
    meaning,
    parts,
    range_text,
    required,
    table,
    unit,
    without,
)
from forcefeel.units import UnitSystem, to_text
from tests.optional_rows import bare, bare_of, companions, going_together
from tests.parametrization import mostly_slow

ROUNDING = 4e-15  # relative; a conversion to SI multiplies about ten times, each good to 1.1e-16
TEN_DIGITS = 5e-10 + ROUNDING  # relative; half a unit of the tenth digit, at worst
SYSTEMS = list(UnitSystem)
BUILT_IN = elevator().to_toml(UnitSystem.US)
REPORT_PI = 2e-6  # relative; the report squares pi as 3.14159
BEYOND = 1e-8  # relative; past a limit by more than ten digits leave open
INCH, POUND = 0.0254, 4.4482216152605  # m, N


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where a test writes its file; shared, since each test writes it anew."""
    return tmp_path_factory.mktemp("loaders") / "my.toml"


def edited(*changes: tuple[str, str]) -> str:
    """The built-in loader's file with lines replaced; each must occur exactly once."""
    text = BUILT_IN
    for old, new in changes:
        assert text.count(f"\n{old}\n") == 1, old
        text = text.replace(f"\n{old}\n", f"\n{new}\n")
    return text


def read(path: Path, text: str | bytes) -> Loader:
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return load(path)


def complaints(path: Path, text: str | bytes) -> list[str]:
    """The lines of the message, each without the file's name, with which each must begin."""
    with pytest.raises(InputError) as caught:
        read(path, text)
    lines = str(caught.value).splitlines()
    assert all(line.startswith(f"{path}: ") for line in lines)
    return [line.removeprefix(f"{path}: ") for line in lines]


AREA = 'area = "2.36 in^2"'
STIFFNESS, DAMPING = 'stiffness = "6107.86 lb/in"', 'damping = "16.2016 lb s/in"'
CURRENT_GAIN, PRESSURE_GAIN = 'current_gain = "5.45 in^3/(s mA)"', 'pressure_gain = "0.0102 in^5/(lb s)"'
FEEL_INERTIA, FEEL_DAMPING = 'inertia = "60 lb in s^2/rad"', 'damping = "304 lb in s/rad"'


# Round trips


def test_built_in_loader_round_trips_us_units_to_rounding(path: Path) -> None:
    assert read(path, BUILT_IN).si_values == pytest.approx(elevator().si_values, rel=ROUNDING)


def test_built_in_loader_round_trips_si_units_to_ten_digits(path: Path) -> None:
    assert read(path, elevator().to_toml(UnitSystem.SI)).si_values == pytest.approx(
        elevator().si_values, rel=TEN_DIGITS
    )


@pytest.mark.parametrize(
    "name",
    ['say "stick"', "back\\slash \\u0041", "Höhenruder ±1 🛩 👩\u200d✈", "\U000e0001 \u00a0 \ufeff", ""],
)
def test_names_and_sources_round_trip_exactly(path: Path, name: str) -> None:
    loader = Loader(name, name[::-1], elevator().si_values)
    back = read(path, loader.to_toml())
    assert (back.name, back.source) == (name, name[::-1])


def test_multiline_source_round_trips(path: Path) -> None:
    assert read(path, Loader("rig", "two\n\tlines", elevator().si_values).to_toml()).source == "two\n\tlines"


@pytest.mark.parametrize("units", SYSTEMS)
@pytest.mark.parametrize("drive", DRIVES)
def test_the_file_shows_every_row_with_meaning_unit_range_and_source(drive: str, units: UnitSystem) -> None:
    loader = bare(drive)
    text = loader.to_toml(units)
    document = tomllib.loads(text)
    assert list(document) == ["name", "source", "drive", *parts(drive), "tolerances"]
    for row in required(drive).values():
        assert document[row.part][row.name].endswith(unit(row).shown(units))
        assert f"# {row.symbol}: {meaning(row, drive)}\n# range " in text
        assert f" · source {row.source}\n{row.name} = " in text
    for key in set(table(drive)) - {*required(drive), *loader.given}:
        row = TABLE[key]
        assert row.name not in document[row.part]
        assert re.search(rf"\n# {row.name} = .+  # {re.escape(f'{row.symbol}: {meaning(row, drive)}')} \(.+\)\n", text)
    for row in (one for part in parts(drive) for one in alternatives(part).values()):
        assert f"\n# {row.name} = " in text
    statements = text.replace("# ", "").split("\n[")[1:]
    statements = "\n[".join(statements).splitlines()
    longest = max(len(found[1]) for line in statements if (found := re.match(r'[a-z_]+ = "([^"]+)"', line)))
    assert longest <= len("0.0008896443231 N m s^2/rad")  # ten digits and a unit, never sixteen


LIMITS = [limits_si(row) for row in TABLE.values()]


def loader_at(name: str, source: str, shares: list[float], drive: str) -> Loader:
    """A loader with each value at a share of its range."""
    # The twelfth power spreads the values over the decades of a range.
    values = [low + (high - low) * share**12 for (low, high), share in zip(LIMITS, shares, strict=True)]
    return loader_of(name, source, values, drive)


def loader_of(name: str, source: str, values: list[float], drive: str) -> Loader:
    """A loader of these values; switches that are not off are on, optional rows that do not go together are off."""
    by_key = {key: value for key, value in zip(TABLE, values, strict=True) if has(drive, TABLE[key])}
    by_key |= {key: math.ceil(value) for key, value in by_key.items() if is_switch(TABLE[key])}
    together = going_together(by_key)
    return Loader(name, source, np.array([together.get(key, absent(row)) for key, row in TABLE.items()]))


SHARES = st.lists(st.floats(0, 1), min_size=len(TABLE), max_size=len(TABLE))
TEXTS = st.text(st.characters(exclude_categories=["C", "Zl", "Zp"]), max_size=20)
LOADERS = st.builds(loader_at, TEXTS, TEXTS, SHARES, st.sampled_from(DRIVES))


@given(LOADERS, st.sampled_from(SYSTEMS))
def test_random_loader_round_trips_to_ten_digits(path: Path, loader: Loader, units: UnitSystem) -> None:
    back = read(path, loader.to_toml(units))
    assert (back.name, back.source) == (loader.name, loader.source)
    assert back.si_values == pytest.approx(loader.si_values, rel=TEN_DIGITS, abs=0)


@pytest.mark.parametrize("end", [0, 1], ids=["smallest", "largest"])
@pytest.mark.parametrize("units", SYSTEMS)
@pytest.mark.parametrize("drive", DRIVES)
def test_limits_round_trip_in_both_unit_systems(path: Path, drive: str, units: UnitSystem, end: int) -> None:
    loader = loader_of("limit", "", [limits[end] for limits in LIMITS], drive)
    assert read(path, loader.to_toml(units)).si_values == pytest.approx(loader.si_values, rel=TEN_DIGITS, abs=0)


def document_with(key: str) -> dict[str, dict[str, object]]:
    """A bare loader's file without tolerances, and with what the row needs to have an effect."""
    loader = dataclasses.replace(bare_of(key), tolerances={})
    return tomllib.loads(loader.replace({**companions(key), key: TABLE[key].default_si}, si=True).to_toml())


_RANGES = {(unit(row), *limits_si(row)): key for key, row in TABLE.items() if not is_switch(row)}
"""A row for each range in each unit: what is formatted and read of rows of one range is the same."""


@pytest.mark.parametrize(("key", "units"), mostly_slow([*zip(_RANGES.values(), cycle(SYSTEMS), strict=False)], 24))
def test_limit_as_formatted_in_message_is_accepted(path: Path, key: str, units: UnitSystem) -> None:
    row = TABLE[key]
    shown = unit(row).shown(units)
    document = document_with(key)
    for limit, sign in zip(limits_si(row), (-1, 1), strict=True):
        number = unit(row).from_si(limit, units)
        document[row.part][row.name] = typed = f"{to_text(number, 10)} {shown}".strip()
        assert typed.split()[0] in range_text(row)
        assert read(path, tomlkit.dumps(document))[key] == pytest.approx(limit, rel=TEN_DIGITS, abs=0)
        document[row.part][row.name] = f"{number + sign * (BEYOND * abs(number) or BEYOND):.12g} {shown}"
        assert "out of range" in complaints(path, tomlkit.dumps(document))[0]


def test_surplus_errors_are_counted(path: Path) -> None:
    unknown = "".join(f"x{k} = 1\n" for k in range(5000))
    path.write_text(BUILT_IN.replace("[actuator]\n", f"[actuator]\n{unknown}"), encoding="utf-8")
    with pytest.raises(InputError) as caught:
        load(path)
    first, *_, last = str(caught.value).splitlines()
    assert first.startswith(f"{path}: actuator.x0: unknown key")
    assert last == "... and 4,980 more"
    assert len(str(caught.value)) < 10_000


@pytest.mark.parametrize("line", ["a{} = 1", "[a{}]", "[[a{}]]", "x = {{ a{} = 1 }}", '"a"{} = 1'])
def test_key_of_100000_parts_is_refused_quickly(path: Path, line: str) -> None:
    (said,) = complaints(path, BUILT_IN + "\n" + line.format(".a" * 100_000))
    assert said.endswith("has a key of more than 100 parts; expected a loader file")


@pytest.mark.parametrize("text", ["x.y " * 999, "x.y = " * 999, "'" + "." * 999, 'say "' + "." * 999, "\\" + "." * 999])
def test_dots_in_strings_and_comments_are_text(path: Path, text: str) -> None:
    loader = dataclasses.replace(elevator(), source=text)
    assert read(path, loader.to_toml()).source == text
    assert read(path, BUILT_IN + "\n# " + text).name == "elevator-1974"


# The same loader, stated in another way


def test_valve_by_operating_point(path: Path) -> None:
    loader = read(
        path, edited((CURRENT_GAIN, 'operating_current = "20 %"'), (PRESSURE_GAIN, "operating_pressure = 0.33"))
    )
    # Eq. (2): slopes of q = (q_r / i_r) i sqrt(1 - p / p_s) at i = 0.2 i_r, p = 0.33 p_s
    root = math.sqrt(1 - 0.33)
    current_gain, pressure_gain = 100 / 15 * root, 100 * 0.2 / (2 * 1200 * root)  # in^3/(s mA), in^5/(lb s)
    assert (current_gain, pressure_gain) == pytest.approx((5.457, 0.01018), rel=1e-4)  # as many digits as typed
    assert loader["valve.current_gain"] == pytest.approx(current_gain * INCH**3 * 1e3, rel=ROUNDING)
    assert loader["valve.pressure_gain"] == pytest.approx(pressure_gain * INCH**5 / POUND, rel=ROUNDING)
    assert_only_these_differ(loader, "valve.current_gain", "valve.pressure_gain")


def test_linkage_by_resonance(path: Path) -> None:
    loader = read(
        path, edited((STIFFNESS, 'resonance_frequency = "12 Hz"'), (DAMPING, 'resonance_damping_ratio = "0.1"'))
    )
    # J theta'' + (alpha R_b)^2 (c theta' + k theta) = 0 with J = 37.4 lb in s^2, alpha R_b = 5.9 in
    mass, w = 37.4 / 5.9**2, 2 * math.pi * 12
    assert (mass * w**2, 2 * 0.1 * w * mass) == pytest.approx((6107.86, 16.2016), rel=REPORT_PI)
    assert loader["linkage.stiffness"] == pytest.approx(mass * w**2 * POUND / INCH, rel=ROUNDING)
    assert loader["linkage.damping"] == pytest.approx(2 * 0.1 * w * mass * POUND / INCH, rel=ROUNDING)
    assert_only_these_differ(loader, "linkage.stiffness", "linkage.damping")


@pytest.mark.slow
def test_feel_by_frequency_damping_ratio_and_stiffness(path: Path) -> None:
    loader = read(path, edited((FEEL_INERTIA, 'natural_frequency = "2 Hz"'), (FEEL_DAMPING, "damping_ratio = 0.2")))
    # I = G / w^2, B = 2 zeta sqrt(G I)
    w = 2 * math.pi * 2
    inertia = 9600 / w**2
    assert loader["feel.inertia"] == pytest.approx(inertia * POUND * INCH, rel=ROUNDING)
    assert loader["feel.damping"] == pytest.approx(2 * 0.2 * math.sqrt(9600 * inertia) * POUND * INCH, rel=ROUNDING)
    assert_only_these_differ(loader, "feel.inertia", "feel.damping")


def assert_only_these_differ(loader: Loader, *keys: str) -> None:
    for key in TABLE:
        if key not in keys:
            assert loader[key] == pytest.approx(elevator()[key], rel=ROUNDING), key


def test_all_alternative_values_in_other_units_are_read(path: Path) -> None:
    one = read(
        path,
        edited(
            (CURRENT_GAIN, 'operating_current = "20 %"'),
            (PRESSURE_GAIN, 'operating_pressure = "33 %"'),
            (STIFFNESS, 'resonance_frequency = "720 rpm"'),
            (DAMPING, 'resonance_damping_ratio = "10 %"'),
            (FEEL_INERTIA, 'natural_frequency = "720 deg/s"'),
            (FEEL_DAMPING, 'damping_ratio = "20 %"'),
        ),
    )
    assert one["valve.current_gain"] == pytest.approx(100 / 15 * math.sqrt(0.67) * INCH**3 * 1e3, rel=ROUNDING)
    # Back to what was stated
    mass = one["column.inertia"] / (one["linkage.ratio"] * one["column.base_arm"]) ** 2
    assert math.sqrt(one["linkage.stiffness"] / mass) == pytest.approx(2 * math.pi * 12, rel=ROUNDING)
    assert math.sqrt(one["feel.stiffness"] / one["feel.inertia"]) == pytest.approx(2 * math.pi * 2, rel=ROUNDING)


VALVE_CHOICE = "give either current_gain and pressure_gain, or operating_current and operating_pressure"
LINKAGE_CHOICE = "give either stiffness and damping, or resonance_frequency and resonance_damping_ratio"
FEEL_CHOICE = "give either inertia and damping, or natural_frequency and damping_ratio"


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            [("[valve]", '[valve]\noperating_current = "0.2"\noperating_pressure = "0.33"')],
            "valve: stated in more than one way (current_gain, pressure_gain, operating_current, operating_pressure); "
            + VALVE_CHOICE,
        ),
        (
            [(CURRENT_GAIN, 'operating_current = "0.2"')],
            f"valve: stated in more than one way (pressure_gain, operating_current); {VALVE_CHOICE}",
        ),
        (
            [(STIFFNESS, f'{STIFFNESS}\nresonance_frequency = "12 Hz"')],
            f"linkage: stated in more than one way (stiffness, damping, resonance_frequency); {LINKAGE_CHOICE}",
        ),
        (
            [(FEEL_DAMPING, "damping_ratio = 0.2")],
            f"feel: stated in more than one way (inertia, damping_ratio); {FEEL_CHOICE}",
        ),
        ([(STIFFNESS, "")], f'linkage: missing value; add stiffness = "6107.86 lb/in"; {LINKAGE_CHOICE}'),
        (
            [(STIFFNESS, ""), (DAMPING, 'resonance_frequency = "12 Hz"')],
            f'linkage: missing value; add resonance_damping_ratio = "0.1"; {LINKAGE_CHOICE}',
        ),
        (
            [(FEEL_INERTIA, ""), (FEEL_DAMPING, "")],
            'feel: missing value; add inertia = "60 lb in s^2/rad" and damping = "304 lb in s/rad"; ' + FEEL_CHOICE,
        ),
        (
            [(CURRENT_GAIN, "operating_current = 1.01"), (PRESSURE_GAIN, "operating_pressure = 0.33")],
            "valve.operating_current: out of range: expected 0.001 to 1, got 1.01",
        ),
        (
            [(CURRENT_GAIN, "operating_current = 0.2"), (PRESSURE_GAIN, "operating_pressure = 1.0")],
            "valve.operating_pressure: out of range: expected 0 to 0.99, got 1.0",
        ),
        (
            [(FEEL_INERTIA, "natural_frequency = 2"), (FEEL_DAMPING, "damping_ratio = 0.2")],
            "feel.natural_frequency: expected a number with its unit such as '2 Hz', got 2, which has no unit",
        ),
    ],
)
def test_duplicate_or_incomplete_alternatives_are_refused(
    path: Path, changes: list[tuple[str, str]], message: str
) -> None:
    assert complaints(path, edited(*changes)) == [message]


def test_derived_values_are_checked_against_range(path: Path) -> None:
    text = edited(
        (STIFFNESS, 'resonance_frequency = "1000 Hz"'),
        (DAMPING, "resonance_damping_ratio = 1"),
        ('inertia = "37.4 lb in s^2/rad"', 'inertia = "1e5 lb in s^2/rad"'),
    )
    mass, w = 1e5 / 5.9**2, 2 * math.pi * 1000
    lead = "linkage: resonance_frequency and resonance_damping_ratio lead to"
    assert complaints(path, text) == [
        f"{lead} stiffness = {mass * w**2:.10g} lb/in; expected 1 to 100000000 lb/in (1.751268352 to 175126835.2 N/cm)",
        f"{lead} damping = {2 * w * mass:.10g} lb s/in; "
        "expected 0.001 to 1000000 lb s/in (0.001751268352 to 1751268.352 N s/cm)",
    ]


DOCUMENTATION = Path(__file__).parents[2] / "docs" / "reference" / "loader-file.md"
BLOCKS = re.findall(r"```toml\n(.+?)```", DOCUMENTATION.read_text(encoding="utf-8"), re.DOTALL)


@pytest.mark.parametrize("block", BLOCKS)
def test_documentation_examples_are_read(path: Path, block: str) -> None:
    document = tomllib.loads(BUILT_IN)
    for part, stated in tomllib.loads(block).items():
        document[part] |= stated
    assert read(path, tomlkit.dumps(document)).si_values.size == len(TABLE)


def test_the_documentation_shows_curves_and_tolerances() -> None:
    shown = [part for block in BLOCKS for part in tomllib.loads(block)]
    assert {"column", "controller", "feel", "tolerances"} <= set(shown)


# Bad values and keys

WANTED = "actuator.area: expected a number with its unit such as '2.36 in^2', got"
AREA_RANGE = "actuator.area: out of range: expected 0.001 to 1000 in^2 (0.0064516 to 6451.6 cm^2), got"


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ('"2.36 lb"', f"{WANTED} '2.36 lb': 'lb' measures a force, not an area"),
        ('"2.36"', f"{WANTED} '2.36', which has no unit"),
        ("2.36", f"{WANTED} 2.36, which has no unit"),
        ("2", f"{WANTED} 2, which has no unit"),
        ("nan", f"{WANTED} nan, which is not finite"),
        ("-inf", f"{WANTED} -inf, which is not finite"),
        ("1e999", f"{WANTED} inf, which is not finite"),
        ("0x" + "f" * 9000, f"{WANTED} a huge number, which is not finite"),
        ('"nan in^2"', f"{WANTED} 'nan in^2', which is not finite"),
        ('"inf in^2"', f"{WANTED} 'inf in^2', which is not finite"),
        ('"1e999 in^2"', f"{WANTED} '1e999 in^2', which is not finite"),
        ('"two in^2"', f"{WANTED} 'two in^2'"),
        ('"2,36 in^2"', f"{WANTED} '2,36 in^2'"),
        ('"２ in^2"', f"{WANTED} '２ in^2'"),
        ('"2 in^2; import os"', f"{WANTED} '2 in^2; import os'"),
        ('""', f"{WANTED} ''"),
        ("true", f"{WANTED} true"),
        ("[2.36]", f"{WANTED} an array"),
        ("{ value = 2.36 }", f"{WANTED} a table"),
        ("2024-01-02", f"{WANTED} the date or time 2024-01-02"),
        ("03:04:00", f"{WANTED} the date or time 03:04:00"),
        ('"0 in^2"', f"{AREA_RANGE} '0 in^2'"),
        ('"-1 in^2"', f"{AREA_RANGE} '-1 in^2'"),
        ('"1001 in^2"', f"{AREA_RANGE} '1001 in^2'"),
        ('"6452 cm^2"', f"{AREA_RANGE} '6452 cm^2'"),
    ],
)
def test_bad_value_gives_one_line_error(path: Path, value: str, message: str) -> None:
    assert complaints(path, edited((AREA, f"area = {value}"))) == [message]


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ('"0.59 rad"', "expected a number such as '0.59', got '0.59 rad': 'rad' measures an angle, not a ratio"),
        ("true", "expected a number such as '0.59', got true"),
        ("nan", "expected a number such as '0.59', got nan, which is not finite"),
        ("1" + "0" * 400, "expected a number such as '0.59', got a huge number, which is not finite"),
        ("0", "out of range: expected 0.01 to 1, got 0"),
        ('"101 %"', "out of range: expected 0.01 to 1, got '101 %'"),
    ],
)
def test_bad_ratio_gives_one_line_error(path: Path, value: str, message: str) -> None:
    assert complaints(path, edited(('ratio = "0.59"', f"ratio = {value}"))) == [f"linkage.ratio: {message}"]


@pytest.mark.parametrize("value", ["0.59", '"59 %"', '"0.59"', '"0.59 in/in"'])
def test_a_ratio_may_be_a_bare_number(path: Path, value: str) -> None:
    loader = read(path, edited(('ratio = "0.59"', f"ratio = {value}")))
    assert loader["linkage.ratio"] == pytest.approx(0.59, rel=ROUNDING)


@pytest.mark.parametrize(
    "key", mostly_slow([key for key, row in TABLE.items() if row.minimum_us >= 0 and not is_switch(row)], 24)
)
def test_zero_and_negative_values_outside_range_are_refused(path: Path, key: str) -> None:
    row = TABLE[key]
    document = document_with(key)
    for number in ("0", "-1"):
        document[row.part][row.name] = f"{number} {row.unit_us}".strip()
        if number == "0" and row.minimum_us == 0:
            assert read(path, tomlkit.dumps(document))[key] == 0
        else:
            came = document[row.part][row.name]
            remedy = f"; {without(row)}" if number == "0" and row.off_us == 0 else ""
            message = f"{key}: out of range: expected {range_text(row)}, got '{came}'{remedy}"
            assert complaints(path, tomlkit.dumps(document)) == [message]


@pytest.mark.parametrize(
    ("changes", "messages"),
    [
        ([(AREA, "")], [f"actuator.area: missing value; add {AREA}"]),
        (
            [(AREA, 'aera = "2.36 in^2"')],
            [f"actuator.area: missing value; add {AREA}", "actuator.aera: unknown key; did you mean area?"],
        ),
        (
            [(AREA, f"{AREA}\nfoo = 3")],
            [
                "actuator.foo: unknown key; known are area, oil_volume, bulk_modulus, relief_pressure, relief_gain, seal_friction",
            ],
        ),
        (
            [(AREA, f'{AREA}\ngrip_arm = "3 in"')],
            ["actuator.grip_arm: unknown key; it belongs in the table [column]"],
        ),
        (
            [(AREA, f'{AREA}\ndamping_ratio = "0.9"')],
            ["actuator.damping_ratio: unknown key; it belongs in the table [valve] or [feel]"],
        ),
        (
            [("[valve]", "[valves]")],
            ["valve: missing value; add the table [valve]", "valves: unknown key; did you mean valve?"],
        ),
        ([("[valve]", "[[valve]]")], ["valve: expected the table [valve], got an array"]),
        (
            [("[pilot]", '["a.b\\nc"]\n"d e" = 1\n[pilot]')],
            [
                r"'a.b\nc': unknown key; known are name, source, drive, amplifier, valve, actuator, linkage, column, "
                "load_cell, potentiometer, column_sensor, grip_sensor, controller, feel, surface, pilot, safety, tolerances, bus"
            ],
        ),
        ([('name = "elevator-1974"', "")], ['name: missing value; add name = "elevator"']),
        ([('name = "elevator-1974"', "name = 5")], ['name: expected text such as name = "elevator", got 5']),
        ([('name = "elevator-1974"', 'name = ["a"]')], ['name: expected text such as name = "elevator", got an array']),
        (
            [('name = "elevator-1974"', f'name = "elevator-1974"\n{AREA}')],
            ["area: unknown key; it belongs in the table [actuator] or [surface]"],
        ),
    ],
)
def test_bad_keys_give_one_line_each(path: Path, changes: list[tuple[str, str]], messages: list[str]) -> None:
    assert complaints(path, edited(*changes)) == messages


def test_several_errors_give_one_line_each(path: Path) -> None:
    text = edited(
        (AREA, 'area = "2 lb"'),
        ("[valve]", '[valve]\noperating_current = "0.2"\nspeed = 1'),
        ('grip_arm = "31.375 in"', 'grib_arm = "31.375 in"'),
    )
    assert complaints(path, text) == [
        "valve.speed: unknown key; known are current_gain, pressure_gain, natural_frequency, damping_ratio, "
        "rated_flow, rated_current, supply_pressure, orifice, flow_limit, operating_current, operating_pressure",
        f"{WANTED} '2 lb': 'lb' measures a force, not an area",
        'column.grip_arm: missing value; add grip_arm = "31.375 in"',
        "column.grib_arm: unknown key; did you mean grip_arm?",
        f"valve: stated in more than one way (current_gain, pressure_gain, operating_current); {VALVE_CHOICE}",
    ]


def test_empty_file_error_lists_required_tables(path: Path) -> None:
    assert complaints(path, "") == [
        'name: missing value; add name = "elevator"',
        *(
            f"{part}: missing value; add the table [{part}]"
            for part in {row.part: None for row in required(HYDRAULIC).values()}
        ),
    ]


def test_source_may_be_left_out(path: Path) -> None:
    source = next(line for line in BUILT_IN.splitlines() if line.startswith("source"))
    assert read(path, edited((source, ""))).source == ""


# Bad files


@pytest.mark.parametrize(
    ("text", "start"),
    [
        (edited((AREA, "area = ")), "is not TOML: "),
        (edited((AREA, f"{AREA}\n{AREA}")), "is not TOML: "),
        (edited((AREA, "area 2.36 in^2")), "is not TOML: "),
        (edited((AREA, "area = 2.36 in^2")), "is not TOML: "),
        (edited((AREA, 'area = "2.36 in^2')), "is not TOML: "),
    ],
    ids=["no value", "twice", "no equals sign", "no quotes", "open quotes"],
)
def test_bad_toml_error_gives_line_number(path: Path, text: str, start: str) -> None:
    number = BUILT_IN.splitlines().index(AREA) + 1
    [message] = complaints(path, text)
    assert message.startswith(start)
    # A key given twice is found at its second line.
    assert f"(at line {number}, column " in message or f"(at line {number + 1}, column " in message


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (b"# caf\xe9\n" + BUILT_IN.encode(), "is not UTF-8 text (byte 5); save the file as UTF-8"),
        (BUILT_IN.encode("utf-16"), "is not UTF-8 text (byte 0); save the file as UTF-8"),
    ],
    ids=["Latin-1", "UTF-16"],
)
def test_other_encodings_are_refused(path: Path, text: bytes, message: str) -> None:
    assert complaints(path, text) == [message]


@pytest.mark.parametrize(
    "text",
    [
        edited((AREA, "area = " + "9" * 5000)),
        "a = " + "[" * 100_000,
        "a = " + "{a = " * 5000,
        "\0",
        "\x7fELF",
    ],
    ids=["number of 5000 digits", "deep arrays", "deep tables", "zero byte", "binary"],
)
def test_unreadable_file_gives_one_line_error(path: Path, text: str) -> None:
    [message] = complaints(path, text)
    assert message.startswith(("cannot be read (", "is not TOML: "))
    assert len(message) < 250  # a line or two of a terminal


@pytest.mark.parametrize(
    "text",
    [b"\xef\xbb\xbf" + BUILT_IN.encode(), BUILT_IN.replace("\n", "\r\n").encode()],
    ids=["byte order mark", "Windows line ends"],
)
def test_windows_encodings_and_line_ends_are_read(path: Path, text: bytes) -> None:
    assert read(path, text) == read(path, BUILT_IN)


def test_missing_file_or_folder_raises_input_error(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"cannot be read \(.+\); expected a loader file$") as caught:
        load(tmp_path / "none.toml")
    assert str(caught.value).startswith(f"{tmp_path / 'none.toml'}: ")
    with pytest.raises(InputError, match=r": is a folder; expected a loader file; name a file in it$"):
        load(tmp_path)
    with pytest.raises(InputError, match=r"cannot be read \(.+\); expected a loader file$"):
        load(str(tmp_path / "a\0b"))
    assert list(tmp_path.iterdir()) == []


# Anything at all

VALUES = st.recursive(
    st.just("2.36 in^2")
    | st.booleans()
    | st.integers(-(2**63), 2**63 - 1)
    | st.floats()
    | st.text(max_size=10)
    | st.dates()
    | st.times()
    | st.datetimes(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=8), inner, max_size=3),
    max_leaves=6,
)
KEYS = st.sampled_from(
    [*(row.name for row in (TABLE | ALTERNATIVES).values()), *PARTS, *CURVES, "name", "source", "drive", "tolerances"]
)
TABLES = st.dictionaries(KEYS | st.text(max_size=8), VALUES, max_size=6)


def good_or_refused(path: Path, text: str | bytes) -> bool:
    """Whether a file is read or refused with lines that name it, the first of very many; any other error passes through."""
    try:
        read(path, text)
    except InputError as error:
        lines = str(error).splitlines()
        more = lines[MOST_LINES:] and re.fullmatch(r"\.\.\. and [\d,]+ more", lines[-1])
        return all(line.startswith(f"{path}: ") for line in (lines[:-1] if more else lines))
    return True


def test_first_of_many_errors_are_named(path: Path) -> None:
    assert good_or_refused(path, "".join(f"key_{k} = 1\n" for k in range(100)))


@given(st.dictionaries(KEYS | st.text(max_size=8), VALUES | TABLES, max_size=6), st.booleans())
def test_random_toml_is_read_or_refused(path: Path, changes: dict[str, object], keep: bool) -> None:
    assert good_or_refused(path, tomlkit.dumps((tomllib.loads(BUILT_IN) if keep else {}) | changes))


@given(st.sampled_from([*parts(HYDRAULIC), "tolerances"]), TABLES)
def test_random_table_in_valid_file_is_read_or_refused(path: Path, part: str, changes: dict[str, object]) -> None:
    document = tomllib.loads(BUILT_IN)
    document[part] |= changes
    assert good_or_refused(path, tomlkit.dumps(document))


@given(st.integers(0, len(BUILT_IN.encode())), st.integers(0, 9), st.binary(max_size=4))
def test_a_file_with_damaged_bytes_is_read_or_refused(path: Path, start: int, length: int, damage: bytes) -> None:
    good = BUILT_IN.encode()
    assert good_or_refused(path, good[:start] + damage + good[start + length :])
