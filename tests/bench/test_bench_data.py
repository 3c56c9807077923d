"""Bench data from files: units, names, what a file says of itself, three formats; what must be refused."""

import hashlib
import math
import re

import numpy as np
import pyarrow
import pytest
import scipy.io
from pyarrow import parquet

from forcefeel.bench.channels import CHANNELS
from forcefeel.bench.data_file import read_bench_data
from forcefeel.bench.experiments import Experiment
from forcefeel.bench.record_file import read_bench_record
from forcefeel.bench.records import BenchRecord
from forcefeel.bench.response_file import read_response
from forcefeel.bench.responses import Response
from forcefeel.errors import InputError
from forcefeel.tables.header import Heading, heading, suffix_unit

POUND = 4.4482216152605  # N, exact
INCH = 0.0254  # m, exact
ROUNDING = 1e-12  # relative; a few multiplications

CLOSED = Experiment.read("servo-closed")
TO_POTENTIOMETER = "# experiment: servo-closed\n# from: test_signal (V)\n# to: potentiometer (V)\n"
LINES = "frequency (Hz),gain (dB),phase (deg)\n1,0,-10\n2,-6,-30\n4,-20,-90\n"

T = np.arange(200) / 100
U = np.where(T > 0.1, np.sin(2 * np.pi * (T - 0.1)), 0.0)
X = np.where(T > 0.12, 1 - np.cos(2 * np.pi * (T - 0.12)), 0.0)
RECORD = {"time (s)": T, "test_signal (V)": U, "column angle (deg)": X, "load_cell_force [lb]": 2 * X}


def response(tmp_path, text, name="measured.csv", **arguments):
    (tmp_path / name).write_text(text, encoding="utf-8")
    return read_response(tmp_path / name, **arguments)


def write_csv(path, columns, notes=None):
    rows = [",".join(columns), *(",".join(repr(float(v)) for v in row) for row in zip(*columns.values(), strict=True))]
    top = [f"# {key}: {said}" for key, said in (notes or {}).items()]
    path.write_text("\n".join([*top, *rows]), encoding="utf-8")
    return path


def write_parquet(path, columns, notes=None):
    table = pyarrow.table(dict(columns)).replace_schema_metadata(notes)
    parquet.write_table(table, path)
    return path


def write_mat(path, columns, notes=None):
    names = {re.sub(r"\W+", "_", name).strip("_").lower(): values for name, values in columns.items()}
    scipy.io.savemat(path, {**names, **(notes or {})})
    return path


WRITERS = {"csv": write_csv, "parquet": write_parquet, "mat": write_mat}


@pytest.mark.parametrize(
    ("cell", "expected"),
    [
        ("column angle (deg)", Heading("column_angle", "deg")),
        ("Column_Angle [deg]", Heading("column_angle", "deg")),
        ("column_angle_deg", Heading("column_angle", "deg")),
        ("load_cell_force_lb", Heading("load_cell_force", "lb")),
        ("load_cell_V", Heading("load_cell", "V")),
        ("load_cell", Heading("load_cell", "")),
        ("load_cell_noise", Heading("load_cell_noise", "")),  # no unit, so another column
        ("valve_current_ma", Heading("valve_current", "mA")),
        ("load_pressure_mpa", Heading("load_pressure", "MPa")),
        ("load pressure (lb/in^2)", Heading("load_pressure", "lb/in^2")),
        ("actuator_flow_in3_per_s", Heading("actuator_flow", "in^3/s")),
        ("actuator_flow_m3_per_s", Heading("actuator_flow", "m^3/s")),
        ("column_velocity_rad_per_s", Heading("column_velocity", "rad/s")),
        ("actuator flow (in^3/(s))", Heading("actuator_flow", "in^3/(s)")),
        ("note", Heading("note", "")),
    ],
)
def test_column_headers_are_parsed(cell, expected):
    assert heading(cell, CHANNELS) == expected


def test_suffix_that_is_not_a_unit_is_ignored():
    assert [suffix_unit(it) for it in ("noise", "angle", "x" * 100, "")] == [""] * 4


