"""The page of a run, the words above it, and the page in a real browser at the width of a desk and of a phone."""

import json
import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.loader.arms import ARM_ROWS, ARMS, Arm
from forcefeel.page.canvas import drawn
from forcefeel.simulation.findings import input_text
from forcefeel.simulation.inputs import StopToStop
from forcefeel.simulation.limits_met import known_measures
from forcefeel.simulation.page.plots import MOST_POINTS
from forcefeel.simulation.programmed_feel import ideal_angle
from forcefeel.units import UnitSystem, factor
from tests.pages import ROUNDING_PX, EveryPage, OnDemand, views_of, words, words_cut

LB = factor("lb", "N")
ROUNDING = 1e-9  # of the largest value; products of a few hundred matrices
STOPS = {
    "column.coulomb_friction": "3 lb",
    "column.static_friction": "4 lb",
    "column.stop_low": "-12 deg",
    "column.stop_high": "12 deg",
    "valve.orifice": True,
    "amplifier.current_limit": "2 mA",
}
UNSTABLE = {"feel.inertia": "0.6 lb in s^2/rad", "feel.damping": "3.04 lb in s/rad", "feel.stiffness": "96 lb in/rad"}
SECTIONS = ("conclusions", "motion-section", "demand-section", "scenario", "numbers")


def _run(changes=None, force=None, duration_s=2.0, compensated=False, **scenario):
    loader = ff.elevator().replace(changes or {}, si=True)
    force = force or ff.Step(loader["pilot.force"], 0.1)
    law = ff.design_gains(loader).law(loader) if compensated else None
    return ff.simulate(loader, ff.Scenario(force=force, duration_s=duration_s, **scenario), law)


RUNS = {
    "stops": lambda: _run(STOPS),
    "release": lambda: _run({"column.coulomb_friction": "3 lb"}, ff.Release(math.radians(10)), compensated=True),
    "sweep": lambda: _run(STOPS, StopToStop(150 * LB, 20.0), 20.0, compensated=True),
    "chirp": lambda: _run({"feel.hysteresis": "1 lb"}, ff.simulation.Chirp(10 * LB, 0.2, 20.0, 10.0), 10.0),
    "diverged": lambda: _run(UNSTABLE),
}


