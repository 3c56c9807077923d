"""The design of an electric loader: what is found without a law and under one, in words, on the page, as tables of values."""

import csv
import json
import re
from dataclasses import replace

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.design.law_comparison import EnvelopeSummary, LawComparison, LawResult, QualificationSummary
from forcefeel.design.law_loop import law_step
from forcefeel.design.motor_findings import NO_REPORT, delay_s
from forcefeel.design.page.plots import draw
from forcefeel.errors import InputError
from forcefeel.laws.analog.recursion import DesignSettings
from forcefeel.linear.electric_modes import AS_ONE, ON_THE_LINK
from forcefeel.linear.frequency import Margins
from forcefeel.loader.parameters import HYDRAULIC, parts
from forcefeel.simulation import Scenario, simulate
from forcefeel.simulation.inputs import Schedule
from tests.pages import words

EXACT = 1e-9  # of the deflection; a sampled loop beside the engine's run of it
TOLD = 5e-4  # half the last digit of three
GOOD = QualificationSummary(True, "qualifies", "7 of 7 tests passed", ())
BEST = LawResult("robust", "a law", GOOD, EnvelopeSummary(1.0, 0.9, 0.5))
TRIED = LawComparison(None, BEST, ("Robust is best.", "No other is."), "The Rule", 18, "", ("my loader.toml",))
OF_A_VALVE = re.compile(r"\b(valve|piston|oil|amplifier|hydraulic)", re.IGNORECASE)
KEYS = ("step", "hand", "command-to-force", "command-to-position", "loop")


@pytest.fixture(scope="module")
def designed():
    return ff.design_loader(ff.loader.electric("desktop-yoke"))


@pytest.fixture(scope="module")
def out(designed, tmp_path_factory):
    return ff.design.write_report(designed, tmp_path_factory.mktemp("motor"), ff.UnitSystem.SI, TRIED).parent


def test_law_renders_the_feel_that_the_current_loop_cannot(designed):
    alone, law = designed.configuration("compliant").programmed.assessment, designed.programmed.assessment
    row = designed.loader.__getitem__
    gear = (row("linkage.ratio") * row("column.base_arm") / row("transmission.travel")) ** 2
    both = row("column.inertia") + row("motor.inertia") * gear
    assert designed.felt_inertia_n_m_s2_per_rad == pytest.approx(both)
    assert alone.frequency_rad_per_s == pytest.approx(np.sqrt(row("feel.stiffness") / both), rel=0.01)  # the link gives
    link = row("linkage.stiffness") * (row("linkage.ratio") * row("column.base_arm")) ** 2
    assert alone.static_error == pytest.approx(row("feel.stiffness") / link)
    assert law.frequency_rad_per_s == pytest.approx(designed.feel_frequency_rad_per_s, rel=EXACT)
    assert law.static_error == pytest.approx(0, abs=EXACT)
    assert law.tracking_error < alone.tracking_error / 10
    names = [mode.name for mode in designed.configuration("compliant").programmed.modes]
    assert (names[0], names[1]) == (AS_ONE, ON_THE_LINK)


def test_step_response_under_the_law_matches_the_engine(designed):
    loader = designed.loader
    loader = loader.replace({key: None for key in loader.given if key.endswith((".noise", ".resolution"))})
    loader = loader.replace({"pilot.force": 0.1 * loader["pilot.force"]}, si=True)  # within the motor's limits
    step, force = law_step(loader, "robust", 0.5), loader["pilot.force"]
    scenario = Scenario(Schedule((0.0, 1.0), (force, force)), 0.5, 1e-4, loader["controller.period"])
    angle = simulate(loader, scenario, "robust").history.column_angle_rad.values
    assert np.abs(angle - step.column_angle_rad).max() < EXACT * angle.max()


def test_overdamped_feel_is_the_slow_pole_pair():
    """The pedals are programmed to swing and creep by current alone: the mode on the link is none of their feel."""
    found = ff.analyze(ff.loader.electric("rudder-pedals")).configuration("compliant").programmed
    slow, fast = (mode for mode in found.modes if mode.name == AS_ONE)
    assert found.assessment.frequency_rad_per_s == pytest.approx(np.sqrt(slow.real_per_s * fast.real_per_s))
    assert found.assessment.damping_ratio > 1


