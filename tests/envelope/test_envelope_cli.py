"""``forcefeel envelope`` as a user types it, and the folder that it writes."""

import csv
import io
import json
import re

import pytest
import xarray as xr

import forcefeel as ff
from forcefeel.envelope import outcomes
from forcefeel.envelope.page.page import PAGE, RESULTS, Files
from tests.command_line import runs

SMALL = (
    *("--grid", "stiffness=1..100 %:5:log"),
    *("--grid", "frequency=0.5..4 Hz:3:log"),
    *("--grid", "damping=0.2, 1.5"),
)
COUNT, CASES, DRAWN = 30, 32, 40


run = runs("envelope", report=True)


@pytest.mark.slow
def test_built_in_loader_is_compared(run, tmp_path):
    status, out, err = run("--compare", *SMALL, "--out", "found")
    assert (status, err) == (0, "")
    assert "passes in every case" in out
    assert f"of {COUNT} programmed feels" in " ".join(out.split())
    assert {one.name for one in (tmp_path / "found").iterdir()} == {*Files.of().names, RESULTS, "plotly.min.js"}
    with xr.open_dataset(tmp_path / "found" / Files.of().maps, engine="scipy") as stored:
        assert stored["outcome"].shape == (3, CASES, 2, 3, 5)
    rows = list(csv.reader(io.StringIO((tmp_path / "found" / Files.of().settings).read_text(encoding="utf-8"))))
    assert len(rows) == COUNT + 1
    assert rows[0][:2] == ["damping ratio", "natural frequency (Hz)"]
    assert {row[6] for row in rows[1:]} >= {"passes", "unstable", "P0"}


@pytest.mark.slow
def test_results_match_the_maps(run, tmp_path):
    status, out, _ = run("--law", "published", *SMALL, "--json", "--units", "si")
    assert status == 0
    found = json.loads(out)
    stored = json.loads((tmp_path / "forcefeel-envelope" / RESULTS).read_text(encoding="utf-8"))
    assert {key: value for key, value in found.items() if key != "page"} == stored
    assert found["releases"] == COUNT * (CASES + DRAWN)
    assert found["rule"] == {
        "edition": "part60-a-2014",
        "title": "14 CFR Part 60, Appendix A",
        "test": "2.b.1",
        "verified": True,
    }
    shares = found["laws"]["published"]["shares"]
    with xr.open_dataset(tmp_path / "forcefeel-envelope" / Files.of().maps, engine="scipy") as maps:
        assert shares["nominal_share"]["value"] == pytest.approx(100 * float((maps["outcome"][0, 0] == 0).mean()))
    assert len(found["laws"]["published"]["cases"]) == CASES
    assert not next(case for case in found["cases"] if case["name"] == "firm arm")["arm"]["verified"]


@pytest.mark.slow
def test_other_rule_states_unverified_requirements(run):
    status, out, _ = run(*SMALL, "--rule", "cs-fstd-a")
    assert status == 0
    assert "Not verified" in out


@pytest.mark.slow
def test_existing_envelope_is_not_overwritten(run, tmp_path):
    assert run(*SMALL)[0] == 0
    before = (tmp_path / "forcefeel-envelope" / RESULTS).read_bytes()
    status, _, err = run(*SMALL, "--angle", "5 deg")
    assert status == 2
    assert "--replace" in err
    assert (tmp_path / "forcefeel-envelope" / RESULTS).read_bytes() == before
    assert run(*SMALL, "--angle", "5 deg", "--replace")[0] == 0
    assert json.loads((tmp_path / "forcefeel-envelope" / RESULTS).read_text())["release_angle"][
        "value"
    ] == pytest.approx(5)


def test_interrupted_run_writes_nothing(run, tmp_path, monkeypatch):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(outcomes, "released", interrupted)
    status, _, err = run(*SMALL)
    assert status == 130
    assert "nothing is written" in err
    assert not (tmp_path / "forcefeel-envelope").exists()


