"""Tolerances: their distributions against closed forms and sampling, and how a loader file states them."""

import dataclasses
import math
import pickle
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy import integrate, stats

import forcefeel as ff
from forcefeel.errors import InputError
from forcefeel.loader import tolerance_text
from forcefeel.loader.built_in import elevator
from forcefeel.loader.loader import Loader, load
from forcefeel.loader.parameters import TABLE, limits_si
from forcefeel.loader.tolerances import Distribution, Tolerance
from forcefeel.units import UnitSystem
from tests.optional_rows import bare_of

ROUNDING = 1e-12
TEN_DIGITS = 1e-9  # relative, of the sizes that a file's ten digits hold
POUND_PER_INCH = 4.4482216152605 / 0.0254  # N/m
POUND = 4.4482216152605  # N

UNIFORM = Tolerance(Distribution.UNIFORM, 2.0, 5.0)
NORMAL = Tolerance(Distribution.NORMAL, 2.0, 5.0, 3.0, 0.8)
TRIANGULAR = Tolerance(Distribution.TRIANGULAR, 2.0, 5.0, 3.0)
ALL = [UNIFORM, NORMAL, TRIANGULAR]


def density(tolerance: Tolerance, x: float) -> float:
    """Up to a factor, from the definition of each distribution."""
    match tolerance.distribution:
        case Distribution.UNIFORM:
            return 1.0
        case Distribution.NORMAL:
            assert tolerance.peak is not None
            assert tolerance.deviation is not None
            return math.exp(-(((x - tolerance.peak) / tolerance.deviation) ** 2) / 2)
    assert tolerance.peak is not None
    rising = (x - tolerance.low) / (tolerance.peak - tolerance.low)
    return min(rising, (tolerance.high - x) / (tolerance.high - tolerance.peak))


@pytest.mark.parametrize("tolerance", ALL, ids=list(Distribution))
def test_quantiles_invert_the_integral_of_the_density(tolerance: Tolerance) -> None:
    whole, _ = integrate.quad(lambda x: density(tolerance, x), tolerance.low, tolerance.high, points=[3.0])
    for u in (0.0, 1e-6, 0.1, 1 / 3, 0.5, 0.9, 0.999, 1.0):
        x = float(tolerance.quantile(u))
        part, _ = integrate.quad(lambda x: density(tolerance, x), tolerance.low, x, points=[min(3.0, x)])
        assert part / whole == pytest.approx(u, abs=1e-9)  # quad's own error


@pytest.mark.parametrize("tolerance", ALL, ids=list(Distribution))
def test_quantiles_rise_from_bound_to_bound_and_keep_the_shape(tolerance: Tolerance) -> None:
    values = tolerance.quantile(np.linspace(0, 1, 1001))
    assert (values[0], values[-1]) == pytest.approx((tolerance.low, tolerance.high), rel=ROUNDING)
    assert np.all(np.diff(values) > 0)
    assert tolerance.quantile(0.5).shape == ()
    assert tolerance.quantile(np.full((2, 3), 0.5)).shape == (2, 3)
    assert tolerance.quantile([]).shape == (0,)


@pytest.mark.parametrize("tolerance", ALL, ids=list(Distribution))
def test_samples_follow_the_distribution(tolerance: Tolerance) -> None:
    samples = tolerance.sample(np.random.default_rng(1974), 4000)
    grid = np.linspace(0, 1, 100_001)
    found = stats.kstest(samples, lambda x: np.interp(x, tolerance.quantile(grid), grid))
    assert found.pvalue > 0.01  # a fixed seed: this is no matter of luck
    assert tolerance.sample(np.random.default_rng(0), (2, 3)).shape == (2, 3)


@pytest.mark.parametrize("peak", [2.0, 5.0])
def test_peak_may_equal_a_bound(peak: float) -> None:
    for tolerance in (dataclasses.replace(TRIANGULAR, peak=peak), dataclasses.replace(NORMAL, peak=peak)):
        values = tolerance.quantile(np.linspace(0, 1, 101))
        assert np.all(np.diff(values) > 0)
        assert np.all((values >= 2) & (values <= 5))