def test_delay_is_given_at_the_crossover():
    assert delay_s(Margins(2.0, 0.5, 9.0, 10.0)) == pytest.approx(0.05)
    assert delay_s(Margins(2.0, np.inf, 9.0, np.nan)) == np.inf
    assert delay_s(Margins(0.5, -0.5, 9.0, 10.0)) == 0


def test_conclusions_start_with_the_evaluated_law(designed):
    told = ff.design.conclusions(designed, ff.UnitSystem.SI, TRIED)
    assert told.ok
    assert told.verdict == "By The Rule law robust qualifies: 7 of 7 tests passed."
    assert told.findings[0].endswith("Robust is best.")
    assert NO_REPORT in told.findings
    alone = ff.design.conclusions(designed, ff.UnitSystem.SI)
    assert (
        alone.verdict == "Under law robust the loader is stable and renders the programmed feel, at rest and in motion."
    )
    none = ff.design.conclusions(designed, ff.UnitSystem.SI, replace(TRIED, best=None))
    assert (none.ok, none.verdict) == (False, "No law is eligible for this loader.")


def test_motor_page_does_not_mention_a_valve(out):
    page = (out / "report.html").read_text(encoding="utf-8")
    said = " ".join(words(out / "report.html").words).replace("\N{RIGHT SINGLE QUOTATION MARK}", "'")
    assert NO_REPORT in said
    said = said.replace(NO_REPORT, "")
    assert OF_A_VALVE.findall(said) == []
    assert "forcefeel envelope 'my loader.toml' --law robust --out map" in said
    drawing = page[page.index('<svg viewBox="0 0 1200 580"') :]
    labels = drawing[: drawing.index("</svg>")]
    for name in (
        "Current loop",
        "Controller",
        "Motor",
        "Transmission",
        "Position sensor",
        "Load cell",
        "Link",
        "Column",
    ):
        assert f">{name}<" in labels
    assert not {part for part in set(parts(HYDRAULIC)) - set(parts("electric")) if f'id="{part}"' in labels}


@pytest.mark.slow
def test_every_curve_is_saved(designed, out):
    for figure in ff.design.figures(designed):
        with (out / "responses" / f"{figure.key}.csv").open(encoding="utf-8") as file:
            head, *rows = csv.reader(file)
        assert len(rows) > 1000
        assert all(any(name.startswith(f"{label}: ") for name in head) for label in figure.curves)
        assert draw(figure, designed, ff.UnitSystem.SI).data
    assert tuple(figure.key for figure in ff.design.figures(designed)) == KEYS
    kept = json.loads((out / "results.json").read_text(encoding="utf-8"))
    assert kept["laws"]["report"] is None
    assert kept["design"]["law"] == "robust"
    shown = kept["design"]["modes"][0]
    assert (shown["name"], shown["frequency"]) == ("current loop", {"value": pytest.approx(500), "unit": "Hz"})


def test_motor_force_is_fully_transmitted_at_0_db(designed):
    figures = {figure.key: figure.curves for figure in ff.design.figures(designed)}
    force, hand = figures["command-to-force"], figures["hand"]
    assert float(force["column held"]["gain_db"][0]) == pytest.approx(0, abs=TOLD)
    share = designed.column_inertia_n_m_s2_per_rad / designed.felt_inertia_n_m_s2_per_rad
    assert float(force["rigid link"]["gain_db"][0]) == pytest.approx(20 * np.log10(share), abs=TOLD)
    assert float(hand["under robust"]["gain_db"][0]) == pytest.approx(float(hand["ideal feel"]["gain_db"][0]), abs=TOLD)


@pytest.mark.slow
def test_best_law_of_a_motor_needs_no_law_of_the_report():
    begun = []
    grid = {"stiffness": "30, 60 %", "frequency": "1.5, 2 Hz", "damping": "0.4, 0.8"}
    tried = ff.choice.best_law(ff.loader.electric("desktop-yoke"), grid, progress=begun.append)
    assert (tried.report, tried.best.qualifies) == (None, True)
    assert begun == ["laws at the own setting", "laws over the envelope", "laws tested"]
    assert tried.laws == (tried.best,)


def test_recursion_22_is_refused():
    with pytest.raises(InputError, match="a motor takes a sampled law"):
        ff.design_loader(ff.loader.electric("desktop-yoke"), DesignSettings())
