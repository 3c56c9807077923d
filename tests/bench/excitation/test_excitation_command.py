"""``forcefeel excite`` as a user types it, and the file that it writes."""

import json

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.bench.excitation import ExcitationPlan, excite, write_excitation
from forcefeel.bench.experiments import Experiment
from forcefeel.bench.record_file import read_bench_record
from forcefeel.simulation.inputs import read_recorded
from forcefeel.units import UnitSystem
from tests.command_line import runs
from tests.parametrization import mostly_slow

PLAN = ExcitationPlan(time_s=13.0, rate_hz=500.0, to_hz=40.0)
SHORT = ("--time", "13", "--rate", "500", "--to", "40")
DIGITS = 1e-8  # of nine digits that a file holds


run = runs("excite")


def rows(path):
    """Comment lines, header and numbers of a file."""
    lines = path.read_text(encoding="utf-8").splitlines()
    about = [line for line in lines if line.startswith("#")]
    header, *numbers = lines[len(about) :]
    return about, header, np.array([[float(it) for it in line.split(",")] for line in numbers])


def test_command_prints_the_expected_summary(run, tmp_path):
    status, out, err = run("elevator-1974", "--fit", "k,c,J,C_i", *SHORT, "--out", "excite.csv")
    assert (status, err) == (0, "")
    plain = " ".join(out.split())
    for words in (
        "servo-closed test_signal: multisine, 65 lines from 0.5 to 40 Hz, 6 periods of 2 s",
        "Predicted standard errors",
        "linkage.stiffness",
        "6108 lb/in",
        "80 % of the valve's rating",
        "two thirds of supply pressure times piston area",
        "All parameters are determined; the largest standard error is",
        "The active limit is the ",
        "20 % of the power is spread evenly over all lines",
        "file: excite.csv",
    ):
        assert words in plain, words
    assert [one.name for one in tmp_path.iterdir()] == ["excite.csv"]


@pytest.mark.slow
def test_json_matches_the_library_result(run, tmp_path):
    status, out, _ = run("elevator-1974", "--fit", "k,c,J,C_i", *SHORT, "--json", "--units", "si")
    found, told = excite(ff.elevator(), "k,c,J,C_i", plan=PLAN), json.loads(out)
    assert status == 0
    errors = {key: it["relative_standard_error"] for key, it in told["parameters"].items()}
    assert errors == pytest.approx(found.standard_errors, rel=DIGITS)
    assert told["binding"] == found.binding.limit.name
    assert told["peak"] == {"value": pytest.approx(found.peak, rel=DIGITS), "unit": "V"}
    assert told["limits"]["travel"]["limit"] == pytest.approx(10.0)
    assert told["limits"]["force"]["unit"] == "N"
    np.testing.assert_allclose(told["lines"]["power_v2"], found.power, rtol=DIGITS)
    assert told["file"] == "forcefeel-excite.csv"
    assert (tmp_path / "forcefeel-excite.csv").exists()


@pytest.mark.slow
def test_csv_contains_signal_and_description(tmp_path):
    found = excite(ff.elevator(), "k,c,J,C_i", plan=PLAN)
    about, header, numbers = rows(write_excitation(found, tmp_path / "e.csv"))
    assert about[:2] == ["# experiment: servo-closed test_signal", "# loader: elevator-1974"]
    assert sum("predicted standard error" in line for line in about) == 4
    assert sum(" predicted of " in line for line in about) == 4
    assert header == "time (s),test_signal (V)"
    np.testing.assert_allclose(numbers, np.column_stack([found.time_s, found.signal]), atol=DIGITS * found.peak)


@pytest.mark.parametrize(
    ("units", "header"), mostly_slow([(UnitSystem.US, "pilot_force (lb)"), (UnitSystem.SI, "pilot_force (N)")])
)
def test_force_column_has_its_unit(tmp_path, units, header):
    found = excite(ff.elevator(), "k,J", "loader", PLAN)
    path = write_excitation(found, tmp_path / "e.csv", units)
    about, head, _ = rows(path)
    assert about[0] == "# experiment: loader pilot_force"
    assert head == f"time (s),{header}"
    np.testing.assert_allclose(read_recorded(path).force_n, found.signal, atol=DIGITS * found.peak)


@pytest.mark.slow
def test_file_with_measured_columns_is_a_bench_record(tmp_path):
    found = excite(ff.elevator(), "k,c,J,C_i", plan=PLAN)
    lines = write_excitation(found, tmp_path / "e.csv").read_text().splitlines()
    about = sum(line.startswith("#") for line in lines)
    angle = np.sin(np.arange(len(found.time_s)) / 50) * np.minimum(np.arange(len(found.time_s)) / 500, 1.0) ** 2
    measured = [*lines[:about], f"{lines[about]},column angle (deg)"]
    measured += [f"{line},{value:.9g}" for line, value in zip(lines[about + 1 :], angle, strict=True)]
    (tmp_path / "measured.csv").write_text("\n".join(measured) + "\n")
    record = read_bench_record(tmp_path / "measured.csv")
    assert record.experiment == Experiment.read("servo-closed")
    np.testing.assert_allclose(record.channels["test_signal"], found.signal, atol=DIGITS * found.peak)
    np.testing.assert_allclose(record.channels["column_angle"], np.radians(angle), atol=DIGITS)