def test_decibels_use_the_stated_units(tmp_path):
    found = response(tmp_path, TO_POTENTIOMETER + LINES)
    assert (found.name, found.experiment, found.input, found.output) == (
        "measured",
        CLOSED,
        "test_signal",
        "potentiometer",
    )
    assert found.frequency_hz.tolist() == [1, 2, 4]
    gain = np.array([1, 10**-0.3, 0.1])
    assert found.value == pytest.approx(gain * np.exp(-1j * np.radians([10, 30, 90])), rel=ROUNDING)
    assert (found.coherence, found.deviation) == (None, None)
    data = (tmp_path / "measured.csv").read_bytes()
    assert found.data_hash == hashlib.sha256(data).hexdigest()
    degrees = response(tmp_path, TO_POTENTIOMETER.replace("potentiometer (V)", "column angle (deg)") + LINES)
    assert np.abs(degrees.value) == pytest.approx(gain * math.pi / 180, rel=ROUNDING)


def test_gain_with_its_own_unit_needs_no_other_unit(tmp_path):
    header = "frequency (rad/s),gain (in/V),phase (rad),coherence,deviation\n"
    text = header + "6,1,-0.1,1,0.01\n12,0.5,-0.5,0.9,0.02\n24,.2,-1,0.8,0.04\n"
    found = response(tmp_path, text, experiment="servo-open", output="piston_position")
    assert (found.input, found.output) == ("test_signal", "piston_position")
    assert found.frequency_hz == pytest.approx(np.array([6, 12, 24]) / (2 * math.pi), rel=ROUNDING)
    assert found.value == pytest.approx(INCH * np.array([1, 0.5, 0.2]) * np.exp([-0.1j, -0.5j, -1j]), rel=ROUNDING)
    assert found.coherence.tolist() == [1, 0.9, 0.8]
    assert found.deviation.tolist() == [0.01, 0.02, 0.04]


def test_arguments_add_what_the_file_omits(tmp_path):
    arguments = {"experiment": "loader", "input": "pilot_force (lb)", "output": "load cell force (lb)"}
    plain = LINES.replace(" (Hz)", "").replace(" (deg)", "")
    found = response(tmp_path, plain, **arguments, units={"frequency": "Hz", "phase": "deg"})
    assert np.abs(found.value) == pytest.approx([1, 10**-0.3, 0.1], rel=ROUNDING)  # lb per lb is N per N
    units = {"pilot_force": "lb", "column_angle": "deg"}
    bare = {"experiment": Experiment.read("loader"), "input": "pilot_force", "output": "column_angle"}
    found = response(tmp_path, LINES, **bare, units=units)
    assert np.abs(found.value[0]) == pytest.approx(math.pi / 180 / POUND, rel=ROUNDING)


def test_equal_units_do_not_conflict(tmp_path):
    """The same unit under another name, and dB in any case."""
    top = "# experiment: servo-closed\n# to: load_pressure (lb/in^2)\n"
    units = {"gain": "db", "phase": "degree", "load_pressure": "psi", "test_signal": "V"}
    found = response(tmp_path, top + LINES, output="load_pressure (psi)", units=units)
    assert np.abs(found.value[0]) == pytest.approx(POUND / INCH**2, rel=ROUNDING)
    path = write_csv(tmp_path / "run.csv", {**RECORD, "load_pressure (lb/in^2)": X})
    read = read_bench_record(path, experiment="servo-closed", units={"load_pressure": "psi", "time": "sec"})
    assert read.channels["load_pressure"] == pytest.approx(X * POUND / INCH**2, rel=ROUNDING)
    with pytest.raises(InputError, match="the header says 'lb/in\\^2', the argument units 'ksi'"):
        read_bench_record(path, experiment="servo-closed", units={"load_pressure": "ksi"})


