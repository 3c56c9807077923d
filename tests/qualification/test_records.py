"""Records from arrays, CSV and Parquet; what is wrong with one is said with its place and time."""

import math

import numpy as np
import pyarrow
import pytest
from pyarrow import parquet

from forcefeel.errors import InputError
from forcefeel.qualification import Record, measure_release, read_record
from tests.qualification_records import released

ROUNDING = 1e-12
"""Relative: a file has all digits of its angles, in degrees. Measured: 0."""
SPREAD = 0.03
"""Relative: 20 000 samples tell a standard deviation to 1 / sqrt(2 n), half a percent; six of them. Measured: 2e-3."""

T = np.arange(100) / 100
X = np.linspace(0, 10, 100)


def write_csv(path, columns):
    rows = [",".join(columns), *(",".join(repr(float(v)) for v in row) for row in zip(*columns.values(), strict=True))]
    path.write_text("\n".join(rows), encoding="utf-8")
    return path


def write_parquet(path, columns):
    parquet.write_table(pyarrow.table({name: np.asarray(values) for name, values in columns.items()}), path)
    return path


WRITERS = {"csv": write_csv, "parquet": write_parquet}


@pytest.mark.parametrize("kind", WRITERS)
def test_columns_are_converted_from_their_units(tmp_path, kind):
    columns = {
        "time (ms)": 1000 * T,
        "position [deg]": X,
        "force (lb)": 2 * X,
        "surface_deg": -X,
        "body rate (deg/s)": 3 * X,
        "note (s)": X,
    }
    record = read_record(WRITERS[kind](tmp_path / f"run.{kind}", columns))
    assert (record.name, record.position_unit) == ("run", "rad")
    assert record.time_s == pytest.approx(T)
    assert record.position == pytest.approx(np.radians(X))
    assert record.force_n == pytest.approx(2 * X * 4.4482216152605)
    assert record.surface_rad == pytest.approx(-np.radians(X))
    assert record.body_rate_rad_per_s == pytest.approx(np.radians(3 * X))


@pytest.mark.parametrize("kind", WRITERS)
def test_a_position_may_be_a_length(tmp_path, kind):
    path = WRITERS[kind](tmp_path / f"pedals.{kind}", {"time_s": T, "position (in)": X})
    record = read_record(path, name="pedals, left")
    assert (record.name, record.position_unit, record.force_n) == ("pedals, left", "m", None)
    assert record.position == pytest.approx(0.0254 * X)


def test_release_from_file_equals_release_from_arrays(tmp_path):
    record = released(0.2, 2.0, 100)
    columns = {"time (s)": record.time_s, "position (deg)": np.degrees(record.position)}
    for kind, write in WRITERS.items():
        read = measure_release(read_record(write(tmp_path / f"r.{kind}", columns)))
        assert read.cycles[0].value == pytest.approx(measure_release(record).cycles[0].value, rel=ROUNDING)


@pytest.mark.parametrize("kind", WRITERS)
@pytest.mark.parametrize(
    ("columns", "message"),
    [
        ({"time (s)": T}, "has no column 'position'"),
        (
            {"time (s)": T, "position": X},
            "position: has no unit; expected one such as rad or m; add it to the header or by",
        ),
        ({"time (s)": T, "position (parsec)": X}, "position: unknown unit 'parsec'"),
        ({"time (s)": T, "position (lb)": X}, "position: 'lb' measures a force, not an angle"),
        ({"time (s)": T, "position (deg)": X, "force (deg)": X}, "force: 'deg' measures an angle, not a force"),
        (
            {"time (s)": np.r_[T[:50], T[50:] + 9], "position (deg)": X},
            r"a gap of 9\.01 s after 0\.49 s; expected at most",
        ),
        ({"time (s)": np.r_[T[:50], T[48:98]], "position (deg)": X}, r"time runs backwards from 0\.49 s to 0\.48 s"),
        ({"time (s)": np.r_[T[:50], T[49:99]], "position (deg)": X}, r"time stands still at 0\.49 s"),
        ({"time (s)": T[:1], "position (deg)": X[:1]}, "expected two rows of numbers at least, got 1"),
    ],
)
def test_bad_file_error_gives_location(tmp_path, kind, columns, message):
    path = WRITERS[kind](tmp_path / f"bad.{kind}", columns)
    with pytest.raises(InputError, match=message) as caught:
        read_record(path)
    assert str(path) in str(caught.value)


