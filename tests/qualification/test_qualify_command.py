"""``forcefeel qualify`` as a user types it: what is printed, what is written, the exit status."""

import hashlib
import json
import math
from pathlib import Path

import numpy as np
import pyarrow
import pytest
import scipy.io
from pyarrow import parquet

import forcefeel as ff
from tests.command_line import runs
from tests.parametrization import mostly_slow

WRITTEN = {"plotly.min.js", "qualification.html", "results.json"}
ANGLE_DEG = 5.0
"""A quarter of the 20 deg that a loader without stops is given."""
FIVE_DIGITS_S = 5e-6
NO_NOISE_S = 2e-6
"""Of an uncertainty: what interpolation between samples is thought to leave. Measured: 1.3e-7."""
PUBLISHED_P0_S = 0.16866
"""Of the elevator under the published gains; ``test_qualify`` has it from the loop's matrices."""


run = runs("qualify", report=True, lines=True)


def _free(slower=1.0, angle=ANGLE_DEG, rate=1000.0, seconds=4.0):
    """Time in s and angle in deg of the programmed feel, let go after 0.2 s."""
    loader = ff.elevator()
    i, b, g = (loader[f"feel.{name}"] for name in ("inertia", "damping", "stiffness"))
    w, zeta = math.sqrt(g / i) * slower, b / (2 * math.sqrt(g * i))
    time = np.arange(round((seconds + 0.2) * rate)) / rate
    t, root = np.maximum(time - 0.2, 0.0), math.sqrt(1 - zeta**2)
    swing = np.cos(root * w * t) + zeta / root * np.sin(root * w * t)
    return time, angle * np.exp(-zeta * w * t) * swing


def _csv(path: Path, time, angle, head="time (s),position (deg)") -> None:
    rows = "\n".join(f"{t:.9f},{x:.12g}" for t, x in zip(time, angle, strict=True))
    path.write_text(f"{head}\n{rows}\n", encoding="utf-8")


def _files(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()}


def _outcomes(found) -> dict[str, str]:
    (section,) = found["sections"]
    return {test["key"]: test["outcome"] for test in section["tests"]}


def test_help_names_every_option_with_an_example(run):
    status, out, _ = run("--help")
    assert status == 0
    assert "Example:" in out
    for option in (
        "--reference",
        "--record",
        "--rule",
        "--test",
        "--axis",
        "--throw",
        "--law",
        "--compare",
        "--pdf",
        "--json",
    ):
        assert option in out


def test_the_elevator_fails_with_words_and_files(run, tmp_path):
    status, out, err = run("--law", "published")
    told = " ".join(out.split())
    assert (status, err) == (1, "")
    assert "law published does not qualify: 1 of 7 tests passed, 6 failed." in told
    assert "Tests that cannot be simulated: surface (2.a.1.a; a control loader has no surface)" in told
    assert "P0 is 59 % too long" in told
    assert "1.97 Hz programmed" in told
    assert "Not verified against the document: the durations of the sweeps" in told
    assert out.splitlines()[-1] == "page: forcefeel-qualification/qualification.html"
    assert _files(tmp_path / "forcefeel-qualification") == WRITTEN


@pytest.mark.slow
def test_json_holds_every_figure_with_unit_and_margin(run, tmp_path):
    named = ("--test", "static", "--test", "release-25-positive")  # all of them take their time
    status, out, _ = run("--compare", *named, "--json", "--units", "si")
    found = json.loads(out)
    assert status == 1
    assert found["page"] == "forcefeel-qualification/qualification.html"
    assert [section["name"] for section in found["sections"]] == ["original", "published", "converged"]
    assert found["rule"]["id"] == "part60-a-2014"
    assert found["rule"]["unverified"] == ["the durations of the sweeps"]
    tests = {test["key"]: test for test in found["sections"][1]["tests"]}
    first = next(one for one in tests["release-25-positive"]["verdicts"] if one["quantity"] == "P0")
    assert first["measured"] == {
        "value": pytest.approx(PUBLISHED_P0_S, abs=FIVE_DIGITS_S),
        "unit": "s",
        "uncertainty": pytest.approx(0, abs=NO_NOISE_S),
    }
    assert first["margin"]["value"] == pytest.approx(first["tolerance"]["value"] - first["difference"]["value"])
    assert first["rule"] == "10 %"
    assert tests["static"]["verdicts"][0]["rule"] == "0.9 daN"  # the rule's own rounding for SI
    assert found["status"] == "does not qualify"
    assert found["tests_not_simulated"] == ["surface", "small-inputs", "trim-indicator", "trim-rate"]
    assert list(tests) == found["named"] == ["static", "release-25-positive"]
    assert set(tests) < set(found["test_plan"])
    kept = json.loads((tmp_path / "forcefeel-qualification" / "results.json").read_text(encoding="utf-8"))
    assert {key: value for key, value in found.items() if key != "page"} == kept


