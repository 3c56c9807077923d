"""The loader object: frozen, compared by value, changed only through checked copies."""

import copy
import dataclasses
import math
import pickle
from collections.abc import Callable, Mapping

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from forcefeel.errors import InputError
from forcefeel.loader.built_in import electric, elevator
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import (
    ALTERNATIVES,
    DRIVES,
    INDEX,
    OFF,
    TABLE,
    has,
    in_range,
    limits_si,
    main_rows,
    parts,
    range_text,
    stands,
    table,
)
from tests.optional_rows import bare_of, companions

ROUNDING = 4e-15  # relative; a conversion to SI multiplies about ten times, each good to 1.1e-16
BEYOND = 1e-8  # relative; past a limit by more than the rounding of ten digits
POUND_PER_INCH = 4.4482216152605 / 0.0254  # N/m


def test_elevator_loader_has_appendix_values_in_si() -> None:
    loader = elevator()
    assert loader.name == "elevator-1974"
    assert "1974" in loader.source
    assert loader["actuator.area"] == pytest.approx(2.36 * 0.0254**2, rel=ROUNDING)
    assert loader["linkage.stiffness"] == pytest.approx(6107.86 * POUND_PER_INCH, rel=ROUNDING)
    assert loader["pilot.force"] == pytest.approx(96 * 4.4482216152605, rel=ROUNDING)
    assert loader["linkage.ratio"] == 0.59
    assert [loader[key] for key in TABLE] == loader.si_values.tolist()


def test_parameter_table_has_one_row_per_value() -> None:
    assert list(INDEX.values()) == list(range(len(TABLE)))
    for drive in DRIVES:
        by_part = [f"{part}.{name}" for part in parts(drive) for name in main_rows(part, drive)]
        assert by_part == list(table(drive)) == [key for key, row in TABLE.items() if has(drive, row)]
    for row in (TABLE | ALTERNATIVES).values():
        low, high = limits_si(row)
        assert -math.inf < low < high < math.inf
        assert low >= 0 or row.off_si is not None
        assert in_range(row, row.default_si)
        assert row.off_si is None or stands(row, row.off_si)
    for row in ALTERNATIVES.values():
        assert all(f"{row.part}.{name}" in TABLE for name in row.instead_of)


def test_a_loader_cannot_be_changed() -> None:
    loader = elevator()
    with pytest.raises(dataclasses.FrozenInstanceError):
        loader.name = "aileron"  # type: ignore[misc]
    with pytest.raises(dataclasses.FrozenInstanceError):
        loader.si_values = np.zeros(len(TABLE))  # type: ignore[misc]
    with pytest.raises(ValueError, match="read-only"):
        loader.si_values[0] = 1.0
    with pytest.raises(TypeError):
        TABLE["linkage.slack"] = TABLE["linkage.ratio"]  # type: ignore[index]


def test_loader_copies_its_values() -> None:
    values = elevator().si_values.copy()
    loader = Loader("mine", "", values)
    values[0] = 0.0
    assert loader == Loader("mine", "", elevator().si_values)


@pytest.mark.parametrize("clone", [copy.copy, copy.deepcopy, lambda it: pickle.loads(pickle.dumps(it))])
def test_copies_are_equal_and_read_only_too(clone: Callable[[Loader], Loader]) -> None:
    loader = clone(elevator())
    assert loader == elevator()
    assert not loader.si_values.flags.writeable


def test_equal_loaders_have_equal_hashes_and_others_differ() -> None:
    loader, same = elevator(), elevator()
    assert loader == same
    assert hash(loader) == hash(same)
    others = [
        dataclasses.replace(loader, name="aileron"),
        dataclasses.replace(loader, source="bench"),
        loader.replace({"pilot.force": "97 lb"}),
    ]
    for other in [*others, "elevator-1974", None]:
        assert loader != other
    assert len({loader, same, *others}) == 1 + len(others)


def test_minus_zero_is_zero_for_equality_and_hash() -> None:
    plus, minus = (elevator().replace({"feel.damping": zero}, si=True) for zero in (0.0, -0.0))
    assert plus == minus
    assert hash(plus) == hash(minus)


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ("7000 lb/in", 7000 * POUND_PER_INCH),
        ("7 N/mm", 7000.0),
        (7000.0, 7000.0),
        (7000, 7000.0),
        (np.float32(7000), 7000.0),
        (np.int64(7000), 7000.0),
    ],
)
def test_replace_takes_text_or_si_numbers(given: str | float, expected: float) -> None:
    loader = elevator().replace({"linkage.stiffness": given}, si=True)
    assert loader["linkage.stiffness"] == pytest.approx(expected, rel=ROUNDING)
    changed = np.flatnonzero(loader.si_values != elevator().si_values).tolist()
    assert changed == [INDEX["linkage.stiffness"]]
    assert (loader.name, loader.source) == (elevator().name, elevator().source)


def test_replace_changes_copy_and_not_original() -> None:
    loader = elevator()
    changed = loader.replace({"feel.stiffness": "4800 lb in/rad", "linkage.ratio": "60 %"})
    assert changed["feel.stiffness"] == pytest.approx(loader["feel.stiffness"] / 2, rel=ROUNDING)
    assert changed["linkage.ratio"] == 0.6
    assert loader == elevator()
    assert loader.replace({}) == loader