def test_the_row_at_fault_is_named(tmp_path):
    columns = {"time (s)": np.r_[T[:50], T[50:] + 9], "position (deg)": X}
    with pytest.raises(InputError, match=r"bad\.csv: line 52: a gap"):
        read_record(write_csv(tmp_path / "bad.csv", columns))
    with pytest.raises(InputError, match=r"bad\.parquet: row 51: a gap"):
        read_record(write_parquet(tmp_path / "bad.parquet", columns))


def test_non_table_file_raises_input_error(tmp_path):
    (tmp_path / "text.parquet").write_text("time (s)", encoding="utf-8")
    with pytest.raises(InputError, match=r"text\.parquet: cannot be read as Parquet"):
        read_record(tmp_path / "text.parquet")
    with pytest.raises(InputError, match=r"none\.parquet: cannot be read \(No such file"):
        read_record(tmp_path / "none.parquet")
    with pytest.raises(InputError, match=r"none\.csv: cannot be read"):
        read_record(tmp_path / "none.csv")
    with pytest.raises(
        InputError, match=r"expected a file that ends in \.csv, \.parquet, \.mat or \.mcap, got 'run\.txt'"
    ):
        read_record(tmp_path / "run.txt")
    words = write_parquet(tmp_path / "words.parquet", {"time (s)": T, "position (deg)": np.array(["a"] * 100)})
    with pytest.raises(InputError, match="position: expected a column of numbers"):
        read_record(words)


def test_missing_parquet_sample_is_nan(tmp_path):
    table = pyarrow.table({"time (s)": T, "position (deg)": pyarrow.array([None, *X[1:]], pyarrow.float64())})
    parquet.write_table(table, tmp_path / "hole.parquet")
    with pytest.raises(InputError, match=r"hole\.parquet: row 1: expected finite numbers, got 0 s and nan rad"):
        read_record(tmp_path / "hole.parquet")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"position": X[:9]}, "mine: expected position to be as long as time_s, got 9 values and 100 times"),
        ({"position": X, "force_n": X[:9]}, "mine: expected force_n to be as long as time_s"),
        (
            {"position": np.where(X > 5, np.nan, X)},
            r"mine: row 51, counted from 1: expected finite numbers, got 0\.5 s and nan",
        ),
        ({"position": X, "position_unit": "deg"}, "mine: position_unit: expected 'rad' or 'm', got 'deg'"),
        ({"position": X, "noise": -1.0}, r"mine: noise: expected a number of at least zero, got -1\.0"),
        ({"position": [[1.0]]}, r"mine: expected position to be a row of numbers, got shape \(1, 1\)"),
        ({"position": ["a"]}, "mine: expected position to be a row of numbers"),
    ],
)
def test_invalid_arrays_are_refused(arguments, message):
    with pytest.raises(InputError, match=message):
        Record(T, name="mine", **arguments)


def test_arrays_in_other_units():
    record = Record.of(1000 * T, X, X, time_unit="ms", position_unit="deg", force_unit="lb", resolution=0.1)
    assert record.time_s == pytest.approx(T)
    assert record.position_resolution == pytest.approx(math.radians(0.1))
    assert Record.of(T, X, position_unit="cm").position_unit == "m"
    with pytest.raises(InputError, match="record: position_unit: 'lb' measures a force, not an angle"):
        Record.of(T, X, position_unit="lb")
    with pytest.raises(InputError, match="record: time_unit: unknown unit 'jiffy'"):
        Record.of(T, X, time_unit="jiffy")


def test_noise_and_resolution_are_estimated():
    rng = np.random.default_rng(3)
    t = np.arange(20_000) / 1000
    noisy = Record(t, np.exp(-t) + 0.003 * rng.standard_normal(len(t)))
    assert noisy.position_noise == pytest.approx(0.003, rel=SPREAD)
    assert noisy.position_resolution == 0
    assert Record(t, np.round(np.sin(t) / 0.02) * 0.02).position_resolution == pytest.approx(0.02)
    assert Record(t, np.exp(-t)).position_noise < 1e-15  # rounding
    assert noisy.between(2.0, 3.0).duration_s == pytest.approx(1.0)