def test_options_reach_the_design(run, tmp_path):
    status, out, _ = run(
        *(
            "elevator-1974",
            "--fit",
            "J",
            *SHORT,
            "--signal",
            "chirp",
            "--from",
            "2",
            "--measure",
            "column angle,valve_current",
        ),
        *("--noise", "2 %", "--noise", "column_angle=0.05 deg", "--limit-current", "3 mA", "--limit-travel", "2 deg"),
        *("--limit-force", "500 lb", "--limit-drive", "1 V", "--set", "column.inertia=30 lb in s^2/rad", "--json"),
    )
    told = json.loads(out)
    assert status == 0
    assert told["kind"] == "chirp"
    assert told["period_s"] is None
    assert told["lines"]["frequency_hz"][0] == 2.0
    assert told["parameters"]["column.inertia"]["value"] == pytest.approx(30.0)
    assert told["noise"]["column_angle"] == {"deviation": pytest.approx(np.radians(0.05)), "unit": "rad"}
    limits = {name: (it["limit"], it["unit"]) for name, it in told["limits"].items()}
    assert limits == {
        "current": (pytest.approx(3.0), "mA"),
        "travel": (pytest.approx(2.0), "deg"),
        "force": (pytest.approx(500.0), "lb"),
        "drive": (pytest.approx(1.0), "V"),
    }


@pytest.mark.slow
def test_existing_file_is_replaced_only_with_replace(run, tmp_path):
    (tmp_path / "e.csv").write_text("mine")
    status, _, err = run("elevator-1974", "--fit", "J", *SHORT, "--out", "e.csv")
    assert status == 2
    assert "e.csv: is there already; give another name, or --replace to replace it" in err
    assert (tmp_path / "e.csv").read_text() == "mine"
    assert run("elevator-1974", "--fit", "J", *SHORT, "--out", "e.csv", "--replace")[0] == 0
    assert rows(tmp_path / "e.csv")[1] == "time (s),test_signal (V)"


def test_inseparable_parameters_exit_1_without_output(run, tmp_path):
    status, out, err = run("elevator-1974", "--fit", "K_2,C_i,J", *SHORT)
    assert (status, out) == (1, "")
    assert "cannot tell K_2 (amplifier.admittance) and C_i (valve.current_gain) apart" in err
    assert not list(tmp_path.iterdir())


def test_undetermined_parameters_exit_1(run, tmp_path):
    status, out, _ = run("elevator-1974", "--fit", "c", *SHORT, "--noise", "100000 %")
    assert status == 1
    assert "Not determined: c (linkage.damping)" in " ".join(out.split())
    assert len(list(tmp_path.iterdir())) == 1


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--fit", "zz"), "fit: unknown parameter 'zz'"),
        (("--fit", "B"), "B (feel.damping) changes nothing that is measured in servo-closed test_signal"),
        (("--fit", "J", "--experiment", "release"), "a release is its own excitation"),
        (("--fit", "J", "--rate", "100", "--to", "40"), "rate: expected 4 samples in a cycle"),
        (("--fit", "J", "--time", "1", "--from", "0.5"), "time: expected 6 whole periods of 2 s at least, 12.5 s"),
        (("--fit", "J", "--limit-current", "-3 mA"), "limits: expected current to be a number above 0"),
        (("--fit", "J", "--limit-travel", "3 lb"), "--limit-travel: expected a number with its unit such as '8 deg'"),
        (("--fit", "J", "--limit-drive", "3"), "--limit-drive: expected a number with its unit such as '5 V'"),
        (("--fit", "J", "--noise", "1 deg"), "--noise: expected a number such as '1 %'"),
        (("--fit", "J", "--noise", "1 %", "--noise", "2 %"), "--noise: expected one share for all channels"),
        (("--fit", "J", "--noise", "column=1 deg"), "unknown channel 'column'"),
        (("--fit", "J", "--measure", "speed"), "unknown channel 'speed'"),
        (("--fit", "J", "--out", "e.txt"), "e.txt: expected a name that ends in .csv"),
        (("--fit", "J", "--out", "no/e.csv"), "no/e.csv: expected a folder no to write it into"),
        (
            ("--fit", "J", "--law", "published"),
            "--law: is the law of the whole loader, and servo-closed test_signal is of the servo alone; leave it out",
        ),
        (("--fit", "J", "--law", "observer"), "--law: is the law of the whole loader"),
        (
            ("--fit", "J", "--experiment", "loader", "--law", "observer"),
            "--law: controller.period: expected a sample period",
        ),
    ],
)
def test_invalid_input_exits_2_without_output(run, tmp_path, words, message):
    status, out, err = run("elevator-1974", *words)
    assert (status, out) == (2, "")
    assert message in err
    assert not list(tmp_path.iterdir())