BAD_RESPONSES = {
    "no experiment": (LINES, {"output": "potentiometer (V)"}, "has no experiment"),
    "no output": ("# experiment: servo-open\n" + LINES, {}, "does not say which channel it leads to"),
    "contradiction": (
        TO_POTENTIOMETER + LINES,
        {"experiment": "servo-open"},
        "states servo-closed test_signal, but",
    ),
    "other output": (
        TO_POTENTIOMETER + LINES,
        {"output": "column_angle"},
        "'to' and the argument output contradict each other: 'potentiometer' and 'column_angle'",
    ),
    "other unit": (
        TO_POTENTIOMETER + LINES,
        {"units": {"potentiometer": "mV"}},
        "'to' and the argument units contradict each other: 'V' and 'mV';",
    ),
    "other unit of the argument": (
        TO_POTENTIOMETER.replace("potentiometer (V)", "potentiometer") + LINES,
        {"output": "potentiometer (V)", "units": {"potentiometer": "mV"}},
        "the argument output and the argument units contradict each other: 'V' and 'mV';",
    ),
    "header and units": (
        TO_POTENTIOMETER + LINES,
        {"units": {"phase": "rad"}},
        "the header says 'deg', the argument units 'rad'",
    ),
    "unit not known": (
        TO_POTENTIOMETER.replace(" (V)", "") + LINES,
        {},
        "the unit of test_signal is not known; say so",
    ),
    "unknown name": (TO_POTENTIOMETER + LINES, {"units": {"theta": "deg"}}, "the argument units: unknown name 'theta'"),
    "unknown channel": (
        TO_POTENTIOMETER.replace("potentiometer", "piston") + LINES,
        {},
        "'to': unknown channel 'piston'; the channels",
    ),
    "unknown channel of the argument": (
        LINES,
        {"experiment": "servo-closed", "output": "piston"},
        "the argument output: unknown channel 'piston'; the channels",
    ),
    "itself": (
        TO_POTENTIOMETER.replace("potentiometer", "test_signal") + LINES,
        {},
        "leads from test_signal to itself",
    ),
    "stated twice": ("# experiment: loader\n" + TO_POTENTIOMETER + LINES, {}, "line 2: experiment is stated twice"),
    "release": (
        TO_POTENTIOMETER.replace("closed", "closed release") + LINES,
        {},
        "a release has no frequency response",
    ),
    "no gain": (
        TO_POTENTIOMETER + LINES.replace("gain", "size"),
        {},
        "line 4: has no column 'gain'; expected a header such as 'frequency",
    ),
    "gain without unit": (
        TO_POTENTIOMETER + LINES.replace(" (dB)", ""),
        {},
        "gain: has no unit; expected one such as dB or",
    ),
    "wrong unit": (TO_POTENTIOMETER + LINES.replace("(dB)", "(in/V)"), {}, "gain: 'in/V' does not measure"),
    "phase in volts": (
        TO_POTENTIOMETER + LINES.replace("(deg)", "(V)"),
        {},
        "phase: 'V' measures a voltage, not an angle",
    ),
    "two phases": (TO_POTENTIOMETER + "phase (rad)," + LINES.replace("\n", "\n0,", 3), {}, "has 2 columns 'phase'"),
    "busy unit": (TO_POTENTIOMETER + LINES.replace("deg", "s" * 60), {}, "phase: unknown unit"),
    "not a number": (
        TO_POTENTIOMETER + LINES.replace("-20", "nan"),
        {},
        r"measured\.csv: line 7: gain: expected a finite number",
    ),
    "no number": (
        TO_POTENTIOMETER + LINES.replace("-20", "low"),
        {},
        r"line 7: gain: expected a number such as '0\.25', got 'low'",
    ),
    "infinite": (TO_POTENTIOMETER + LINES.replace("-20", "1e400"), {}, r"line 7: gain is inf; expected finite numbers"),
    "ratio below 0": (
        TO_POTENTIOMETER + LINES.replace("dB", "V/V").replace(",0,", ",1,"),
        {},
        r"line 6: the gain is -6 as a ratio; expected one above 0; is it in dB",
    ),
    "degrees as rad": (
        TO_POTENTIOMETER + LINES.replace("deg", "rad"),
        {},
        r"line 7: the phase is -90 rad; expected 30 rad at most",
    ),
    "huge dB": (
        TO_POTENTIOMETER + LINES.replace("-20", "9000"),
        {},
        r"line 7: the gain is 9000 dB; .* is it a ratio\?",
    ),
    "short row": (TO_POTENTIOMETER + LINES + "8,1\n", {}, "line 8: expected 3 values as in the header, got 2"),
    "bad experiment": (LINES, {"experiment": "servo"}, "the argument experiment: expected servo-open"),
    "bad experiment of the file": (
        "# experiment: servo\n" + LINES,
        {},
        r"measured\.csv: experiment: expected servo-open",
    ),
    "empty": ("# experiment: loader\n", {}, "is empty"),
}


@pytest.mark.parametrize(("text", "arguments", "message"), BAD_RESPONSES.values(), ids=BAD_RESPONSES)
def test_invalid_response_raises_input_error(tmp_path, text, arguments, message):
    with pytest.raises(InputError, match=message) as caught:
        response(tmp_path, text, **arguments)
    assert str(tmp_path / "measured.csv") in str(caught.value)