@pytest.mark.parametrize("deviation", [300.0, 1e-6])
def test_wide_normal_is_uniform_and_narrow_normal_is_its_mean(deviation: float) -> None:
    values = dataclasses.replace(NORMAL, deviation=deviation).quantile(np.linspace(0.01, 0.99, 99))
    expected = UNIFORM.quantile(np.linspace(0.01, 0.99, 99)) if deviation > 1 else np.full(99, 3.0)
    assert values == pytest.approx(expected, abs=1e-5)  # (3 / 300)^2 / 2, less than that; 3 deviations


@pytest.mark.parametrize("u", [-1e-9, 1 + 1e-9, math.nan, math.inf, [0.5, 2.0]])
def test_shares_beyond_0_and_1_are_refused(u: Any) -> None:
    with pytest.raises(InputError, match=r"^u: expected shares from 0 to 1, got "):
        UNIFORM.quantile(u)


BOUNDS = "expected a lower bound below the upper one, got"
WIDTHS = "expected a standard deviation above zero and at most 100 times the distance of the bounds, got"


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        (("gauss", 0, 1), "distribution: expected one of uniform, normal, triangular, got 'gauss'"),
        (("uniform", 1, 1), f"{BOUNDS} 1 and 1"),
        (("uniform", 1, 1 + 1e-12), f"{BOUNDS} 1 and 1"),
        (("uniform", 2, 1), f"{BOUNDS} 2 and 1"),
        (("uniform", math.nan, 1), "low: expected a finite number, got nan"),
        (("uniform", 0, math.inf), "high: expected a finite number, got inf"),
        (("uniform", "0 lb", 1), "low: expected a finite number, got '0 lb'"),
        (("uniform", None, 1), "low: expected a finite number, got None"),
        (("uniform", 0, True), "high: expected a finite number, got true"),
        (("uniform", 0, 1, 0.5), "peak: expected none for a uniform tolerance"),
        (("uniform", 0, 1, None, 0.5), "deviation: expected none for a uniform tolerance"),
        (("triangular", 0, 1), "peak: expected a number for a triangular tolerance"),
        (("triangular", 0, 1, 2), "expected a peak between the bounds 0 and 1, got 2"),
        (("triangular", 0, 1, 0.5, 0.1), "deviation: expected none for a triangular tolerance"),
        (("normal", 0, 1, 0.5), "deviation: expected a number for a normal tolerance"),
        (("normal", 0, 1, -1, 0.1), "expected a mean between the bounds 0 and 1, got -1"),
        (("normal", 0, 1, 0.5, 0), f"{WIDTHS} 0 times"),
        (("normal", 0, 1, 0.5, -1), f"{WIDTHS} -1 times"),
        (("normal", 0, 1, 0.5, 101), f"{WIDTHS} 101 times"),
        (
            ("uniform", 0, 1, None, None, 0),
            "expected bounds as values with their unit, got shares of a value that is zero",
        ),
    ],
)
def test_invalid_tolerance_numbers_are_refused(fields: tuple[Any, ...], message: str) -> None:
    with pytest.raises(InputError) as caught:
        Tolerance(*fields)
    assert str(caught.value) == message


def test_about_scales_shares_and_keeps_absolute_bounds() -> None:
    relative = Tolerance(Distribution.NORMAL, 9.0, 12.0, 10.0, 0.5, nominal=10.0)
    moved = relative.about(20.0)
    assert (moved.low, moved.high, moved.peak, moved.deviation, moved.nominal) == (18.0, 24.0, 20.0, 1.0, 20.0)
    other_side = relative.about(-10.0)
    assert (other_side.low, other_side.high, other_side.peak, other_side.deviation) == (-11.0, -8.0, -10.0, 0.5)
    assert UNIFORM.about(20.0) is UNIFORM
    with pytest.raises(InputError, match="got shares of a value that is zero"):
        relative.about(0.0)


# Of a loader


