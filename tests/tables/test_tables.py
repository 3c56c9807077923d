"""Tables from files: their limits, damaged files of each format, MATLAB files against SciPy's reader."""

import io
import os
import struct
import tracemalloc
import zlib

import numpy as np
import pyarrow
import pytest
import scipy.io
import scipy.sparse
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pyarrow import parquet

from forcefeel.bench.data_file import read_bench_data
from forcefeel.errors import InputError
from forcefeel.files import MOST_TEXT_BYTES, read_input
from forcefeel.flight_schedule import read_knots
from forcefeel.loader.loader import load
from forcefeel.qualification import read_record
from forcefeel.simulation.inputs import read_recorded
from forcefeel.tables import matlab_file, table
from forcefeel.tables.matlab_file import DamagedError, read_variables
from forcefeel.tables.table import MOST_BYTES, Located
from forcefeel.tables.table_file import open_table

EXAMPLE = "time (s),force (lb)"
T = np.arange(200) / 100
FORCE = np.sin(T)
ROUNDING = 1e-15  # relative; all formats hold all digits, and twice a number is exact
SOON = pytest.mark.timeout(10)
"""Seconds; each of these took from 40 s to for ever."""


def write_csv(path):
    rows = [EXAMPLE, *(f"{t!r},{f!r}" for t, f in zip(T.tolist(), FORCE.tolist(), strict=True))]
    path.write_text("\n".join(rows), encoding="utf-8")


def write_parquet(path, **options):
    parquet.write_table(pyarrow.table({"time (s)": T, "force (lb)": FORCE}), path, **options)


def write_mat(path):
    scipy.io.savemat(path, {"time_s": T, "force_lb": FORCE})


WRITERS = {"csv": write_csv, "parquet": write_parquet, "mat": write_mat}


def written(tmp_path, kind):
    path = tmp_path / f"run.{kind}"
    WRITERS[kind](path)
    return path


# What may be a file.

READERS = {
    "bench data": (read_bench_data, ".csv", MOST_BYTES),
    "record": (read_record, ".mat", MOST_BYTES),
    "recorded force": (read_recorded, ".parquet", MOST_BYTES),
    "loader": (load, ".toml", MOST_TEXT_BYTES),
    "knots": (read_knots, ".csv", MOST_TEXT_BYTES),
}


@SOON
@pytest.mark.parametrize(("read", "ending", "most"), READERS.values(), ids=READERS)
def test_endless_and_oversized_files_are_refused(tmp_path, read, ending, most):
    os.mkfifo(tmp_path / f"pipe{ending}")
    (tmp_path / f"zero{ending}").symlink_to("/dev/zero")
    for name in (f"pipe{ending}", f"zero{ending}"):
        with pytest.raises(InputError, match=f"{name}: is a pipe or a device; expected .*; write it to a file first"):
            read(tmp_path / name)
    (tmp_path / f"folder{ending}").mkdir()
    with pytest.raises(InputError, match=r"is a folder; expected .*; name a file in it"):
        read(tmp_path / f"folder{ending}")
    large = tmp_path / f"large{ending}"
    large.touch()
    os.truncate(large, most + 2**20)  # a hole, which takes no room on the disk
    with pytest.raises(InputError, match=rf"has {most // 2**20 + 1} MB; expected .* of {most // 2**20} MB at most"):
        read(large)


def test_a_file_that_grows_is_refused(tmp_path, monkeypatch):
    path = tmp_path / "run.csv"
    path.write_text("time (s)")
    before = path.stat()
    path.write_text("time (s),force (lb)\n0,1\n")
    monkeypatch.setattr(type(path), "stat", lambda _: before)
    with pytest.raises(InputError, match=r"run\.csv: grows while it is read"):
        read_input(path, MOST_BYTES, "a table")


# How much may be in it.


@SOON
def test_cell_of_many_digits_and_header_of_many_brackets_are_fast(tmp_path):
    path = tmp_path / "run.csv"
    path.write_text(f"{EXAMPLE}\n0,{'1' * 50_000}x\n1,2\n")
    with pytest.raises(InputError, match=r"line 2: force: expected a number such as '0\.25', got '1111") as refused:
        read_recorded(path)
    assert len(str(refused.value)) < len(str(path)) + 200  # a line or two of a terminal
    for cell in ("(" * 100_000, "[" * 100_000 + "x", "force_" + "a_" * 50_000, "force (" + "N " * 50_000 + ")"):
        path.write_text(f"time (s),{cell}\n0,1\n1,2\n")
        with pytest.raises(InputError, match="line 1"):
            read_recorded(path)