def test_unverified_rule_is_stated(run):
    test = ("--test", "release-25-positive")
    found = json.loads(run("--rule", "cs-fstd-a", "--law", "published", *test, "--json")[1])
    assert not found["rule"]["verified"]
    assert all(not test["verified"] for test in found["sections"][0]["tests"])
    assert any("Not verified against the document: test" in line for line in found["conclusions"]["findings"])


@pytest.mark.slow
def test_single_release_is_incomplete_unless_only_test_requested(run, tmp_path):
    _csv(tmp_path / "one.csv", *_free())
    status, out, err = run("--record", "one.csv", "--json")  # the test is told from what is in the file
    found = json.loads(out)
    assert (status, err) == (1, "")
    assert found["status"] == "incomplete"
    missing = [one["any_of"] for one in found["sections"][0]["missing"]]
    assert missing == [["static"], ["surface"], ["release-25-negative", "release-50-negative"], ["small-inputs"]]
    outcomes = _outcomes(found)
    assert outcomes.pop("release-25-positive") == "passed"
    assert set(outcomes.values()) == {"not evaluated"}
    told = found["files"]["record release-25-positive"]
    assert told["sha256"] == hashlib.sha256((tmp_path / "one.csv").read_bytes()).hexdigest()

    status, out, err = run(
        "--replace", "--record", "one.csv", "--test", "release-25-positive", "--operator", "A. Miller"
    )
    said = " ".join(out.split())
    assert (status, err) == (0, "")
    assert "is incomplete: 1 of 1 tests passed (requested: release-25-positive). Missing: static, surface, " in said
    kept = json.loads((tmp_path / "forcefeel-qualification" / "results.json").read_text(encoding="utf-8"))
    assert (kept["named"], kept["operator"]) == (["release-25-positive"], "A. Miller")
    assert _outcomes(kept) == {"release-25-positive": "passed"}
    assert run("--replace", "--record", "one.csv", "--test", "static")[0] == 1  # asked for, and not there


@pytest.mark.slow
def test_the_digital_elevator_qualifies_under_robust(run):
    """All that a control loader can be given passes: exit status 0, and what is outside its programme is named."""
    status, out, _ = run("elevator-2khz", "--law", "robust", "--json")
    found = json.loads(out)
    assert (status, found["status"], found["conclusions"]["ok"]) == (0, "qualifies", True)
    assert found["conclusions"]["verdict"].endswith("law robust qualifies: 7 of 7 tests passed.")
    assert found["sections"][0]["missing"] == []
    assert found["tests_not_simulated"] == ["surface", "small-inputs", "trim-indicator", "trim-rate"]


@pytest.mark.parametrize("ending", mostly_slow(["csv", "parquet", "mat"]))
def test_slightly_detuned_just_fails_from_each_format(run, tmp_path, ending):
    for name, slower, expected in (("good", 1 / 1.098, 0), ("bad", 1 / 1.102, 1)):
        time, angle = _free(slower)
        path = tmp_path / f"{name}.{ending}"
        if ending == "csv":
            _csv(path, time, angle)
        elif ending == "mat":
            scipy.io.savemat(path, {"time_s": time, "position_deg": angle})
        else:
            parquet.write_table(pyarrow.table({"time (s)": time, "position (deg)": angle}), path)
        asked = ("--test", "release-25-positive", "--json", "--out", name)
        status, out, _ = run("--record", f"release-25-positive={path}", *asked)
        assert status == expected
        assert _outcomes(json.loads(out))["release-25-positive"] == ("failed" if expected else "passed")


def test_a_folder_of_files_named_after_tests(run, tmp_path):
    folder = tmp_path / "bench"
    folder.mkdir()
    _csv(folder / "release-25-positive.csv", *_free())
    _csv(folder / "release-50-negative.csv", *_free(angle=-2 * ANGLE_DEG))
    (folder / "notes.txt").write_text("mine", encoding="utf-8")
    found = json.loads(run("--record", "bench", "--json")[1])
    outcomes = _outcomes(found)
    assert {key for key, outcome in outcomes.items() if outcome == "passed"} == {
        "release-25-positive",
        "release-50-negative",
    }