def test_elevator_tolerances_are_stated_as_assumed() -> None:
    loader = elevator()
    assert "assumed" in loader.source
    assert len(loader.tolerances) == 13
    for key, tolerance in loader.tolerances.items():
        share = 0.3 if key in {"valve.current_gain", "valve.rated_flow"} else 0.2
        bounds = (1 - share) * loader[key], (1 + share) * loader[key]
        assert tolerance.distribution is Distribution.UNIFORM
        assert (tolerance.low, tolerance.high) == pytest.approx(bounds, rel=ROUNDING)
        assert tolerance.nominal == loader[key]


def test_tolerances_are_immutable_part_of_loader() -> None:
    loader = elevator()
    bare = dataclasses.replace(loader, tolerances={})
    assert bare != loader
    assert hash(bare) != hash(loader)
    assert pickle.loads(pickle.dumps(loader)) == loader
    assert hash(pickle.loads(pickle.dumps(loader))) == hash(loader)
    backwards = dict(reversed([*loader.tolerances.items()]))
    assert dataclasses.replace(loader, tolerances=backwards) == loader
    assert hash(dataclasses.replace(loader, tolerances=backwards)) == hash(loader)
    with pytest.raises(TypeError):
        loader.tolerances["linkage.damping"] = UNIFORM  # type: ignore[index]
    with pytest.raises(TypeError):
        pickle.loads(pickle.dumps(loader)).tolerances["linkage.damping"] = UNIFORM


def test_loader_copies_its_tolerances() -> None:
    mine = dict(elevator().tolerances)
    loader = dataclasses.replace(elevator(), tolerances=mine)
    mine.clear()
    assert loader == elevator()


def test_replaced_value_scales_its_tolerance() -> None:
    loader = elevator().replace({"linkage.stiffness": 1e6}, si=True)
    assert loader.tolerances["linkage.stiffness"].low == pytest.approx(8e5, rel=ROUNDING)
    fixed = elevator().with_tolerances({"linkage.stiffness": {"uniform": ["5000 lb/in", "7000 lb/in"]}})
    assert fixed.replace({"linkage.stiffness": 1e6}, si=True).tolerances == fixed.tolerances
    scaled = elevator().with_tolerances({"feel.stiffness": "10 %"}).scale_feel(0.5)
    assert scaled.tolerances["feel.stiffness"].high == pytest.approx(1.1 * scaled["feel.stiffness"], rel=ROUNDING)


def test_with_tolerances_adds_changes_and_drops() -> None:
    loader = elevator().with_tolerances(
        {"linkage.stiffness": None, "linkage.damping": "5 %", "column.coulomb_friction": {"uniform": ["1 lb", "5 lb"]}}
    )
    assert "linkage.stiffness" not in loader.tolerances
    assert loader.tolerances["linkage.damping"].high == pytest.approx(1.05 * loader["linkage.damping"])
    friction = loader.tolerances["column.coulomb_friction"]
    assert (friction.low, friction.high, friction.nominal) == (POUND, 5 * POUND, None)
    assert loader["column.coulomb_friction"] == 0
    assert loader.with_tolerances({"linkage.stiffness": None}) == loader
    again = elevator().with_tolerances({"linkage.damping": loader.tolerances["linkage.damping"]})
    assert again.tolerances["linkage.damping"] == loader.tolerances["linkage.damping"]


def test_shares_are_dropped_when_value_becomes_zero() -> None:
    loader = elevator().replace({"column.coulomb_friction": "3 lb", "column.stop_high": "20 deg"})
    loader = loader.with_tolerances({"column.coulomb_friction": "20 %", "column.stop_high": "5 %"})
    for key in ("column.coulomb_friction", "column.stop_high"):
        without = loader.replace({key: None})
        assert without[key] in {0, math.inf}
        assert without.tolerances == {it: told for it, told in loader.tolerances.items() if it != key}
    assert loader.replace({"column.coulomb_friction": "0 lb"}) == loader.replace({"column.coulomb_friction": None})
    by_themselves = loader.with_tolerances({"column.coulomb_friction": {"uniform": ["1 lb", "5 lb"]}})
    assert "column.coulomb_friction" in by_themselves.replace({"column.coulomb_friction": "0 lb"}).tolerances


