"""The design of a loader with a digital controller: the best law beside the report's, on the terminal, in JSON and on the page."""

import json
import re
from dataclasses import replace
from functools import partial

import pytest

import forcefeel as ff
from forcefeel.design.law_comparison import EnvelopeSummary, LawComparison, LawResult, QualificationSummary
from tests.command_line import runs
from tests.pages import words

GOOD = QualificationSummary(True, "qualifies", "7 of 7 tests passed", ())
BAD = QualificationSummary(False, "does not qualify", "1 of 7 tests passed, 6 failed", ("Static: too stiff.",))
REPORT = LawResult("published", "the report's", BAD, EnvelopeSummary(0.5, 0.1, 0.05))
BEST = LawResult("robust", "another", GOOD, EnvelopeSummary(1.0, 0.9, 0.5))
GRID = {"stiffness": "30, 60 %", "frequency": "1.5, 2 Hz", "damping": "0.4, 0.8"}
TRIED = LawComparison(
    REPORT, BEST, ("Robust is best.", "No other is."), "The Rule", 18, "", ("my loader.toml", "--set", "a.b=3 lb")
)


@pytest.fixture(scope="module")
def designed():
    return ff.design_loader(ff.digital_elevator())


def _told(designed, tried):
    return ff.design.conclusions(designed, ff.UnitSystem.US, tried)


@pytest.mark.slow
def test_best_law_comes_first(designed):
    told = _told(designed, TRIED)
    assert told.ok
    assert told.verdict == (
        "By The Rule law robust qualifies: 7 of 7 tests passed. The report's law does not qualify: 1 of 7 tests passed, 6 failed."
    )
    assert told.findings[0].endswith("18 settings of stiffness, frequency and damping ratio. Robust is best.")
    assert told.findings[1].startswith("The report's law, published, renders 10 % within tolerance, 5 % in every case")
    assert told.findings[5:] == _told(designed, None).findings


@pytest.mark.parametrize(
    ("changes", "verdict", "good"),
    [
        ({"best": None}, "No law is eligible for this loader. By The Rule the report's law does not qualify", False),
        ({"best": REPORT}, "The report's law is the best for this loader. By The Rule it does not qualify", True),
        (
            {"best": None, "impossible": "no pressure"},
            "The laws cannot be compared on this loader: no pressure.",
            False,
        ),
    ],
)
def test_verdict_matches_the_best_law(designed, changes, verdict, good):
    told = _told(designed, replace(TRIED, **changes))
    assert told.verdict.startswith(verdict)
    assert told.ok is good


def test_printed_commands_can_be_run():
    assert TRIED.commands(BEST)[0] == "forcefeel qualify 'my loader.toml' --set 'a.b=3 lb' --law robust --out tests"
    assert TRIED.commands(REPORT)[1].endswith("--law published --out map-published")


@pytest.mark.slow
def test_analog_loader_finding_states_how_to_try_laws(designed):
    told = ff.design.conclusions(ff.design_loader(ff.elevator()), ff.UnitSystem.US)
    assert any("forcefeel design elevator-2khz" in finding for finding in told.findings)
    assert not any("The loader is analog" in finding for finding in _told(designed, None).findings)


run = runs("design")


@pytest.mark.slow
def test_design_command_finds_the_qualifying_law(run, tmp_path, monkeypatch):
    monkeypatch.setattr(ff.choice, "best_law", partial(ff.choice.best_law, grid=GRID))
    status, out, _ = run("elevator-2khz", "--out", "report", "--json")
    assert status == 0
    laws = json.loads(out)["laws"]
    assert (laws["best"]["name"], laws["best"]["qualified"]["qualifies"]) == ("robust", True)
    assert (laws["report"]["name"], laws["report"]["qualified"]["qualifies"]) == ("published", False)
    assert (
        laws["best"]["rendered"]["worst_case_share"]["value"] > laws["report"]["rendered"]["worst_case_share"]["value"]
    )
    results = json.loads((tmp_path / "report" / "results.json").read_text(encoding="utf-8"))
    assert results["laws"] == laws
    assert results["conclusions"]["verdict"].startswith("By 14 CFR Part 60, Appendix A")
    page = " ".join(" ".join(words(tmp_path / "report" / "report.html").words).split())
    assert "forcefeel qualify elevator-2khz --law robust --out tests" in page
    assert "forcefeel law elevator-2khz --law auto --out laws" in page
    assert re.search(r"robust +the best .* qualifies: 7 of 7 tests passed", page)


def test_the_first_command_of_the_readme_finds_a_law(forcefeel, tmp_path):
    status, out, _ = forcefeel("design", "elevator-2khz", "--out", str(tmp_path / "report"))
    assert status == 0
    assert "law robust qualifies: 7 of 7" in " ".join(out.split())