def test_sweeps_are_identified_by_content(run, tmp_path):
    loader = ff.elevator()
    per_degree = math.radians(loader["feel.stiffness"] / loader["column.grip_arm"])  # N for a degree
    for name, lasts in (("a", 98.0), ("b", 10.0), ("c", 4.0)):
        time = np.linspace(0.0, lasts, 4001)
        angle = 18.0 * np.sin(2 * math.pi * time / lasts)
        rows = "\n".join(f"{t:.6f},{x:.9g},{per_degree * x:.9g}" for t, x in zip(time, angle, strict=True))
        (tmp_path / f"{name}.csv").write_text(f"time (s),position (deg),force (N)\n{rows}\n", encoding="utf-8")
    found = json.loads(run("--record", "a.csv", "--record", "b.csv", "--record", "c.csv", "--json")[1])
    assert {name: one["name"] for name, one in found["files"].items()} == {
        "record static": "a",
        "record medium": "b",
        "record fast": "c",
    }
    assert _outcomes(found)["static"] == "passed"


def test_a_recorded_aircraft_is_the_reference(run, tmp_path):
    """A loop of another frequency than the aircraft's fails, the aircraft's own recording passes."""
    _csv(tmp_path / "aircraft.csv", *_free())
    asked = ("--reference", "aircraft.csv", "--test", "release-25-positive")
    status, out, _ = run(*asked, "--law", "published", "--json")
    found = json.loads(out)
    assert status == 1
    assert found["reference"] == "recorded aircraft"
    words = {test["key"]: test["summary"] for test in found["sections"][0]["tests"]}
    assert "1.97 Hz recorded" in words["release-25-positive"]
    assert run("--replace", *asked, "--record", "aircraft.csv")[0] == 0


BAD = {
    "short.csv": (lambda t, x: (t[:260], x[:260]), "ends at 0.259 s"),
    "clipped.csv": (lambda t, x: (t, np.maximum(x, -1.5)), "clipped: is clipped at -1.5 deg from 0."),
    "still.csv": (lambda t, x: (t, np.full_like(x, 5.0)), "still: has no release"),
    "gap.csv": (lambda t, x: (t + 0.5 * (t > 1.0), x), "gap.csv: line 1003: a gap of 0.501 s after 1 s"),
    "back.csv": (lambda t, x: (np.where(t > 1.0, t - 0.5, t), x), "back.csv: line 1003: time runs backwards from 1 s"),
}


@pytest.mark.parametrize("name", [*BAD, "unit.csv", "missing.csv"])
def test_bad_record_error_gives_time_and_writes_nothing(run, tmp_path, name):
    if name == "unit.csv":
        _csv(tmp_path / name, *_free(), head="time (s),position (parsec)")
        said = "unit.csv: line 1: position: unknown unit 'parsec'"
    elif name == "missing.csv":
        said = "missing.csv: cannot be read"
    else:
        change, said = BAD[name]
        _csv(tmp_path / name, *change(*_free()))
    before = _files(tmp_path)
    status, out, err = run("--record", f"release-25-positive={name}")
    assert (status, out) == (2, "")
    assert said in err
    assert "Traceback" not in err
    assert _files(tmp_path) == before


@pytest.mark.parametrize(("slower", "expected"), [(1 / 1.098, "passed"), (1 / 1.102, "failed")])
def test_an_aircraft_at_60_hz_and_a_simulator_at_100_hz(run, tmp_path, slower, expected):
    """P0 and the full cycles are 10 % of the reference's long at most."""
    _csv(tmp_path / "simulator.csv", *_free(slower, rate=100.0))
    _csv(tmp_path / "aircraft.csv", *_free(rate=60.0))
    found = json.loads(run("--record", "simulator.csv", "--reference", "aircraft.csv", "--json")[1])
    assert _outcomes(found)["release-25-positive"] == expected
    verdicts = next(test for test in found["sections"][0]["tests"] if test["key"] == "release-25-positive")["verdicts"]
    cycle = next(one for one in verdicts if one["quantity"] == "P1")
    assert cycle["measured"]["value"] * slower == pytest.approx(cycle["reference"]["value"], rel=1e-4)  # of six samples


@pytest.mark.slow
def test_the_history_of_a_simulated_release_is_a_record(run, forcefeel):
    words = ("--input", "release", "--angle", f"{ANGLE_DEG} deg", "--start", "0.2", "--duration", "6")
    forcefeel("simulate", "elevator-1974", *words, "--law", "published", "--out", "run")
    found = json.loads(run("--record", "run/history.csv", "--json")[1])
    tests = {test["key"]: test for test in found["sections"][0]["tests"]}
    first = next(one for one in tests["release-25-positive"]["verdicts"] if one["quantity"] == "P0")
    assert first["measured"]["value"] == pytest.approx(PUBLISHED_P0_S, abs=FIVE_DIGITS_S)