@pytest.mark.slow
def test_deviation_option_sets_the_cases(run):
    status, out, _ = run(*SMALL, "--deviation", "column.inertia=2 %", "--deviation", "linkage.damping=none", "--json")
    assert status == 0
    names = [case["name"] for case in json.loads(out)["cases"]]
    assert {"column.inertia -2 %", "column.inertia +2 %"} < set(names)
    assert not any(name.startswith(("column.inertia -20", "linkage.damping")) for name in names)
    assert len(names) == CASES - 2


@pytest.mark.slow
def test_digital_loader_is_compared_under_its_laws(run):
    few = (*("--grid", "stiffness=10, 20 %"), *("--grid", "frequency=2, 4 Hz"), *("--grid", "damping=0.4, 1"))
    words = (
        "elevator-2khz",
        "--law",
        "load-cell",
        "--law",
        "robust",
        *few,
        "--deviation",
        "valve.rated_flow=none",
        "--set",
        "load_cell.noise=0.2 lb",
        "--draws",
        "2",
        "--no-contact",
    )
    status, out, _ = run(*words, "--json")
    assert status == 0
    found = json.loads(out)
    assert list(found["laws"]) == ["load-cell", "robust"]
    assert found["laws"]["robust"]["shares"]["nominal_share"]["value"] == 100
    assert "valve.supply_pressure -20 %" in [case["name"] for case in found["cases"]]
    assert found["laws"]["robust"]["contact"] is None


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--deviation", "column.inertia=1 lb"), "--deviation: column.inertia: expected a number such as '2 %'"),
        (("--deviation", "column.inertia=100 %"), "expected a share above 0 and below 1"),
        (("--deviation", "colum.inertia=2 %"), "did you mean column.inertia?"),
        (("--law", "robust"), "controller.period: expected a sample period, got none"),
        (("--rule", "part61"), "part60-a-2014"),
        (("--law", "best"), "original, published, converged"),
        (("--compare", "--law", "original"), "leave one out"),
        (("--grid", "stiffness"), "--grid: expected"),
        (("--grid", "mass=1..2:3"), "unknown axis"),
        (("--grid", "stiffness=0..100 %:5"), "expected values from"),
        (("--grid", "damping=0.1, 0.2", "--grid", "damping=0.1, 0.3"), "given twice"),
        (("--angle", "10"), "--angle: expected"),
        (("--angle", "-10 deg"), "above 0"),
        (("there-is-none.toml",), "there-is-none.toml"),
    ],
)
def test_invalid_input_exits_2_with_remedy(run, tmp_path, words, message):
    status, out, err = run(*words)
    assert (status, out) == (2, "")
    assert message in err
    assert "Traceback" not in err
    assert not list(tmp_path.iterdir())


def test_file_in_place_of_a_folder_is_refused(run, tmp_path):
    (tmp_path / "taken").write_text("mine")
    status, _, err = run(*SMALL, "--out", "taken")
    assert status == 2
    assert "is a file" in err


@pytest.mark.slow
def test_page_has_rounded_numbers_and_names_unverified_items(run, tmp_path):
    run("--compare", *SMALL)
    page = (tmp_path / "forcefeel-envelope" / PAGE).read_text(encoding="utf-8")
    words = re.sub(r"<(script|style).*?</\1>", "", page, flags=re.DOTALL)
    text = re.sub(r"<[^>]*>", " ", words)
    assert not re.search(r"\d\.\d{7}", text)
    assert "not verified" in text
    assert words.count("<svg") == 2 * 3 * 2  # damping ratios, compensators, nominal and first failing case


def test_custom_law_name_is_escaped_in_the_page(tmp_path):
    grid = {"stiffness": "10, 100 %", "frequency": "1, 2 Hz", "damping": "0.3, 1"}
    found = ff.find_envelope(ff.elevator(), {"<b>mine": None}, grid, changes={}, arms=())
    page = ff.envelope.write_envelope(found, tmp_path, ff.UnitSystem.SI).read_text(encoding="utf-8")
    assert "<b>mine" not in re.sub(r"<script.*?</script>", "", page, flags=re.DOTALL)