def test_default_value_has_shares_only_where_effective() -> None:
    with pytest.raises(
        InputError, match=r"^tolerances\.column\.stop_stiffness: has no effect without column\.stop_low"
    ):
        elevator().with_tolerances({"column.stop_stiffness": "20 %"})
    loader = elevator().replace({"column.stop_high": "20 deg"}).with_tolerances({"column.stop_stiffness": "20 %"})
    assert loader.tolerances["column.stop_stiffness"].nominal == loader["column.stop_stiffness"]


def test_tolerance_incompatible_with_value_is_refused() -> None:
    loader, away = elevator(), elevator().replace({"linkage.stiffness": "7000 lb/in"}).tolerances["linkage.stiffness"]
    with pytest.raises(InputError) as caught:
        loader.with_tolerances({"linkage.stiffness": away})
    assert str(caught.value) == (
        "tolerances.linkage.stiffness: expected shares of the loader's value, 6107.86 lb/in, "
        "got shares of 7000 lb/in; make it with about()"
    )
    fitted = away.about(loader["linkage.stiffness"])
    assert loader.with_tolerances({"linkage.stiffness": fitted}) == loader
    with pytest.raises(InputError, match=r"^tolerances\.linkage\.stiffness: expected a Tolerance, got 5$"):
        dataclasses.replace(loader, tolerances={"linkage.stiffness": 5})  # type: ignore[dict-item]
    with pytest.raises(InputError, match=r"^tolerances: expected a mapping by part\.name, got 5$"):
        dataclasses.replace(loader, tolerances=5)  # type: ignore[arg-type]
    with pytest.raises(InputError, match=r"^unknown parameter 'linkage\.stifness'; did you mean linkage\.stiffness\?$"):
        loader.with_tolerances({"linkage.stifness": "5 %"})


def test_value_at_range_end_is_valid_with_shares_out_of_range(tmp_path: Path) -> None:
    loader = elevator().replace({"amplifier.admittance": "1000 mA/V"})
    assert loader.tolerances["amplifier.admittance"].high == pytest.approx(1.2, rel=ROUNDING)
    message = (
        "tolerances.amplifier.admittance: out of range: expected bounds within 0.001 to 1000 mA/V, "
        "got 1200 mA/V; narrow it"
    )
    (tmp_path / "my.toml").write_text(loader.to_toml(), encoding="utf-8")
    for state in (
        lambda: loader.with_tolerances({"amplifier.admittance": "20 %"}),
        lambda: loader.with_tolerances({"amplifier.admittance": loader.tolerances["amplifier.admittance"]}),
        lambda: load(tmp_path / "my.toml"),
    ):
        with pytest.raises(InputError) as caught:
            state()
        assert str(caught.value).removeprefix(f"{tmp_path / 'my.toml'}: ") == message
    with pytest.raises(InputError, match="out of range: expected bounds within"):
        dataclasses.replace(elevator(), tolerances={"amplifier.admittance": UNIFORM})


def test_json_contains_tolerances() -> None:
    loader = elevator().with_tolerances({"pilot.force": {"normal": "5 %", "low": "-10 %", "high": "10 %"}})
    found: Any = loader.as_json(UnitSystem.US)["tolerances"]
    assert found["pilot.force"]["distribution"] == "normal"
    numbers = {name: found["pilot.force"][name]["value"] for name in ("low", "high", "peak", "deviation")}
    assert numbers == pytest.approx({"low": 86.4, "high": 105.6, "peak": 96, "deviation": 4.8})
    assert set(found["linkage.stiffness"]) == {"distribution", "low", "high"}


# In a loader file


def read(tmp_path: Path, statement: str) -> Loader:
    """A loader whose only tolerances are these lines."""
    text = dataclasses.replace(elevator(), tolerances={}).to_toml()
    path = tmp_path / "my.toml"
    path.write_text(f"{text}{statement}\n", encoding="utf-8")
    return load(path)


def assert_alike(tolerance: Tolerance, expected: tuple[Any, ...], share: float) -> None:
    """Whether the fields of a tolerance are these, up to a share of the largest."""
    size = max(abs(number) for number in expected[1:] if number is not None)
    assert tolerance.distribution == expected[0]
    for found, wanted in zip(dataclasses.astuple(tolerance)[1:], expected[1:], strict=True):
        assert (found is None) == (wanted is None)
        assert found is None or found == pytest.approx(wanted, abs=share * size)