@pytest.mark.slow
def test_files_with_custom_names_and_units_are_read(run, tmp_path):
    """As ``identify`` has it: for all files, or for one by its stem."""
    time, angle = _free()
    _csv(tmp_path / "sim.csv", 1000 * time, np.radians(angle), head="# of the simulator\nt,theta")
    scipy.io.savemat(tmp_path / "aircraft.mat", {"time_s": time, "column_angle_deg": angle})
    key = "release-25-positive"
    words = ("--record", f"{key}=sim.csv", "--reference", f"{key}=aircraft.mat", "--test", key, "--json")
    named = [f"--column=sim:{one}" for one in ("time=t", "position=theta")]
    named += [f"--unit=sim:{one}" for one in ("t=ms", "theta=rad")]
    status, out, err = run(*words, *named)
    assert (status, err) == (0, "")
    assert _outcomes(json.loads(out))["release-25-positive"] == "passed"
    for options, said in (
        (named[:2], "sim.csv: line 2: time: has no unit; expected one such as s; add it to the header or by --unit"),
        (
            (),
            "sim.csv: line 2: has no column 'time'; expected a header such as 'time (s),position (deg),force (lb)', got 't,theta'",
        ),
        (
            ("--column", "simulator:time=t"),
            "--column: 'simulator' matches no file; expected one of aircraft, sim before",
        ),
        (
            ("--column", "sim:angle=theta"),
            "sim.csv: --column: unknown name 'angle'; the names are time, position, force, surface",
        ),
        (("--unit", "time=s", "--unit", "sim:force=lb in lb"), "has no column 'time'"),
    ):
        status, out, err = run(*words, "--replace", *options)
        assert (status, out) == (2, "")
        assert said in err


def test_time_in_wrong_unit_raises_input_error(run, tmp_path):
    time, angle = _free()
    _csv(tmp_path / "one.csv", 1e-3 * time, angle, head="time (s),position (deg)")
    status, _, err = run("--record", "one.csv")
    assert status == 2
    assert (
        "one.csv: time: has a median step of 1e-06 s; expected 10 microseconds to 1 s; is the time in s, not in ms?"
        in err
    )


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--throw", "20"], "--throw: expected a number with its unit"),
        (["--throw", "-5 deg"], "throw: expected an angle above 0"),
        (["--rule", "part61"], "rule: expected one of"),
        (["--axis", "collective"], "none for collective; choose a rule with some: part60-c-2014, part60-d-2014"),
        (["--record", "a.csv", "--compare"], "--compare: is about the simulated loader"),
        (["--record", "a.csv", "--law", "published"], "--law: is about the simulated loader"),
        (["--compare", "--law", "published"], "--compare: takes every law"),
        (["--column", "position=theta"], "--column: requires a data file"),
        (["--record", "wheel=a.csv"], "--record: unknown test 'wheel'; expected NAME=FILE"),
        (["--test", "wheel"], "test: unknown test 'wheel'; expected some of static"),
        (["--test", "surface"], "test: surface cannot be simulated: a control loader has no surface"),
        (["--record", "a.txt"], "expected a file that ends in .csv, .parquet, .mat or .mcap"),
        (["--set", "column.nothing=1"], "column.nothing"),
        (["--dynamic-pressure", "5 kPa"], "dynamic pressure: the loader has no feel.stiffness_factor"),
        (["missing.toml"], "missing.toml: cannot be read"),
    ],
)
def test_bad_input_is_refused_in_a_line(run, tmp_path, words, said):
    status, out, err = run(*words)
    assert (status, out) == (2, "")
    assert said in err
    assert err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_two_files_for_same_test_are_refused(run, tmp_path):
    for name in ("a.csv", "b.csv"):
        _csv(tmp_path / name, *_free())
    status, _, err = run("--record", "a.csv", "--record", "b.csv")
    assert status == 2
    assert "b.csv and a.csv are both for the test release-25-positive; expected one; name each with NAME=FILE" in err


def test_a_pdf_without_a_chromium_is_refused_before_the_work(run, tmp_path, monkeypatch):
    monkeypatch.setenv("FORCEFEEL_CHROMIUM", "no-such-browser")
    status, out, err = run("--pdf")
    assert (status, out) == (2, "")
    assert "--pdf: the PDF is printed by Chromium, and 'no-such-browser' of FORCEFEEL_CHROMIUM is no program" in err
    assert list(tmp_path.iterdir()) == []


def test_file_as_output_folder_is_refused(run, tmp_path):
    (tmp_path / "out").write_text("mine", encoding="utf-8")
    status, _, err = run("--out", "out")
    assert status == 2
    assert "out: is a file; expected a folder" in err