@pytest.fixture(scope="module")
def pages(tmp_path_factory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("runs")
    return OnDemand(lambda name: ff.simulation.write_simulation(RUNS[name](), folder / name, UnitSystem.US))


@pytest.mark.parametrize("name", RUNS)
def test_the_page_has_every_section_and_loads_nothing(pages, name):
    text = pages[name].read_text(encoding="utf-8")
    sections = [*SECTIONS, *(["loop-section"] if name in {"sweep", "chirp"} else [])]
    assert text.startswith("<!DOCTYPE html>")
    assert set(re.findall(r'<section id="([\w-]+)">', text)) == set(sections)
    beside = {"plotly.min.js", "results.json", "history.csv", "data:,"}
    assert set(words(pages[name]).references) == beside | {f"#{section}" for section in sections}


@pytest.mark.parametrize("name", RUNS)
def test_no_number_on_the_page_has_more_than_six_digits(pages, name):
    numbers = re.findall(r"\d[\d.]*", "\n".join(words(pages[name]).words))
    assert numbers
    assert [text for text in numbers if len(text.replace(".", "").strip("0")) > 6] == []


def test_page_states_result_and_limits_of_run(pages):
    told = {name: " ".join(" ".join(words(pages[name]).words).split()) for name in RUNS}
    assert re.search(r"Settled at 1\.\d+ s, no overshoot to measure: the column met a stop\.", told["stops"])
    assert "at the amplifier’s limit of 2 mA" in told["stops"]
    assert "column.coulomb_friction" in told["stops"]  # an effect in play, by its row
    assert "Diverged at 0.236 s: the column left every bound." in told["diverged"]
    assert "None: the loader is linear." in told["diverged"]
    assert "at the lower end stop" in told["sweep"]


def test_names_are_text_not_markup(tmp_path):
    run = _run(duration_s=0.2)
    run = replace(run, loader=replace(run.loader, name="<script>alert(1)</script>", source="a & b < c"))
    text = ff.simulation.write_simulation(run, tmp_path, UnitSystem.US).read_text(encoding="utf-8")
    assert "<script>alert" not in text
    assert "a &amp; b &lt; c" in text


@pytest.mark.slow
def test_equal_runs_give_equal_bytes(tmp_path):
    first, second = (ff.simulation.write_simulation(_run(STOPS), tmp_path / name, UnitSystem.SI) for name in "ab")
    for name in ("simulation.html", "history.csv", "results.json"):
        assert (first.parent / name).read_bytes() == (second.parent / name).read_bytes()


def test_results_list_the_columns_of_the_history(pages):
    for name in RUNS:
        folder = pages[name].parent
        found = json.loads((folder / "results.json").read_text(encoding="utf-8"))
        head = (folder / "history.csv").read_text(encoding="utf-8").partition("\n")[0]
        assert found["history"] == {"file": "history.csv", "columns": head.split(",")}


# The ideal feel beside a run.


def test_the_ideal_feel_after_a_step_is_the_step_response():
    run = _run(force=ff.Step(100.0, 0.5), duration_s=2.5)
    expected = ff.step_response(ff.linear.ideal_feel(run.loader), 100.0, duration_s=2.0, samples=2001)[
        "column_angle_rad"
    ]
    found = ideal_angle(run)
    assert np.all(found[:501] == 0)
    np.testing.assert_allclose(found[500:], expected.values, atol=ROUNDING * float(np.max(np.abs(expected))))


def test_the_ideal_feel_after_a_release_is_the_free_response():
    """``A e^(-zeta w t) (cos w_d t + zeta / sqrt(1 - zeta^2) sin w_d t)``, with the arm's mass, damper and spring added."""
    arm = {"pilot.arm_mass": 1.0, "pilot.arm_damping": 10.0, "pilot.arm_stiffness": 50.0}
    run = _run(arm, ff.Release(0.2, 0.3))
    arm_squared = run.loader["column.grip_arm"] ** 2
    i, b, g = (
        run.loader[f"feel.{feel}"] + arm_squared * arm[f"pilot.arm_{name}"]
        for feel, name in (("inertia", "mass"), ("damping", "damping"), ("stiffness", "stiffness"))
    )
    w, zeta = math.sqrt(g / i), b / (2 * math.sqrt(g * i))
    t = np.maximum(run.history.time_s.values - 0.3, 0.0)
    root = math.sqrt(1 - zeta**2)
    expected = 0.2 * np.exp(-zeta * w * t) * (np.cos(root * w * t) + zeta / root * np.sin(root * w * t))
    np.testing.assert_allclose(ideal_angle(run), expected, atol=ROUNDING)


def test_ideal_feel_is_omitted_where_undefined():
    trim = ff.simulation.Schedule((0.0,), (0.1,))
    assert ideal_angle(_run(trim_rad=trim)) is None
    assert ideal_angle(_run(feel_changes=(ff.simulation.FeelChange(1.0, {"feel.damping": "200 lb in s/rad"}),))) is None
    assert ideal_angle(_run(force=ff.simulation.Chirp(10.0, 1.0, 2.0, 2.0))) is None


# What limited a run.


def _synthetic(changes, **signals):
    """A run whose history is what it is said to be, 10 samples of 0.1 s."""
    run = _run(changes, ff.simulation.HandsOff(), duration_s=0.9, sample_s=0.1)
    shown = {name: ("time_s", values, {"units": run.outputs.unit(name)}) for name, values in signals.items()}
    return replace(run, outputs=replace(run.outputs, arrays={**run.outputs.arrays, **shown}))


def test_limit_times_count_samples():
    angle = np.radians([0, 6, 11, 12.1, 12.2, 11, 0, -12.5, -11, 0])
    current = np.array([0, 1, 2, 2, 2, 0, -2, 0, 0, 0]) * 1e-3
    velocity = np.array([0, 1, 1, 1, 0, 0, 1, 1, 0, 0])
    found = ff.simulation.limit_times(
        _synthetic(STOPS, column_angle_rad=angle, valve_current_a=current, column_velocity_rad_per_s=velocity)
    )
    assert found.current == pytest.approx(0.4)
    assert (found.over_current, found.over_flow, found.over_pressure) == (0, 0, 0)
    assert found.stop_high_s == pytest.approx(0.2)
    assert found.stop_low_s == pytest.approx(0.1)
    assert found.stuck_s == pytest.approx(0.4)  # not what was before the first motion
    assert found.stuck_at_end


def test_limit_times_include_feel_and_skip_missing_limits():
    stops = {"feel.hard_stop_low": "-5 deg", "feel.hard_stop_high": "5 deg"}
    per_angle = np.prod([ff.elevator()[key] for key in ("potentiometer.gain", "linkage.ratio", "column.base_arm")])
    feel = per_angle * np.radians([0, 4, 5, 5, 4, 0, -5, -4, 0, 0])
    flow = ff.elevator()["valve.rated_flow"] * np.array([0, 0.5, 1.1, 1.2, 1.0, 0, 0, -1.5, 0, 0])
    found = ff.simulation.limit_times(_synthetic(stops, feel_position_v=feel, actuator_flow_m3_per_s=flow))
    assert found.feel_high_s == pytest.approx(0.2)
    assert found.feel_low_s == pytest.approx(0.1)
    assert found.over_flow == pytest.approx(0.3)
    assert found.current == 0
    assert found.stuck_s == 0  # at rest, but without dry friction


def test_limit_times_of_diverged_run_end_at_divergence():
    found = ff.simulation.limit_times(_run(UNSTABLE))
    assert 0 < found.over_current < 1


def test_meaningless_measures_are_omitted():
    diverged = known_measures(_run(UNSTABLE))
    assert diverged.diverged_at_s == pytest.approx(0.236)
    assert math.isnan(diverged.maximum_angle_rad)
    doublet = known_measures(_run(force=ff.simulation.Doublet(50.0, 0.1, 0.3)))
    assert math.isnan(doublet.overshoot)
    assert math.isfinite(doublet.final_angle_rad)
    assert math.isfinite(doublet.settling_time_s)
    assert math.isnan(known_measures(_run(force=ff.simulation.Chirp(10.0, 1.0, 2.0, 2.0))).final_angle_rad)
    step = _run()
    assert known_measures(step).overshoot == step.measures.overshoot


@pytest.mark.parametrize(
    ("run", "said"),
    [
        (lambda: _run(duration_s=0.5), "Still moving after 0.5 s"),
        (lambda: _run(force=ff.simulation.HandsOff()), "The column did not move."),
        (
            lambda: _run(force=ff.simulation.Doublet(50.0, 0.1, 0.3), duration_s=4.0),
            r"between -[\d.]+ and [\d.]+ deg and settled at 1\.\d+ s\.",
        ),
        (lambda: _run(force=ff.simulation.Pulse(50.0, 0.1, 0.3), duration_s=0.5), "was still moving after 0.5 s"),
        (
            lambda: _run(force=ff.simulation.Chirp(10.0, 1.0, 2.0, 2.0)),
            r"The column moved between -[\d.]+ and [\d.]+ deg\.$",
        ),
        (lambda: _run(UNSTABLE), r"Diverged at 0.236 s: the column left every bound\."),
    ],
)
def test_verdicts_match_run_results(run, said):
    assert re.search(said, ff.simulation.run_conclusions(run(), UnitSystem.US).verdict)


def test_findings_match_run_results():
    def told(*given, **named):
        return " ".join(ff.simulation.run_conclusions(_run(*given, **named), UnitSystem.US).findings)

    assert "10.8 deg, 60 % of 18 deg, where the spring G alone balances" in told()
    assert "I, B and G alone give 1.97 Hz damped, 2.01 Hz undamped." in told()
    assert "the springs of G and the arm balance this force" in told({"pilot.arm_stiffness": "0.3 lb/in"})
    firm = dict(zip(ARM_ROWS, ARMS[Arm.FIRM], strict=True))
    assert "The pilot's arm is the firm one, whose numbers are unverified." in told(firm)
    assert "unverified" not in told(dict(zip(ARM_ROWS, ARMS[Arm.LOOSE], strict=True)))
    assert "never reached the amplifier's limit of 10 mA" in told({"amplifier.current_limit": "10 mA"})
    changed = told(force=ff.Step(50 * LB, 0.1), duration_s=2.0, trim_rad=ff.simulation.Schedule((0.0,), (0.01,)))
    assert "It oscillates at" in changed
    assert "alone" not in changed  # G about zero is not what is programmed
    assert "neglect" not in told({"valve.orifice": True})
    assert "The gains are designed on the linear models, which neglect valve.orifice;" in told(
        {"valve.orifice": True}, compensated=True
    )
    sweep = told({"column.stop_high": "20 deg"}, StopToStop(10 * LB, 2.0))
    assert "It reached no stop: the force is too small." in sweep
    assert "Dry friction never held the column once it moved." in told(
        {"column.coulomb_friction": "0.01 lb"}, ff.Step(50 * LB, 0.1), 0.3
    )
    assert "The loader file sets no amplifier.current_limit." in told(UNSTABLE)


@pytest.mark.parametrize(
    ("force", "told"),
    [
        (ff.simulation.HandsOff(), "hands off"),
        (ff.Release(math.radians(10)), "a release from 10 deg"),
        (ff.Release(math.radians(-10), 0.5), "a release from -10 deg at 0.5 s"),
        (ff.Step(20 * LB, 0.1), "a step of 20 lb at 0.1 s"),
        (ff.simulation.Pulse(20 * LB, 0.1, 0.5), "a pulse of 20 lb from 0.1 s on, 0.5 s long"),
        (ff.simulation.Doublet(20 * LB, 0.1, 0.5), "a doublet of ±20 lb from 0.1 s on, 0.5 s each way"),
        (StopToStop(60 * LB, 100.0), "a stop-to-stop sweep to 60 lb either way and back, 100 s long"),
        (ff.simulation.Chirp(10 * LB, 0.2, 20.0, 20.0), "a linear chirp of ±10 lb from 0.2 to 20 Hz, 20 s long"),
        (
            ff.simulation.Multisine(10 * LB, (0.5, 1.0), 2.0),
            "a multisine of ±10 lb, 2 lines from 0.5 to 1 Hz, period 2 s",
        ),
        (ff.Recorded([0, 1], [-3 * LB, 5 * LB], "bench"), "the recording bench, -3 lb to 5 lb"),
    ],
)
def test_inputs_are_described_in_words(force, told):
    assert input_text(force, UnitSystem.US) == told


def test_a_long_curve_keeps_its_peaks():
    values = np.sin(np.arange(100_001) * 0.7)
    values[70_001], values[100_000] = 5.0, -5.0
    kept = drawn(values, MOST_POINTS)
    assert len(kept) <= MOST_POINTS + 2
    assert {0, 70_001, 100_000} <= set(kept.tolist())
    assert np.all(np.diff(kept) > 0)
    assert len(drawn(values[:MOST_POINTS], MOST_POINTS)) == MOST_POINTS


# In a browser.


page = views_of(("stops", "sweep", "diverged"), fast=0)
TestPage = EveryPage


@pytest.mark.browser
def test_every_curve_is_drawn(page):
    plots = page.evaluate(
        """() => [...document.querySelectorAll('.plotly-graph-div')].map(plot =>
            [plot.id, plot.data.length, plot.querySelectorAll('.scatterlayer .trace path.js-line').length])"""
    )
    assert {name for name, _, _ in plots} >= {"motion", "demand"}
    assert [one for one in plots if one[1] != one[2]] == []


@pytest.mark.browser
def test_plot_text_is_not_clipped(page):
    """Titles, legend, ticks and the names of limits lie inside their plot; the legend lies above the curves."""
    selector = ".legendtext, .annotation-text, [class*=title] text, [class*=tick] text"
    assert words_cut(page, selector, ROUNDING_PX) == []