K = 6107.86 * POUND_PER_INCH


@pytest.mark.parametrize(
    ("stated", "expected"),
    [
        ('"20 %"', ("uniform", 0.8 * K, 1.2 * K, None, None, K)),
        ('"20%"', ("uniform", 0.8 * K, 1.2 * K, None, None, K)),
        ('{ uniform = ["-10 %", "20 %"] }', ("uniform", 0.9 * K, 1.2 * K, None, None, K)),
        ('{ uniform = ["10 %", "20 %"] }', ("uniform", 1.1 * K, 1.2 * K, None, None, K)),
        ('{ uniform = ["9 kN/cm", "12 kN/cm"] }', ("uniform", 9e5, 1.2e6, None, None, None)),
        ('{ uniform = ["9 kN/cm", "20 %"] }', ("uniform", 9e5, 1.2 * K, None, None, None)),
        ('{ triangular = ["-10 %", "20 %"] }', ("triangular", 0.9 * K, 1.2 * K, K, None, K)),
        ('{ triangular = ["-10 %", "5 %", "20 %"] }', ("triangular", 0.9 * K, 1.2 * K, 1.05 * K, None, K)),
        ('{ triangular = ["9 kN/cm", "12 kN/cm"] }', ("triangular", 9e5, 1.2e6, K, None, None)),
        ('{ triangular = ["9 kN/cm", "10 kN/cm", "12 kN/cm"] }', ("triangular", 9e5, 1.2e6, 1e6, None, None)),
        ('{ normal = "5 %", low = "-10 %", high = "10 %" }', ("normal", 0.9 * K, 1.1 * K, K, 0.05 * K, K)),
        ('{ normal = "5 %", low = "9 kN/cm", high = "12 kN/cm" }', ("normal", 9e5, 1.2e6, K, 0.05 * K, None)),
        ('{ normal = "1 kN/cm", low = "-10 %", high = "10 %" }', ("normal", 0.9 * K, 1.1 * K, K, 1e5, None)),
        (
            '{ normal = "5 %", mean = "2 %", low = "-10 %", high = "10 %" }',
            ("normal", 0.9 * K, 1.1 * K, 1.02 * K, 0.05 * K, K),
        ),
        (
            '{ normal = "1 kN/cm", mean = "10 kN/cm", low = "9 kN/cm", high = "12 kN/cm" }',
            ("normal", 9e5, 1.2e6, 1e6, 1e5, None),
        ),
    ],
)
def test_every_tolerance_form_round_trips(tmp_path: Path, stated: str, expected: tuple[Any, ...]) -> None:
    loader = read(tmp_path, f"linkage.stiffness = {stated}")
    assert_alike(loader.tolerances["linkage.stiffness"], expected, ROUNDING)
    for units in UnitSystem:
        (tmp_path / "my.toml").write_text(loader.to_toml(units), encoding="utf-8")
        once = load(tmp_path / "my.toml")
        assert_alike(once.tolerances["linkage.stiffness"], expected, TEN_DIGITS)
        (tmp_path / "my.toml").write_text(once.to_toml(units), encoding="utf-8")
        assert load(tmp_path / "my.toml") == once


@pytest.mark.parametrize(
    "stated", ['"20 %"', '{ uniform = ["-10 %", "20 %"] }', '{ normal = "5 %", low = "-10 %", high = "10 %" }']
)
def test_shares_round_trip_as_shares(tmp_path: Path, stated: str) -> None:
    line = f"linkage.stiffness = {stated}"
    assert f"\n{line}\n" in read(tmp_path, line).to_toml(UnitSystem.SI)


def test_forcefeel_new_writes_the_assumed_tolerances() -> None:
    assert '\n[tolerances]\namplifier.admittance = "20 %"\n' in elevator().to_toml()