@pytest.mark.parametrize("kind", WRITERS)
def test_record_reads_equally_from_three_formats(tmp_path, kind):
    notes = {"experiment": "servo-closed", "hold": "staircase"}
    path = WRITERS[kind](tmp_path / f"run.{kind}", RECORD, notes)
    record = read_bench_record(path)
    assert (record.name, record.experiment, record.hold) == ("run", CLOSED, "staircase")
    assert record.data_hash == hashlib.sha256(path.read_bytes()).hexdigest()
    assert list(record.channels) == ["test_signal", "column_angle", "load_cell_force"]
    assert record.time_s == pytest.approx(T, rel=ROUNDING)
    assert record.channels["test_signal"] == pytest.approx(U, rel=ROUNDING)
    assert record.channels["column_angle"] == pytest.approx(np.radians(X), rel=ROUNDING)
    assert record.channels["load_cell_force"] == pytest.approx(2 * X * POUND, rel=ROUNDING)
    with pytest.raises(ValueError, match="read-only"):
        record.time_s[0] = 1.0


@pytest.mark.parametrize("kind", WRITERS)
def test_response_reads_equally_from_three_formats(tmp_path, kind):
    columns = {
        "frequency_hz": np.array([1.0, 2, 4]),
        "gain_db": np.array([0.0, -6, -20]),
        "phase_deg": np.array([-10.0, -30, -90]),
    }
    notes = {"experiment": "servo-closed", "from": "test_signal (V)", "to": "potentiometer (V)"}
    found = read_bench_data(WRITERS[kind](tmp_path / f"it.{kind}", columns, notes))
    assert found.value == pytest.approx(
        [np.exp(-1j * np.radians(10)), 10**-0.3 * np.exp(-1j * np.pi / 6), -0.1j], rel=ROUNDING
    )


@pytest.mark.parametrize("kind", WRITERS)
def test_column_names_of_the_file_map_to_channels(tmp_path, kind):
    own = {"t": T, "drive_v": U, "theta": X, "rate_counter": X}
    path = WRITERS[kind](tmp_path / f"own.{kind}", own)
    columns = {"time": "t", "test_signal": "drive", "column_angle": "theta"}
    record = read_bench_record(path, experiment="servo-closed", columns=columns, units={"t": "s", "theta": "deg"})
    assert record.channels["column_angle"] == pytest.approx(np.radians(X), rel=ROUNDING)
    assert (record.hold, set(record.channels)) == ("straight", {"test_signal", "column_angle"})
    assert read_bench_record(
        path,
        experiment=CLOSED,
        columns={**columns, "test_signal": "drive_v"},
        units={"t": "s", "theta": "deg", "drive_v": "V"},
    ).channels["test_signal"] == pytest.approx(U, rel=ROUNDING)
    by_channel = read_bench_record(path, experiment=CLOSED, columns=columns, units={"time": "s", "column_angle": "rad"})
    assert by_channel.channels["column_angle"] == pytest.approx(X, rel=ROUNDING)


def test_column_name_of_the_file_takes_a_unit(tmp_path):
    path = write_csv(tmp_path / "own.csv", {"time (s)": T, "e_T (V)": U, "theta [deg]": X})
    columns = {"test_signal": "e_T (V)", "column_angle": "theta [deg]"}
    record = read_bench_record(path, experiment="servo-closed", columns=columns)
    assert record.channels["column_angle"] == pytest.approx(np.radians(X), rel=ROUNDING)


def test_matlab_structure_fields_are_read(tmp_path):
    run = {
        "time_s": T[:, None],
        "test_signal_v": U[:, None],
        "column_angle_deg": X[:, None],
        "experiment": "servo-closed",
    }
    scipy.io.savemat(tmp_path / "run.mat", {"run": run, "gain": 3.0})
    record = read_bench_record(tmp_path / "run.mat")
    assert record.experiment == CLOSED
    assert record.channels["column_angle"] == pytest.approx(np.radians(X), rel=ROUNDING)