@pytest.mark.slow
@SOON
@pytest.mark.parametrize("kind", WRITERS)
def test_too_many_columns_and_rows_are_refused(tmp_path, kind, monkeypatch):
    path = tmp_path / f"wide.{kind}"
    names = [f"x{i}" for i in range(table.MOST_COLUMNS + 1)]
    if kind == "csv":
        path.write_text(",".join(names * 100) + "\n")
    elif kind == "parquet":
        parquet.write_table(pyarrow.table({name: [1.0, 2.0] for name in names}), path)
    else:
        zero = struct.pack("<5i", 0, 1, 1, 0, 2) + b"x\0" + bytes(8)  # Level 4: one number
        path.write_bytes(zero * len(names))
    with pytest.raises(InputError, match=r"more than 10,000 (columns|variables)"):
        read_recorded(path)
    monkeypatch.setattr(table, "MOST_ROWS", len(T) - 1)
    monkeypatch.setattr("forcefeel.tables.csv_table.MOST_ROWS", len(T) - 1)
    with pytest.raises(InputError, match="has more than 199 rows; leave out what is not needed"):
        read_recorded(written(tmp_path, kind))


@pytest.mark.slow
def test_reading_large_file_needs_little_more_memory_than_its_size(tmp_path):
    path = tmp_path / "run.csv"
    rows = "".join(f"{t / 1000:.3f},{t % 7},some words,-0.123456789,0.987654321,-17.5\n" for t in range(20_000))
    path.write_text(f"time (s),force (lb),note,x,y,z\n{rows}")
    tracemalloc.start()
    try:
        read_recorded(path)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak < 2.5 * path.stat().st_size  # the file, and of each row two numbers and its line, as read and as kept


# Damaged files.


def damaged(draw, data):
    """A few bytes of a file are others, or its end is missing."""
    data = bytearray(data)
    for at in draw(st.lists(st.integers(0, len(data) - 1), max_size=4)):
        data[at] = draw(st.sampled_from([0, 1, 14, 15, 128, 255]) | st.integers(0, 255))
    return bytes(data[: draw(st.integers(0, len(data)) | st.just(len(data)))])


@pytest.mark.parametrize("kind", WRITERS)
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])  # each example writes the file anew
@given(st.data())
def test_a_damaged_file_is_read_or_refused(tmp_path, kind, drawn):
    path = written(tmp_path, kind)
    path.write_bytes(damaged(drawn.draw, path.read_bytes()))
    try:
        read = read_recorded(path)
    except InputError as error:
        refusal = str(error)
    else:
        assert np.isfinite([read.time_s, read.force_n]).all()
        return
    assert refusal.startswith(f"{path}: ")


def test_damaged_parquet_schema_is_refused(tmp_path):
    path = tmp_path / "run.parquet"
    write_parquet(path, compression="none", store_schema=False)
    path.write_bytes(path.read_bytes().replace(b"time (s)", b"\xffime (s)"))
    with pytest.raises(
        InputError, match=r"run\.parquet: cannot be read as Parquet \(.*utf-8.*\); expected columns as in"
    ):
        read_recorded(path)


def test_damaged_matlab_tag_is_refused(tmp_path):
    """A reader in C ended the program on it."""
    path = tmp_path / "run.mat"
    scipy.io.savemat(path, {"t": np.arange(3.0)})
    data = bytearray(path.read_bytes())
    data[176] = 14
    path.write_bytes(data)
    with pytest.raises(
        InputError, match=r"run\.mat: cannot be read as a MATLAB file \(an array has data type 14 where numb"
    ):
        read_bench_data(path)


# MATLAB files.

RNG = np.random.default_rng(5)
HELD = {
    "column": T[:, None],
    "row": T[None, :],
    "small": np.array([0.0, 1.0, 255.0]),
    "single": RNG.random((1, 7)).astype(np.float32),
    **{name: np.array([0, 1, 100], name) for name in ("int8", "uint8", "int16", "uint16", "int32", "uint32", "int64")},
    "uint64": np.array([2**63, 5], np.uint64),
    "complex": np.array([1 + 2j, 3 - 1j]),
    "block": RNG.random((2, 3, 4)),
    "logical": np.array([True, False]),
    "a_name_of_thirty_one_letters_abc": T,
}
PASSED_OVER = {
    "empty": np.zeros((0, 3)),
    "cells": np.array([1, "a", [2, 3]], dtype=object),
    "sparse": scipy.sparse.eye(4, format="csc"),
    "lines": np.array(["ab", "cd"]),
    "run": {"angle_deg": T, "hold": "straight", "inner": {"angle_rad": T}},
}
LEVEL_4 = ("column", "row", "single", "complex", "int16", "int32", "uint8", "uint16")