EXPECTED = (
    'expected a tolerance such as "20 %", { uniform = ["-10 %", "20 %"] } or '
    '{ normal = "5 %", low = "-10 %", high = "10 %" }, got'
)
RANGE = "out of range: expected bounds within 1 to 100000000 lb/in (1.751268352 to 175126835.2 N/cm), got"
NUMBER = "expected a number with its unit such as '6107.86 lb/in', got"


@pytest.mark.parametrize(
    ("stated", "message"),
    [
        ('"-20 %"', f"{EXPECTED} '-20 %'"),
        ('"0 %"', f"{EXPECTED} '0 %'"),
        ('"20 lb/in"', f"{EXPECTED} '20 lb/in'"),
        ('"much"', f"{EXPECTED} 'much'"),
        ('""', f"{EXPECTED} ''"),
        ("20", f"{EXPECTED} 20"),
        ("true", f"{EXPECTED} true"),
        ("[1, 2]", f"{EXPECTED} an array"),
        ("{}", f"{EXPECTED} a table"),
        ('{ gauss = "5 %" }', f"{EXPECTED} a table of 'gauss'"),
        ('{ uniform = ["-10 %", "5 %"], normal = "5 %" }', f"{EXPECTED} a table of 'uniform', 'normal'"),
        ('"inf %"', "expected a number such as '20 %', got 'inf %', which is not finite"),
        ('"two %"', "expected a number such as '20 %', got 'two %'"),
        ('{ uniform = ["-10 %", "5 %"], low = "5 %" }', "unknown key 'low'; known are uniform"),
        (
            '{ normal = "5 %", low = "-10 %", high = "10 %", peak = "0 %" }',
            "unknown key 'peak'; known are normal, low, high, mean",
        ),
        ('{ uniform = "5 %" }', 'uniform: expected two bounds such as ["-10 %", "20 %"], got \'5 %\''),
        ('{ uniform = ["5 %"] }', 'uniform: expected two bounds such as ["-10 %", "20 %"], got an array'),
        ('{ uniform = ["1 %", "2 %", "5 %"] }', 'uniform: expected two bounds such as ["-10 %", "20 %"], got an array'),
        (
            '{ triangular = ["5 %"] }',
            'triangular: expected two bounds, or lower bound, peak and upper bound, such as ["-10 %", "20 %"], got an array',
        ),
        ("{ uniform = [1, 2] }", f"uniform: {NUMBER} 1, which has no unit"),
        ('{ uniform = ["1 lb", "2 lb"] }', f"uniform: {NUMBER} '1 lb': 'lb' measures a force, not a spring rate"),
        ('{ uniform = ["7000 lb/in", "5000 lb/in"] }', f"{BOUNDS} 7000 lb/in and 5000 lb/in"),
        ('{ uniform = ["5 %", "5 %"] }', f"{BOUNDS} 6413.253 lb/in and 6413.253 lb/in"),
        ('{ uniform = ["0 lb/in", "1 lb/in"] }', f"{RANGE} 0 lb/in; narrow it"),
        ('{ uniform = ["1 lb/in", "1e9 lb/in"] }', f"{RANGE} 1000000000 lb/in; narrow it"),
        ('"100 %"', f"{RANGE} 0 lb/in; narrow it"),
        (
            '{ triangular = ["6500 lb/in", "7000 lb/in"] }',
            "expected a peak between the bounds 6500 lb/in and 7000 lb/in, got 6107.86 lb/in",
        ),
        (
            '{ normal = "1 lb/in", mean = "1 lb/in", low = "5 lb/in", high = "7 lb/in" }',
            "expected a mean between the bounds 5 lb/in and 7 lb/in, got 1 lb/in",
        ),
        ('{ normal = "5 %" }', "normal: expected bounds at which it is cut off; add low and high"),
        ('{ normal = "5 %", low = "-10 %" }', "normal: expected bounds at which it is cut off; add high"),
        ('{ normal = "-5 %", low = "-10 %", high = "10 %" }', f"{WIDTHS} -0.25 times"),
        ('{ normal = 5, low = "-10 %", high = "10 %" }', f"normal: {NUMBER} 5, which has no unit"),
        ('{ normal = "5 %", low = true, high = "10 %" }', f"low: {NUMBER} true"),
    ],
)
def test_bad_tolerance_gives_one_line_error(tmp_path: Path, stated: str, message: str) -> None:
    with pytest.raises(InputError) as caught:
        read(tmp_path, f"linkage.stiffness = {stated}")
    assert str(caught.value) == f"{tmp_path / 'my.toml'}: tolerances.linkage.stiffness: {message}"