def test_unsupported_matlab_file_raises_input_error(tmp_path):
    header = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(116) + bytes(8) + b"\x00\x02IM" + bytes(400)
    (tmp_path / "new.mat").write_bytes(header)
    with pytest.raises(InputError, match=r"new\.mat: is a MATLAB file of version 7\.3; save it with -v7"):
        read_bench_record(tmp_path / "new.mat")
    (tmp_path / "text.mat").write_text("time_s", encoding="utf-8")
    with pytest.raises(InputError, match=r"text\.mat: cannot be read as a MATLAB file"):
        read_bench_record(tmp_path / "text.mat")
    run = {"time_s": T, "test_signal_v": U, "column_angle_deg": X, "experiment": "servo-open"}
    scipy.io.savemat(tmp_path / "short.mat", {**run, "column_angle_deg": X[:9]})
    with pytest.raises(
        InputError, match=r"expected as many values of each column, got 200 of time, 200 of test_signal, 9 of"
    ):
        read_bench_record(tmp_path / "short.mat")
    scipy.io.savemat(tmp_path / "complex.mat", {**run, "column_angle_deg": X * 1j})
    with pytest.raises(InputError, match="column_angle: expected real numbers"):
        read_bench_record(tmp_path / "complex.mat")
    scipy.io.savemat(tmp_path / "empty.mat", {"a": 1.0})
    with pytest.raises(InputError, match="holds no rows of numbers"):
        read_bench_record(tmp_path / "empty.mat")


BAD_RECORDS = {
    "no time": ({"test_signal (V)": U, "column angle (deg)": X}, {}, "has no column 'time'"),
    "no drive": ({"time (s)": T, "column angle (deg)": X}, {}, "has no column 'test_signal'"),
    "nothing measured": ({"time (s)": T, "test_signal (V)": U, "tilt (deg)": X}, {}, "has no measured channel"),
    "wrong unit": (
        {**RECORD, "column angle (deg)": X, "potentiometer (deg)": X},
        {},
        "potentiometer: 'deg' measures an angle",
    ),
    "twice": ({**RECORD, "column_angle_rad": X}, {}, "has 2 columns 'column_angle'"),
    "no such column": (
        RECORD,
        {"columns": {"potentiometer": "pot"}},
        "has no column 'pot' for potentiometer; the columns are",
    ),
    "no such channel": (
        RECORD,
        {"columns": {"angle": "theta"}},
        "columns: unknown name 'angle'; the names are time, test_signal",
    ),
    "hold": (RECORD, {"hold": "curved"}, "hold: expected straight or staircase, got 'curved'"),
    "release": (
        {"time (s)": T, "test_signal (V)": U, "potentiometer (V)": X},
        {"experiment": "release"},
        "has no column 'column_angle'",
    ),
}


@pytest.mark.parametrize("kind", ["csv", "parquet"])
@pytest.mark.parametrize(("columns", "arguments", "message"), BAD_RECORDS.values(), ids=BAD_RECORDS)
def test_invalid_record_raises_input_error(tmp_path, kind, columns, arguments, message):
    path = WRITERS[kind](tmp_path / f"bad.{kind}", columns)
    with pytest.raises(InputError, match=message) as caught:
        read_bench_record(path, **{"experiment": "servo-closed", **arguments})
    assert str(path) in str(caught.value)


def test_hold_that_contradicts_the_file_raises_input_error(tmp_path):
    path = write_csv(tmp_path / "run.csv", RECORD, {"experiment": "servo-closed", "hold": "staircase"})
    with pytest.raises(InputError, match="states 'hold: staircase', but the argument hold is 'straight'"):
        read_bench_record(path, hold="straight")


def test_line_numbers_count_comments(tmp_path):
    columns = {**RECORD, "column angle (deg)": np.where(T == 0.5, np.nan, X)}
    path = write_csv(
        tmp_path / "run.csv", columns, {"experiment": "servo-closed", "loader": "mine", "hold": "straight"}
    )
    with pytest.raises(InputError, match=r"run\.csv: line 55: column_angle: expected a finite number"):
        read_bench_record(path)  # three comments, the header, and 50 samples before it
    write_parquet(tmp_path / "run.parquet", columns, {"experiment": "servo-closed"})
    with pytest.raises(InputError, match=r"run\.parquet: row 51: expected finite numbers"):
        read_bench_record(tmp_path / "run.parquet")


