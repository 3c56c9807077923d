"""``forcefeel schedule`` as a user types it, and the folder that it writes."""

import csv
import io
import json
import re

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.flight_schedule import check, read_knots
from forcefeel.flight_schedule.page.page import GAINS, PAGE, RESULTS
from forcefeel.laws.sampled.law_designs import LAW_DESIGNS
from tests.command_line import runs

KNOTS = """dynamic pressure (lb/ft^2),stiffness (lb in/rad),frequency (Hz),damping ratio
50,2880,1.0,0.6
200,11520,1.5,0.6
"""
SOFT = KNOTS.replace("2880", "60")
"""So soft that an observer that trusts its plant loses it."""

CASES = 32


command = runs("schedule")


@pytest.fixture
def run(command, tmp_path):
    """Runs ``forcefeel schedule ...`` beside two files of knots."""
    (tmp_path / "knots.csv").write_text(KNOTS)
    (tmp_path / "soft.csv").write_text(SOFT)
    return command


GOOD = ("elevator-2khz", "--knots", "knots.csv", "--refine", "2")


@pytest.mark.slow
def test_stable_schedule_exits_0(run, tmp_path):
    status, out, err = run(*GOOD, "--out", "found")
    assert (status, err) == (0, "")
    assert "checked loops are stable: at 2 knots, at 1 place between" in out.replace("\n", " ")
    assert {one.name for one in (tmp_path / "found").iterdir()} == {PAGE, RESULTS, GAINS, "plotly.min.js"}


def test_gains_file_contains_every_law_number(run, tmp_path):
    run(*GOOD)
    head, *rows = csv.reader(io.StringIO((tmp_path / "forcefeel-schedule" / GAINS).read_text(encoding="utf-8")))
    found = read_knots(tmp_path / "knots.csv")
    laws = LAW_DESIGNS["robust"].design(ff.digital_elevator(), found.feel)
    n = laws.states
    assert head[:4] == ["dynamic pressure (lb/ft^2)", "I (N m s^2/rad)", "B (N m s/rad)", "G (N m/rad)"]
    assert len(head) == len(set(head)) == 4 + n * n + 4 * n + 2 * (n + 5)
    for k, row in enumerate(rows):
        numbers = dict(zip(head, map(float, row), strict=True))
        np.testing.assert_array_equal([numbers[f"{name}"] for name in head[1:4]], found.feel[k])
        assert numbers["transition[2,1]"] == laws.transition[k, 1, 0]
        assert numbers["input[3,e]"] == laws.input[k, 2, 3]
        assert numbers["command[F_c]"] == laws.command[k, n]
        assert numbers["torque[delta']"] == laws.torque[k, -1]


@pytest.mark.slow
def test_results_match_the_printed_output(run, tmp_path):
    status, out, _ = run(*GOOD, "--json", "--units", "si")
    found = json.loads(out)
    stored = json.loads((tmp_path / "forcefeel-schedule" / RESULTS).read_text(encoding="utf-8"))
    assert status == 0
    assert {key: value for key, value in found.items() if key != "page"} == stored
    assert found["stable"]
    assert found["axes"] == [{"name": "dynamic pressure", "unit": "lb/ft^2", "values": [50.0, 200.0]}]
    assert [part["loops"] for part in found["parts"]] == [2 * CASES, CASES, CASES]
    assert found["knots"][0]["where"] == [50.0]
    assert found["knots"][0]["G"]["unit"] == "N m/rad"
    assert [one["knot"] for one in found["releases"]] == [True, True, False]
    assert len(found["cases"]) == CASES


@pytest.mark.slow
def test_unstable_schedule_exits_1(run, tmp_path):
    status, out, err = run("elevator-2khz", "--knots", "soft.csv", "--law", "observer", "--refine", "2")
    assert (status, err) == (1, "")
    assert "Not stable: " in out
    results = json.loads((tmp_path / "forcefeel-schedule" / RESULTS).read_text(encoding="utf-8"))
    assert not results["stable"]
    assert not results["conclusions"]["ok"]


@pytest.mark.slow
def test_existing_schedule_is_not_overwritten(run, tmp_path):
    run(*GOOD)
    before = (tmp_path / "forcefeel-schedule" / RESULTS).read_bytes()
    status, _, err = run(*GOOD, "--law", "observer")
    assert status == 2
    assert "--replace" in err
    assert (tmp_path / "forcefeel-schedule" / RESULTS).read_bytes() == before
    run(*GOOD, "--law", "observer", "--replace")
    assert json.loads((tmp_path / "forcefeel-schedule" / RESULTS).read_text())["law"] == "observer"


def test_interrupted_run_writes_nothing(run, tmp_path, monkeypatch):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(check, "poles_of", interrupted)
    status, _, err = run(*GOOD)
    assert status == 130
    assert "nothing is written" in err
    assert not (tmp_path / "forcefeel-schedule").exists()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ((), "--knots"),
        (("elevator-2khz", "--knots", "none.csv"), "none.csv: cannot be read"),
        (("elevator-1974", "--knots", "knots.csv"), "controller.period: expected a sample period"),
        ((*GOOD, "--law", "published"), "law: expected"),
        ((*GOOD, "--rule", "part61"), "part60-a-2014"),
        (("elevator-2khz", "--knots", "knots.csv", "--refine", "1"), "refine"),
        (("elevator-2khz", "--knots", "knots.csv", "--refine", "1000000"), "smaller refine"),
        (("elevator-2khz", "--knots", "knots.csv", "--refine", "9" * 20), "refine: expected a whole number from 2 to"),
        (("elevator-2khz", "--knots", "knots.csv", "--threads", str(2**64)), "threads: expected 1 to 1024"),
    ],
)
def test_invalid_input_exits_2_with_remedy(run, tmp_path, words, message):
    status, out, err = run(*words)
    assert (status, out) == (2, "")
    assert message in err
    assert "Traceback" not in err
    assert not (tmp_path / "forcefeel-schedule").exists()


@pytest.mark.slow
def test_page_has_rounded_numbers(run, tmp_path):
    run(*GOOD)
    page = (tmp_path / "forcefeel-schedule" / PAGE).read_text(encoding="utf-8")
    text = re.sub(r"<[^>]*>", " ", re.sub(r"<(script|style).*?</\1>", "", page, flags=re.DOTALL))
    assert not re.search(r"\d\.\d{7}", text)
    assert "dynamic pressure 125 lb" in text