@pytest.mark.parametrize(
    ("line", "message"),
    [
        (
            'linkage.stifness = "5 %"',
            "tolerances: unknown parameter 'linkage.stifness'; did you mean linkage.stiffness?",
        ),
        (
            'linkag.stiffness = "5 %"',
            "tolerances: unknown parameter 'linkag.stiffness'; did you mean linkage.stiffness?",
        ),
        (
            'stiffness = "5 %"',
            "tolerances: unknown parameter 'stiffness'; did you mean linkage.stiffness or feel.stiffness?",
        ),
        (
            'linkage.resonance_frequency = "5 %"',
            "tolerances: unknown parameter 'linkage.resonance_frequency'; "
            "a loader file may state it; a loader holds stiffness and damping instead",
        ),
        ('linkage = "5 %"', "tolerances: unknown parameter 'linkage'; did you mean linkage.ratio?"),
        (
            '"linkage.stiffness" = "5 %"\nlinkage.stiffness = "5 %"',
            "tolerances: 'linkage.stiffness' is given twice; leave one out",
        ),
        ('valve.orifice = "5 %"', "tolerances.valve.orifice: a switch is on or off; leave its tolerance out"),
        (
            'column.coulomb_friction = "20 %"',
            "tolerances.column.coulomb_friction: a share of column.coulomb_friction, which is off, says nothing; "
            'give column.coulomb_friction, or state bounds as values, such as { uniform = ["1.5 lb", "4.5 lb"] }',
        ),
        (
            'column.stop_high = { uniform = ["10 deg", "20 %"] }',
            "tolerances.column.stop_high: a share of column.stop_high, which is off, says nothing; "
            'give column.stop_high, or state bounds as values, such as { uniform = ["10 deg", "30 deg"] }',
        ),
        (
            'column.coulomb_friction = { triangular = ["1 lb", "5 lb"] }',
            "tolerances.column.coulomb_friction: expected a peak, because column.coulomb_friction is off "
            "and has no value; state it",
        ),
        (
            'column.coulomb_friction = { normal = "1 lb", low = "1 lb", high = "5 lb" }',
            "tolerances.column.coulomb_friction: expected a mean, because column.coulomb_friction is off "
            "and has no value; state it",
        ),
        (
            'controller.delay = { uniform = ["0 ms", "1 ms"] }',
            "tolerances.controller.delay: has no effect without controller.period; "
            "give controller.period too, such as '0.5 ms', or leave controller.delay out",
        ),
    ],
)
def test_tolerance_of_invalid_parameter_gives_one_line_error(tmp_path: Path, line: str, message: str) -> None:
    with pytest.raises(InputError) as caught:
        read(tmp_path, line)
    assert str(caught.value) == f"{tmp_path / 'my.toml'}: {message}"


def test_share_of_zero_value_is_refused(tmp_path: Path) -> None:
    text = dataclasses.replace(elevator(), tolerances={}).replace({"feel.damping": 0}).to_toml()
    (tmp_path / "my.toml").write_text(f'{text}feel.damping = "20 %"\n', encoding="utf-8")
    with pytest.raises(
        InputError, match=r"tolerances\.feel\.damping: expected bounds as values with their unit, got shares"
    ):
        load(tmp_path / "my.toml")


@pytest.mark.parametrize(
    "line",
    [
        'column.coulomb_friction = { uniform = ["1 lb", "5 lb"] }',
        'column.coulomb_friction = { triangular = ["1 lb", "2 lb", "5 lb"] }',
        'column.coulomb_friction = { normal = "1 lb", mean = "2 lb", low = "1 lb", high = "5 lb" }',
        'column.stop_high = { uniform = ["10 deg", "20 deg"] }',
        '"column.coulomb_friction" = { uniform = ["1 lb", "5 lb"] }',
        'linkage.ratio = { uniform = ["0.5", "0.6"] }',
        'linkage.ratio = { uniform = ["-10 %", "0.6"] }',
        'load_cell.gain = { triangular = ["0.0045 V/lb", "0.0055 V/lb"] }',
        "",
    ],
)
def test_good_tolerances_are_read(tmp_path: Path, line: str) -> None:
    assert len(read(tmp_path, line).tolerances) == (1 if line else 0)


