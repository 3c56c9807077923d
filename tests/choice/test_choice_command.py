"""``forcefeel law`` as a user types it, and the folder that it writes."""

import json
import re

import pytest

import forcefeel as ff
from forcefeel.choice import score as scoring
from forcefeel.choice.page.page import PAGE, RESULTS
from tests.command_line import runs

SMALL = ("--grid", "stiffness=10, 100 %", "--grid", "frequency=1, 3 Hz", "--grid", "damping=0.2, 1")
FOLDER = "forcefeel-law"


run = runs("law", columns=100, report=True)


def test_single_law_is_designed_at_the_default_setting(run, tmp_path):
    status, out, err = run("elevator-2khz", "--law", "robust")
    assert (status, err) == (0, "")
    assert "Robust is stable" in out
    assert "every case" not in out
    assert {one.name for one in (tmp_path / FOLDER).iterdir()} == {PAGE, RESULTS, "plotly.min.js"}
    stored = json.loads((tmp_path / FOLDER / RESULTS).read_text(encoding="utf-8"))
    assert (stored["chosen"], stored["law"]["period_s"]) == ("robust", 0.0005)
    assert "envelope" not in stored["laws"]["robust"]


def test_single_law_is_assessed_over_the_envelope(run):
    status, out, _ = run("--law", "converged", "--envelope", *SMALL, "--json", "--units", "si")
    assert status == 0
    found = json.loads(out)
    assert found["laws"]["converged"]["envelope"]["shares"]["stable"]["value"] > 0
    assert found["grid"]["frequency"]["values"] == pytest.approx([1, 3])


@pytest.mark.slow
def test_auto_chooses_a_law_with_reason(run, tmp_path, monkeypatch):
    names = ("published", "observer", "robust")
    monkeypatch.setattr(scoring, "names_for", lambda _: names)  # all seven take their time
    grid = ("--grid", "stiffness=30, 100 %", "--grid", "frequency=3, 4 Hz", "--grid", "damping=0.7, 1")
    status, out, err = run("elevator-2khz", "--law", "auto", *grid, "--out", "found")
    assert (status, err) == (0, "")
    stored = json.loads((tmp_path / "found" / RESULTS).read_text(encoding="utf-8"))
    assert tuple(stored["laws"]) == names
    assert f"Use {stored['chosen']}." in out
    text = re.sub(
        r"<(script|style).*?</\1>", "", (tmp_path / "found" / PAGE).read_text(encoding="utf-8"), flags=re.DOTALL
    )
    assert not re.search(r"\d\.\d{7}", re.sub(r"<[^>]*>", " ", text))


def test_no_eligible_law_exits_1(run):
    grid = ("--grid", "stiffness=1, 100 %", "--grid", "frequency=1, 3 Hz", "--grid", "damping=0.2, 1")
    status, out, _ = run("--law", "auto", *grid)
    assert status == 1
    assert "None of the 3 laws is eligible" in out
    assert "elevator-2khz" in out


def test_unstable_law_exits_1(run, tmp_path):
    soft = ff.elevator().replace(
        {"feel.inertia": "0.6 lb in s^2/rad", "feel.damping": "3.04 lb in s/rad", "feel.stiffness": "96 lb in/rad"}
    )
    (tmp_path / "soft.toml").write_text(soft.to_toml(), encoding="utf-8")
    status, out, _ = run("soft.toml", "--law", "published")
    assert status == 1
    assert "unstable" in out


def test_default_law_of_an_analog_loader_is_recursion_22(run, tmp_path):
    status, out, _ = run("--json")
    assert status == 0
    assert set(json.loads(out)) == {"loader", "compensation", "assessment", "peaks"}
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
def test_existing_output_is_not_overwritten(run, tmp_path):
    assert run("--law", "published")[0] == 0
    before = (tmp_path / FOLDER / RESULTS).read_bytes()
    status, _, err = run("--law", "converged")
    assert status == 2
    assert "--replace" in err
    assert (tmp_path / FOLDER / RESULTS).read_bytes() == before
    assert run("--law", "converged", "--replace")[0] == 0
    assert json.loads((tmp_path / FOLDER / RESULTS).read_text())["chosen"] == "converged"


def test_interrupted_run_writes_nothing(run, tmp_path, monkeypatch):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(scoring, "compute", interrupted)
    status, _, err = run("--law", "auto", *SMALL)
    assert status == 130
    assert "nothing is written" in err
    assert not (tmp_path / FOLDER).exists()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--law", "auto", "--r2", "0.05"), "--r2: is for recursion (22)"),
        (("--law", "robust", "--converge"), "--converge: is for recursion (22)"),
        (("--law", "auto", "--pilot-coupling", "column"), "--pilot-coupling: is for recursion (22)"),
        (("--law", "auto", "--horizon", "0.05"), "--horizon: is for recursion (22)"),
        (("--law", "best"), "original, published, converged"),
        (("--law", "robust"), "elevator-2khz"),
        (("--law", "auto", "--envelope"), "--envelope: is for one law"),
        (("--law", "published", *SMALL), "--grid: is for the envelope"),
        (("--law", "auto", "--grid", "mass=1..2:3"), "unknown axis"),
        (("--law", "auto", "--rule", "part61"), "part60-a-2014"),
        (("--out", "here"), "--out: does not go with --law report"),
        (("--replace",), "--replace: does not go with --law report"),
        (("--envelope",), "--envelope: does not go with --law report"),
        (SMALL, "--grid: does not go with --law report"),
        (("there-is-none.toml", "--law", "auto"), "there-is-none.toml"),
    ],
)
def test_invalid_input_exits_2_with_remedy(run, tmp_path, words, message):
    status, out, err = run(*words)
    assert (status, out) == (2, "")
    assert message in err
    assert "Traceback" not in err
    assert not list(tmp_path.iterdir())


def test_default_law_of_a_digital_loader_is_robust(run, tmp_path):
    status, _, _ = run("elevator-2khz", "--out", "laws")
    assert status == 0
    assert json.loads((tmp_path / "laws" / RESULTS).read_text())["chosen"] == "robust"
