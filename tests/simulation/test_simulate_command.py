"""``forcefeel simulate`` as a user types it: what is printed, what is written, the exit status."""

import json
import math
import re
from pathlib import Path

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.units import factor
from tests.command_line import imported, runs

UNSTABLE = ("feel.inertia=0.6 lb in s^2/rad", "feel.damping=3.04 lb in s/rad", "feel.stiffness=96 lb in/rad")
ROUNDING = 1e-12  # relative; a conversion, and all digits written
NINE_DIGITS = 1e-8  # relative rounding of nine significant digits
WRITTEN = {"simulation.html", "plotly.min.js", "history.csv", "results.json"}


run = runs("simulate", columns=100, report=True, lines=True)


def _set(*values: str) -> list[str]:
    return [word for value in values for word in ("--set", value)]


def _files(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_help_names_every_option_with_an_example(run):
    status, out, _ = run("--help")
    assert status == 0
    assert "Example:" in out
    assert "unverified" in out  # the firm arm is known by hearsay
    for option in ("--input", "--force", "--record", "--set", "--arm", "--trim", "--change", "--law", "--json"):
        assert option in out


def test_help_does_not_wait_for_the_numerical_libraries():
    libraries = {"numpy", "scipy", "control", "pandas", "pint", "plotly"}
    assert imported("simulate", "--help", libraries=libraries) == set()


def test_the_terminal_does_not_wait_for_plots():
    libraries = {"plotly"}
    assert imported("simulate", "--duration", "0.2", libraries=libraries) == set()


def test_step_prints_measures_and_conclusions(run, tmp_path):
    status, out, err = run()
    assert (status, err) == (0, "")
    assert "a step of 96 lb at 0.1 s" in out
    assert "10.78 deg" in out  # final angle, 60 % of the programmed one, as in test_cli and the README
    assert (
        "Settled at 1.34 s, overshoot 45.3 %, 1.68 Hz." in out
    )  # as exp(A t) around its equilibrium: test_measures_closed_form.py
    assert "3.146 mA" in out
    assert list(tmp_path.iterdir()) == []


def test_units_option_selects_units(run):
    _, out, _ = run("--units", "si")
    assert "a step of 427 N at 0.1 s" in out
    assert "2.32 MPa" in out


def test_loader_file_is_simulated(run, tmp_path):
    loader = ff.elevator().replace({"column.coulomb_friction": "3 lb", "feel.stiffness": "12000 lb in/rad"})
    (tmp_path / "my.toml").write_text(loader.to_toml(), encoding="utf-8")
    found = json.loads(run("my.toml", "--json")[1])
    assert found["loader"]["values"]["column.coulomb_friction"] == {"value": pytest.approx(3.0), "unit": "lb"}
    direct = ff.simulate(loader, ff.Scenario(force=ff.Step(loader["pilot.force"], 0.1)))
    final = found["measures"]["final_angle"]
    assert final == {"value": pytest.approx(math.degrees(direct.measures.final_angle_rad), rel=ROUNDING), "unit": "deg"}


def test_json_holds_every_number_with_its_unit(run):
    words = ["--input", "release", "--angle", "10 deg", *_set("column.coulomb_friction=3 lb"), "--arm", "loose"]
    status, out, _ = run(*words, "--law", "published", "--units", "si", "--json")
    found = json.loads(out)
    assert status == 0
    assert found["status"] == "settled"
    assert found["law"] == "published"
    assert found["scenario"]["force"]["kind"] == "release"
    assert found["measures"]["maximum_angle"] == {"value": pytest.approx(10.0), "unit": "deg"}
    assert found["measures"]["peak_pressure"]["unit"] == "MPa"
    assert found["limits"]["stuck"]["unit"] == "s"
    assert found["limits"]["stuck_at_end"] is True
    assert found["loader"]["values"]["pilot.arm_mass"] == {"value": pytest.approx(1.0), "unit": "kg"}
    assert found["conclusions"]["ok"] is True


def test_limits_are_stated_in_sentences(run):
    status, out, _ = run(
        *_set("column.coulomb_friction=3 lb", "column.static_friction=4 lb", "column.stop_high=12 deg"),
        *_set("column.stop_low=-12 deg", "valve.orifice=true", "amplifier.current_limit=2 mA"),
    )
    told = " ".join(out.split())
    assert status == 0
    assert re.search(r"The current was at the amplifier's limit of 2 mA for [\d.]+ % of the time", told)
    assert re.search(r"It was at the upper end stop for [\d.]+ s", told)
    assert re.search(r"Dry friction held the column for [\d.]+ s in all", told)


def test_diverged_run_exits_with_status_1_and_states_time(run, tmp_path):
    status, out, _ = run(*_set(*UNSTABLE), "--out", "run")
    assert status == 1
    assert "Diverged at 0.236 s: the column left every bound." in out
    assert not re.search(r"e\+?\d\d", out)
    assert set(_files(tmp_path / "run")) == WRITTEN  # a bad answer is an answer
    found = json.loads((tmp_path / "run" / "results.json").read_text(encoding="utf-8"))
    assert found["status"] == "diverged"
    assert found["measures"]["diverged_at"]["value"] == pytest.approx(0.236)
    assert {one["value"] for name, one in found["measures"].items() if name != "diverged_at"} == {"undefined"}
    values = np.loadtxt(tmp_path / "run" / "history.csv", delimiter=",", skiprows=1)
    assert np.all(np.isfinite(values))
    assert values[-1, 0] == pytest.approx(0.235)


def test_out_writes_page_history_and_numbers(run, tmp_path):
    status, out, _ = run("--input", "doublet", "--force", "20 lb", "--duration", "1.5", "--out", "runs/first")
    assert status == 0
    assert out.splitlines()[-1] == "page: runs/first/simulation.html"
    assert json.loads(run("--duration", "0.2", "--json", "--out", "other")[1])["page"] == "other/simulation.html"
    folder = tmp_path / "runs" / "first"
    assert set(_files(folder)) == WRITTEN
    asked = "created by <code>forcefeel simulate elevator-1974 --input doublet --force &#39;20 lb&#39; --duration 1.5</code>"
    assert asked in (folder / "simulation.html").read_text(encoding="utf-8")
    head, *rows = (folder / "history.csv").read_text(encoding="utf-8").splitlines()
    assert head.split(",") == [
        "time (s)",
        "column angle (deg)",
        "column velocity (deg/s)",
        "feel position (V)",
        "feel velocity (V/s)",
        "piston position (in)",
        "load cell force (lb)",
        "load pressure (lb/in^2)",
        "actuator flow (in^3/s)",
        "valve current (mA)",
        "pilot force (lb)",
    ]
    loader = ff.elevator()
    direct = ff.simulate(
        loader, ff.Scenario(force=ff.simulation.Doublet(20 * factor("lb", "N"), 0.1, 0.5), duration_s=1.5)
    )
    values = np.array([row.split(",") for row in rows], dtype=float)
    assert len(values) == 1501
    for column, (name, unit, shown) in enumerate(
        [("time_s", "s", "s"), ("column_angle_rad", "rad", "deg"), ("column_velocity_rad_per_s", "rad/s", "deg/s")]
    ):
        np.testing.assert_allclose(
            values[:, column], direct.history[name].values * factor(unit, shown), rtol=NINE_DIGITS
        )


@pytest.mark.slow
def test_history_can_be_used_as_recording(run, tmp_path):
    words = ["--duration", "1", "--law", "published"]
    run("--input", "chirp", "--force", "10 lb", "--to", "5 Hz", *words, "--out", "first")
    run("--record", "first/history.csv", *words, "--out", "second")
    first, second = (
        np.loadtxt(tmp_path / name / "history.csv", delimiter=",", skiprows=1) for name in ("first", "second")
    )
    # The force has nine digits, and what it moves as many.
    np.testing.assert_allclose(second, first, rtol=10 * NINE_DIGITS, atol=NINE_DIGITS * np.abs(first).max())


@pytest.mark.parametrize(
    "words",
    [
        ["--input", "pulse", "--force", "20 lb", "--width", "0.2"],
        ["--input", "stop-to-stop", "--force", "20 lb", "--duration", "4"],
        ["--input", "multisine", "--input-duration", "1 s", "--duration", "2", "--from", "1 Hz"],
        ["--input", "hands-off", "--set", "feel.shaker_force=10 lb", "--shaker", "1"],
        ["--trim", "0 s: 0 deg, 1 s: 5 deg", "--set", "feel.trim_rate=3 deg/s"],
        ["--change", "1 s: feel.stiffness=5000 lb in/rad", "--fade-time", "0.2 s"],
        ["--set", "controller.period=0.5 ms", "--set", "load_cell.noise=0.1 lb", "--seed", "3"],
        ["--arm", "firm", "--sample", "10 ms", "--step", "0.5 ms"],
        ["--law", "converged"],
    ],
)
def test_every_kind_of_run_succeeds(run, words):
    status, out, err = run(*words)
    assert (status, err) == (0, "")
    assert "The column" in out or "Settled" in out or "Still moving" in out


@pytest.mark.parametrize("kind", ["stop-to-stop", "hands-off"])
def test_results_name_the_input_as_the_command_does(run, kind):
    status, out, _ = run("--input", kind, "--duration", "0.1", "--json")
    assert status == 0
    assert json.loads(out)["scenario"]["force"]["kind"] == kind


def test_former_name_of_stop_to_stop_input_lists_valid_names(run):
    status, _, err = run("--input", "sweep")
    assert status == 2
    assert "stop-to-stop" in err


def test_seed_option_sets_noise_seed(run):
    words = [*_set("controller.period=0.5 ms", "load_cell.noise=2 lb"), "--duration", "0.3", "--json"]
    first, again, other = (json.loads(run(*words, "--seed", seed)[1])["measures"] for seed in (1, 1, 2))
    assert first == again
    assert first != other


NOT_MONOTONE = """
[feel.force_curve]
units = ["deg", "lb"]
points = [[-20, -60], [0, 0], [5, 18], [20, 15]]
"""
RECORDS = {
    "unit.csv": (
        "time (s),force\n0,0\n1,2\n",
        "unit.csv: line 1: force: has no unit; expected one such as N; add it to the header or by --unit",
    ),
    "percent.csv": (
        "time (s),force (N%)\n0,0\n1,2\n",
        "percent.csv: line 1: force: unknown unit 'N%'; a percent is a unit by",
    ),
    "name.csv": ("time (s),F1\n0,0\n1,2\n", "rename the column, or name it by --column"),
    "kind.csv": ("time (s),force (mA)\n0,0\n1,2\n", "measures a current, not a force"),
    "back.csv": ("time (s),force (lb)\n0,0\n1,2\n0.5,2\n", "back.csv: line 4: time runs backwards from 1 s to 0.5 s"),
    "gap.csv": (
        "time (s),force (lb)\n" + "".join(f"{t},1\n" for t in (0, 1, 2, 3, 40)),
        "gap.csv: line 6: a gap of 37 s",
    ),
    "text.csv": ("time (s),force (lb)\n0,0\n1,much\n", "text.csv: line 3: force: expected a number"),
    "short.csv": ("time (s),force (lb)\n0,0\n", "expected two rows of numbers at least"),
}


@pytest.mark.parametrize("name", [*RECORDS, "missing.csv"])
def test_bad_recording_is_named_and_output_is_kept(run, tmp_path, name):
    text, said = RECORDS.get(name, ("", "missing.csv: cannot be read"))
    if text:
        (tmp_path / name).write_text(text, encoding="utf-8")
    else:
        assert run("--duration", "0.2", "--out", "run")[0] == 0
    before = _files(tmp_path)
    status, out, err = run("--record", name, "--out", "run", "--replace")
    assert (status, out) == (2, "")
    assert said in err
    assert "Traceback" not in err
    assert err.count("\n") == 1
    assert _files(tmp_path) == before


@pytest.mark.parametrize(
    ("part", "row", "said"),
    [
        ("column", 'coulomb_friction = "-3 lb"', "column.coulomb_friction: out of range: expected 0 to 10000 lb"),
        ("column", 'stop_low = "5 deg"', "column.stop_low: out of range: expected -180 to 0 deg"),
        ("controller", 'period = "0 s"', "controller.period: out of range: expected 0.01 to 100 ms"),
        ("", NOT_MONOTONE, "feel.force_curve: expected y never to fall from point to point"),
    ],
)
def test_a_bad_loader_file_is_named_and_nothing_is_written(run, tmp_path, part, row, said):
    text = ff.elevator().to_toml()
    inserted = text.replace(f"[{part}]\n", f"[{part}]\n{row}\n") if part else text + row
    (tmp_path / "bad.toml").write_text(inserted, encoding="utf-8")
    status, out, err = run("bad.toml", "--out", "run")
    assert (status, out) == (2, "")
    assert f"bad.toml: {said}" in err
    assert [path.name for path in tmp_path.iterdir()] == ["bad.toml"]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--force", "20"], "--force: expected a number with its unit"),
        (["--set", "column.coulomb_friction=-3 lb"], "column.coulomb_friction: expected 0 to 10000 lb"),
        (["--set", "controller.period=0 s"], "controller.period: expected 0.01 to 100 ms"),
        (["--width", "1"], "--width: is for --input pulse or doublet"),
        (["--duration", "1e9"], "--duration: expected at most 2000000 steps"),
        (["--change", "0.0005 s: feel.breakout=1 lb"], "feel change: jumps at 0.0005 s"),
        (["--change", "1 s: valve.orifice=true"], "feel change: expected rows of the feel"),
        (
            ["--change", "1 s: feel.damping=200 lb in s/rad", "--fade-time", "5e-324"],
            "feel change: expected to take a step",
        ),
        (
            ["--set", "controller.period=0.5 ms", "--set", "controller.delay=0.123 ms"],
            "expected a simple share of the period",
        ),
        (["--dynamic-pressure", "5 kPa"], "dynamic pressure: the loader has no feel.stiffness_factor"),
        (["--set", "controller.period=0.5 ms", "--set", "controller.delay=50 ms"], "expected at most 7 periods"),
        (["missing.toml"], "missing.toml: cannot be read"),
    ],
)
def test_bad_input_is_refused_in_a_line(run, tmp_path, words, said):
    status, out, err = run(*words, "--out", "run")
    assert (status, out) == (2, "")
    assert said in err
    assert err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("words", [["--input", "steps"], ["--arm", "tight"], ["--law", "best"], ["--seed", "x"]])
def test_unknown_names_are_refused(run, words):
    assert run(*words)[0] == 2


def test_file_as_output_folder_is_refused(run, tmp_path):
    (tmp_path / "run").write_text("mine", encoding="utf-8")
    status, _, err = run("--out", "run")
    assert status == 2
    assert "run: is a file; expected a folder" in err
    assert (tmp_path / "run").read_text(encoding="utf-8") == "mine"