def test_several_bad_tolerances_give_one_line_each(tmp_path: Path) -> None:
    with pytest.raises(InputError) as caught:
        read(tmp_path, 'linkage.stiffness = "x"\nlinkage.damping = "-5 %"\nactuator.aera = "5 %"')
    assert [line.split(": ")[1] for line in str(caught.value).splitlines()] == [
        "tolerances.linkage.stiffness",
        "tolerances.linkage.damping",
        "tolerances",
    ]


@pytest.mark.parametrize("section", ["5", "[1]", '"20 %"'])
def test_a_section_that_is_no_table_is_refused(tmp_path: Path, section: str) -> None:
    path = tmp_path / "my.toml"
    text = dataclasses.replace(elevator(), tolerances={}).to_toml().replace("\n[tolerances]\n", "\n")
    path.write_text(f"tolerances = {section}\n{text}", encoding="utf-8")
    with pytest.raises(InputError, match=r"my\.toml: tolerances: expected the table \[tolerances\], got "):
        load(path)


@st.composite
def tolerances(draw: st.DrawFn) -> tuple[str, Tolerance]:
    """A row and a tolerance within its range."""
    key = draw(st.sampled_from([key for key, row in TABLE.items() if row.off_si is None]))
    low, high = (limit / bare_of(key)[key] for limit in limits_si(TABLE[key]))
    ends = sorted(draw(st.lists(st.integers(-90, 400), min_size=4, max_size=4, unique=True)))
    nominal = bare_of(key)[key]
    first, peak, last = (nominal * min(max(1 + ends[k] / 100, low), high) for k in (0, 1, 3))
    assume(first < last * (1 - 1e-6))
    deviation = draw(st.floats(0.01, 10)) * (last - first)
    about = draw(st.sampled_from([nominal, None]))
    match draw(st.sampled_from(list(Distribution))):
        case Distribution.UNIFORM:
            return key, Tolerance(Distribution.UNIFORM, first, last, nominal=about)
        case Distribution.TRIANGULAR:
            return key, Tolerance(Distribution.TRIANGULAR, first, last, min(peak, last), nominal=about)
        case Distribution.NORMAL:
            return key, Tolerance(Distribution.NORMAL, first, last, min(peak, last), deviation, nominal=about)


@given(tolerances(), st.sampled_from(list(UnitSystem)))
def test_random_tolerance_round_trips_through_text(found: tuple[str, Tolerance], units: UnitSystem) -> None:
    key, tolerance = found
    text = tolerance_text.write(TABLE[key], tolerance, units)
    back = tolerance_text.read(key, tomllib.loads(f"it = {text}")["it"], bare_of(key)[key])
    assert_alike(back, dataclasses.astuple(tolerance), TEN_DIGITS)


VALUES = st.recursive(
    st.sampled_from(["5 %", "-10 %", "5000 lb/in", "3 lb", ""]) | st.text(max_size=6) | st.floats() | st.booleans(),
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(
            st.sampled_from(["uniform", "normal", "triangular", "low", "high", "mean", "x"]), inner, max_size=4
        )
    ),
    max_leaves=6,
)


@given(st.sampled_from(list(TABLE)), VALUES)
def test_random_input_is_tolerance_or_one_line_error(key: str, stated: Any) -> None:
    assert good_or_refused(key, stated)


def good_or_refused(key: str, stated: Any) -> bool:
    """Whether a tolerance is taken, or refused in a line that names it; any other error passes through."""
    try:
        return key in elevator().with_tolerances({key: stated}).tolerances
    except InputError as error:
        return str(error).startswith("tolerances") and "\n" not in str(error)


def test_public_names() -> None:
    assert ff.loader.Tolerance is Tolerance
    assert ff.loader.Distribution is Distribution