@pytest.mark.parametrize(
    "options", [{}, {"do_compression": True}, {"format": "4"}], ids=["plain", "compressed", "level 4"]
)
def test_matlab_reader_matches_scipy(options):
    held = {name: HELD[name] for name in LEVEL_4} if "format" in options else {**HELD, **PASSED_OVER}
    file = io.BytesIO()
    scipy.io.savemat(file, {**held, "note": "servo-closed", "sign": "µ 12°"}, **options)
    data = file.getvalue()
    expected, found = scipy.io.loadmat(io.BytesIO(data)), dict(read_variables(data))
    assert (found.pop("note"), found.pop("sign")[-3:]) == ("servo-closed", "12°")
    if "format" not in options:  # fields stand for themselves
        np.testing.assert_array_equal(found.pop("angle_deg"), T[None, :])
        assert found.pop("hold") == "straight"
    assert set(found) == set(held) - set(PASSED_OVER)
    for name, values in found.items():
        np.testing.assert_array_equal(values, expected[name])


def element(order, kind, data):
    return struct.pack(f"{order}II", kind, len(data)) + data + bytes(-len(data) % 8)


def matrix(order, name, values, data_type=9):
    """A Level 5 array as the format's document has it."""
    numbers = np.asarray(values)
    parts = [
        element(order, 6, struct.pack(f"{order}II", 6, 0)),
        element(order, 5, struct.pack(f"{order}ii", 1, len(numbers))),
        struct.pack(f"{order}I", len(name) << 16 | 1) + name.ljust(4, b"\0"),  # a small element
        element(order, data_type, numbers.astype(numbers.dtype.newbyteorder(order)).tobytes()),
    ]
    return element(order, 14, b"".join(parts))


def level_5(order, *elements):
    mark = b"IM" if order == "<" else b"MI"
    return b"MATLAB 5.0".ljust(124) + struct.pack(f"{order}H", 0x0100) + mark + b"".join(elements)


@pytest.mark.parametrize("order", ["<", ">"])
def test_matlab_file_of_either_byte_order_is_read(order):
    parts = matrix(order, b"t", T), matrix(order, b"", T), matrix(order, b"k", np.array([1, 2, 3], np.int16), 3)
    data = level_5(order, *parts)
    (t, times), (k, small) = read_variables(data)
    assert (t, k) == ("t", "k")
    np.testing.assert_array_equal(times[0], T)
    np.testing.assert_array_equal(small[0], [1, 2, 3])
    numbers = T.astype(f"{order}f8").tobytes()
    [(name, values)] = read_variables(
        struct.pack(f"{order}5i", 1000 * (order == ">"), len(T), 1, 0, 2) + b"t\0" + numbers
    )
    assert name == "t"
    np.testing.assert_array_equal(values[:, 0], T)


def test_stated_sizes_of_matlab_file_are_verified(monkeypatch):
    good = matrix("<", b"t", T)
    for data, message in (
        (level_5("<", good[:-8]), "and 16.. are left"),
        (level_5("<", matrix("<", b"t", T, 7)), "1x200 numbers of 4 bytes has 1600 bytes"),
        (level_5("<", element("<", 9, bytes(8))), "a variable is of data type 9, expected 14"),
        (level_5("<", element("<", 15, zlib.compress(good)[:-9])), "a variable ends too early"),
        (level_5("<", element("<", 15, b"no stream")), "cannot be inflated"),
        (level_5("<")[:124] + struct.pack("<H", 0x0300) + b"IM", "version 0x0300 is not known"),
        (struct.pack("<5i", 0, 2**30, 2**30, 0, 2) + b"t\0", "bytes too early"),
        (struct.pack("<5i", 0, -1, 1, 0, 2) + b"t\0", "says 0, -1 x 1"),
    ):
        with pytest.raises(DamagedError, match=message):
            read_variables(data)
    monkeypatch.setattr(matlab_file, "MOST_INFLATED", 2**20)
    bomb = level_5("<", element("<", 15, zlib.compress(bytes(2**21))))
    with pytest.raises(DamagedError, match="its variables hold more than 1 MB"):
        read_variables(bomb)


# What all formats share.


@pytest.mark.parametrize("kind", WRITERS)
def test_three_formats_give_same_table_repeatedly(tmp_path, kind):
    opened = open_table(written(tmp_path, kind), EXAMPLE)
    found = {"time": Located(0, "s", 1.0, "s"), "force": Located(1, "N", 2.0, "half a pair")}
    for _ in range(2):
        read = opened.take(found)
        np.testing.assert_allclose(read.values["time"], T, rtol=ROUNDING)
        np.testing.assert_allclose(read.values["force"], 2 * FORCE, rtol=ROUNDING)
        assert read.own_units == {"time": "s", "force": "half a pair"}
        assert read.places[3].endswith({"csv": ": line 4", "parquet": ": row 3", "mat": ": sample 3"}[kind])