def test_columns_distinguish_record_from_response(tmp_path):
    (tmp_path / "response.csv").write_text(TO_POTENTIOMETER + LINES, encoding="utf-8")
    assert isinstance(read_bench_data(tmp_path / "response.csv"), Response)
    record = write_csv(tmp_path / "record.csv", RECORD)
    assert isinstance(read_bench_data(record, experiment="servo-closed"), BenchRecord)
    own = write_csv(tmp_path / "own.csv", {"T (s)": T, "test_signal_v": U, "column_angle_rad": X})
    assert isinstance(read_bench_data(own, experiment="servo-closed", columns={"time": "t"}), BenchRecord)
    with pytest.raises(InputError, match="has neither a column 'frequency' nor 'time'"):
        read_bench_data(own, experiment="servo-closed")
    with pytest.raises(InputError, match="is a record in time, to which the argument output does not apply"):
        read_bench_data(record, output="column_angle")
    with pytest.raises(InputError, match="is a frequency response, to which the argument hold does not apply"):
        read_bench_data(tmp_path / "response.csv", hold="straight")
    both = write_csv(tmp_path / "both.csv", {"time (s)": T, "frequency (Hz)": T})
    with pytest.raises(InputError, match="has both a column 'frequency' and one 'time'"):
        read_bench_data(both)


def test_file_without_table_raises_input_error(tmp_path):
    with pytest.raises(
        InputError, match=r"expected a file that ends in \.csv, \.parquet, \.mat or \.mcap, got 'run\.txt'"
    ):
        read_bench_data(tmp_path / "run.txt")
    with pytest.raises(InputError, match=r"none\.csv: cannot be read"):
        read_bench_data(tmp_path / "none.csv")
    (tmp_path / "text.parquet").write_text("time (s)", encoding="utf-8")
    with pytest.raises(InputError, match=r"text\.parquet: cannot be read as Parquet"):
        read_bench_data(tmp_path / "text.parquet")
    words = {"time (s)": T, "test_signal (V)": U, "column angle (deg)": np.array(["a"] * 200)}
    with pytest.raises(InputError, match="column_angle: expected a column of numbers"):
        read_bench_record(write_parquet(tmp_path / "words.parquet", words), experiment="servo-closed")


@pytest.mark.parametrize(
    ("kind", "came"),
    [
        (pyarrow.timestamp("ns"), "dates"),
        (pyarrow.timestamp("us", tz="UTC"), "dates"),
        (pyarrow.duration("ms"), "durations"),
    ],
)
def test_date_or_duration_column_raises_input_error(tmp_path, kind, came):
    stamps = pyarrow.array((1000 * T).astype(np.int64)).cast(kind)
    path = write_parquet(tmp_path / "run.parquet", {**RECORD, "time (s)": stamps})
    message = rf"run\.parquet: time: expected a column of numbers, got {came} \(.*\); .*seconds since the first sample"
    with pytest.raises(InputError, match=message):
        read_bench_record(path, experiment="servo-closed")


@pytest.mark.parametrize("kind", WRITERS)
@pytest.mark.parametrize(
    ("unit", "scale", "message"),
    [
        ("s", 1000.0, r"time: has a median step of 10 s; expected .*; is the time in ms\? .*'time \(ms\)'"),
        ("ms", 0.001, r"time: has a median step of 1e-08 s; expected .*; is the time in s, not in ms\? .*'time \(s\)'"),
    ],
)
def test_time_in_another_unit_raises_input_error(tmp_path, kind, unit, scale, message):
    columns = {f"time ({unit})": scale * T, **{name: values for name, values in RECORD.items() if "time" not in name}}
    path = WRITERS[kind](tmp_path / f"run.{kind}", columns)
    with pytest.raises(InputError, match=message) as caught:
        read_bench_record(path, experiment="servo-closed")
    assert str(caught.value).startswith(str(path))


@pytest.mark.parametrize(("mark", "words"), [(";", "semicolons"), ("\t", "tabs")])
@pytest.mark.parametrize("quote", ["", '"'])
def test_columns_without_commas_raise_input_error(tmp_path, mark, words, quote):
    header = mark.join(f"{quote}{name}{quote}" for name in ("time (s)", "test_signal (V)", "column_angle (deg)"))
    rows = [mark.join(("0,01", "1,5", "0,2"))] * 200
    (tmp_path / "run.csv").write_text("\n".join(["# experiment: servo-closed", "", header, *rows]), encoding="utf-8")
    with pytest.raises(InputError, match=rf"run\.csv: line 3: is parted by {words}; use commas"):
        read_bench_data(tmp_path / "run.csv")