AREA = "actuator.area: expected a number with its unit such as '2.36 in^2', got"
SI_AREA = "actuator.area: expected a number such as '2.36 in^2', got"
RANGE = "actuator.area: expected 0.001 to 1000 in^2 (0.0064516 to 6451.6 cm^2), got"


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ("2.36 lb", f"{AREA} '2.36 lb': 'lb' measures a force, not an area"),
        ("2.36", f"{AREA} '2.36', which has no unit"),
        ("wide", f"{AREA} 'wide'"),
        ("nan in^2", f"{AREA} 'nan in^2', which is not finite"),
        ("2000 in^2", f"{RANGE} 2000 in^2"),
        ("0 in^2", f"{RANGE} 0 in^2"),
        (-0.00064516, f"{RANGE} -1 in^2"),
        (math.nan, f"{SI_AREA} nan, which is not finite"),
        (math.inf, f"{SI_AREA} inf, which is not finite"),
        pytest.param(10**400, f"{SI_AREA} a huge number, which is not finite", id="10^400"),
        (True, f"{SI_AREA} true"),
        (None, f"{SI_AREA} None"),
    ],
)
def test_replace_refuses_bad_values(given: str | float, message: str) -> None:
    with pytest.raises(InputError) as caught:
        elevator().replace({"actuator.area": given}, si=True)
    assert str(caught.value) == message


@pytest.mark.parametrize(
    ("key", "message"),
    [
        ("linkage.stifness", "unknown parameter 'linkage.stifness'; did you mean linkage.stiffness?"),
        ("stiffness", "unknown parameter 'stiffness'; did you mean linkage.stiffness or feel.stiffness?"),
        ("area", "unknown parameter 'area'; did you mean actuator.area or surface.area?"),
        ("", f"unknown parameter ''; the parameters are {', '.join(table('hydraulic'))}"),
        ("x\ny", f"unknown parameter 'x\\ny'; the parameters are {', '.join(table('hydraulic'))}"),
        (
            "linkage.resonance_frequency",
            "unknown parameter 'linkage.resonance_frequency'; "
            "a loader file may state it; a loader holds stiffness and damping instead",
        ),
    ],
)
def test_unknown_parameters_are_refused(key: str, message: str) -> None:
    with pytest.raises(InputError) as caught:
        elevator().replace({key: "1 N"})
    assert str(caught.value).startswith(message)
    with pytest.raises(InputError) as caught:
        elevator()[key]
    assert str(caught.value).startswith(message)


@pytest.mark.parametrize("key", TABLE)
def test_values_at_limit_are_valid_and_beyond_are_refused(key: str) -> None:
    low, high = limits_si(TABLE[key])
    others, loader = companions(key), bare_of(key)
    for limit, sign in ((low, -1), (high, 1)):
        beyond = limit + sign * (BEYOND * abs(limit) or BEYOND)
        assert loader.replace({**others, key: limit}, si=True)[key] == limit
        with pytest.raises(InputError) as caught:
            loader.replace({**others, key: beyond}, si=True)
        assert str(caught.value).startswith(f"{key}: expected {range_text(TABLE[key])}, got ")


@pytest.mark.parametrize("key", TABLE)
def test_constructor_checks_every_value(key: str) -> None:
    for value in (math.nan, math.inf, -math.inf, -1e12):
        values = bare_of(key).si_values.copy()
        values[INDEX[key]] = value
        if value == OFF.get(key):
            assert Loader("off", "", values)[key] == value
        else:
            with pytest.raises(InputError, match=rf"^{key}: expected .+, got "):
                Loader(f"bad by {value}", "", values)


@pytest.mark.parametrize("shape", [(0,), (len(TABLE) - 1,), (len(TABLE) + 1,), (1, len(TABLE)), ()])
def test_wrong_number_of_values_is_refused(shape: tuple[int, ...]) -> None:
    with pytest.raises(InputError, match=f"^si_values: expected {len(TABLE)}, one per parameter, got shape "):
        Loader("bad", "", np.ones(shape))


@given(st.floats(1e-3, 1e3))
def test_scaling_the_feel_keeps_frequency_and_damping_ratio(scale: float) -> None:
    loader = elevator()
    scaled = loader.scale_feel(scale)
    inertia, damping, stiffness = (scaled[f"feel.{name}"] for name in ("inertia", "damping", "stiffness"))
    assert stiffness == loader["feel.stiffness"] * scale
    assert stiffness / inertia == pytest.approx(loader["feel.stiffness"] / loader["feel.inertia"], rel=ROUNDING)
    ratio = loader["feel.damping"] / math.sqrt(loader["feel.inertia"] * loader["feel.stiffness"])
    assert damping / math.sqrt(inertia * stiffness) == pytest.approx(ratio, rel=ROUNDING)
    others = [key for key in TABLE if scaled[key] != loader[key]]
    assert set(others) <= {"feel.inertia", "feel.damping", "feel.stiffness", "pilot.force"}
    assert loader == elevator()


@pytest.mark.parametrize("drive", DRIVES)
def test_loader_is_mapping_of_drive_rows(drive):
    loader = elevator() if drive == "hydraulic" else electric("elevator-electric")
    own = [key for key, row in TABLE.items() if row.drive in (None, drive)]
    assert list(loader) == list(loader.keys()) == own
    assert len(loader) == len(own)
    assert isinstance(loader, Mapping)
    assert list(loader.values()) == [loader[key] for key in own]
    assert dict(loader) == dict(loader.items()) == {**loader} == {key: loader.si_values[INDEX[key]] for key in own}
    assert "linkage.stiffness" in loader
    assert ("valve.current_gain" in loader) is (drive == "hydraulic")
    assert "linkage.stifness" not in loader
    assert 3 not in loader
    assert loader.get("linkage.stiffness") == loader["linkage.stiffness"]
    assert loader.get("linkage.stifness", 1.0) == 1.0
    for kind in (InputError, KeyError):
        with pytest.raises(kind, match=r"^unknown parameter 'linkage\.stifness'; did you mean"):
            loader["linkage.stifness"]
