"""The page of a sweep: what it says, and that a browser draws it at the width of a desk and of a phone."""

import json
import re
from pathlib import Path

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.errors import InputError
from forcefeel.simulation import Scenario
from forcefeel.simulation.inputs import StopToStop
from forcefeel.sweep import Sweep, SweepResult, run_sweep
from forcefeel.sweep.page import maps as sweep_maps
from forcefeel.sweep.page.page import FOLDER, PAGE, RUNS_FOLDER, SUMMARY, write_sweep
from forcefeel.sweep.page.plots import histogram
from forcefeel.sweep.summary import summarize
from forcefeel.units import UnitSystem
from tests.pages import ROUNDING_PX, EveryPage, OnDemand, views_of, words_cut
from tests.parametrization import mostly_slow
from tests.sweeps import PUSH, nonlinear, small

MOST_DIGITS = 7
"""Of a number in a sentence or table; a loader's parameters have six."""

STIFFNESS, INERTIA = "288..28800 lb in/rad:12:log", "2..200 lb in s^2/rad:9:log"


def _unstable() -> SweepResult:
    """Loaders of which some diverge and some cannot be: every remark of the page is in view."""
    loader = ff.elevator().replace({"feel.inertia": "13 lb in s^2/rad"})
    vary = {"feel.inertia": "60 %", "column.coulomb_friction": "0..3 lb", "column.static_friction": "2..4 lb"}
    return run_sweep(Sweep(loader, Scenario(PUSH.force), runs=600, vary=vary))


SWEEPS = {
    "tolerances": (lambda: run_sweep(small(600)), UnitSystem.US),
    "unstable": (_unstable, UnitSystem.SI),
    "map": (
        lambda: run_sweep(
            Sweep(nonlinear(), PUSH, law="original", grids={"feel.stiffness": STIFFNESS, "feel.inertia": INERTIA})
        ),
        UnitSystem.US,
    ),
    "machines": (
        lambda: run_sweep(small(6, grids={"feel.stiffness": STIFFNESS, "linkage.stiffness": "3000..9000 lb/in:7"})),
        UnitSystem.SI,
    ),
    "line": (lambda: run_sweep(small(20, grids={"feel.damping": "50..500 lb in s/rad:12"})), UnitSystem.US),
}


@pytest.fixture(scope="module")
def results() -> dict[str, SweepResult]:
    return OnDemand(lambda name: SWEEPS[name][0]())


@pytest.fixture(scope="module")
def pages(results, tmp_path_factory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("sweeps")
    return OnDemand(lambda name: write_sweep(results[name], summarize(results[name]), folder / name, SWEEPS[name][1]))


def words(page: Path) -> str:
    """What a page says, without plots and scripts."""
    text = re.sub(r"<(script|style).*?</\1>", " ", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    return " ".join(re.sub(r"<[^>]+>", " ", text).split())


@pytest.mark.slow
def test_the_page_has_a_headline_tables_and_plots(pages):
    text = pages["tolerances"].read_text(encoding="utf-8")
    said = words(pages["tolerances"])
    assert "Monte Carlo over tolerances" in said
    assert "of 600 loaders settle" in said or "All 600 loaders settle" in said
    for plot in ("responses", "spread-overshoot", "spread-final_angle_rad", "influence-overshoot", "slices-overshoot"):
        assert f'id="{plot}"' in text
    for table in (
        "Settled",
        "linkage stiffness",
        "uniform, ±20 %",
        "loader file",
        "Quantiles",
        "All rank correlations",
    ):
        assert table in said


@pytest.mark.parametrize("name", mostly_slow(SWEEPS))
def test_numbers_have_limited_digits(pages, name):
    numbers = re.findall(r"\d[\d.]*\d", words(pages[name]))
    assert [one for one in numbers if len(one.replace(".", "").lstrip("0")) > MOST_DIGITS] == []


@pytest.mark.slow
def test_page_states_diverged_and_impossible_runs(pages, results):
    said = words(pages["unstable"])
    status = results["unstable"].runs["status"].values
    assert {"diverged", "impossible"} <= set(status)
    assert f"{(status == 'impossible').sum()} loaders are impossible and were not run" in said
    assert 'class="verdict bad"' in pages["unstable"].read_text(encoding="utf-8")
    assert "values contradict each other; not run" in said
    assert "this sweep" in said


def test_a_grid_has_maps_and_the_boundary_of_stability(pages):
    text = pages["map"].read_text(encoding="utf-8")
    for plot in ("map-status", "map-stability", "map-overshoot"):
        assert f'id="{plot}"' in text
    assert "linear boundary of stability" in text
    assert "smallest with" in words(pages["map"])
    assert "6 machines, of which the maps show the median" in words(pages["machines"])


def test_summary_json_agrees_with_page(pages):
    found = json.loads((pages["unstable"].parent / "summary.json").read_text(encoding="utf-8"))
    assert sum(one["runs"] for one in found["statuses"]) == 600
    assert found["varied"]["column.static_friction"]["high"] == {"value": pytest.approx(17.792886), "unit": "N"}
    assert found["conclusions"]["ok"] is False
    grid = json.loads((pages["map"].parent / "summary.json").read_text(encoding="utf-8"))
    assert grid["grid"]["feel.stiffness"]["unit"] == "lb in/rad"
    assert grid["grid"]["feel.stiffness"]["values"][-1] == pytest.approx(28800)


def test_band_has_a_table(pages, results):
    rows = np.genfromtxt(pages["tolerances"].parent / "envelope.csv", delimiter=",", names=True)
    assert len(rows) == 501
    assert rows["median_deg"][-1] == pytest.approx(
        np.degrees(float(results["tolerances"].envelope["column_angle_rad"].sel(edge="median")[-1])),
        rel=1e-8,  # written with nine digits
    )


def test_a_histogram_holds_every_run(results):
    result = results["tolerances"]
    spread = summarize(result).spreads["overshoot"]
    drawn, beyond = histogram(result.runs["overshoot"].values, spread, "Overshoot", UnitSystem.US, "#D55E00")
    shown = sum(float(np.sum(bar.y)) for bar in drawn.data if bar.type == "bar")
    assert shown + 100 * beyond / 600 == pytest.approx(100)


@pytest.mark.parametrize(
    ("values", "expected"),
    [([1.0, 10.0, 100.0], True), ([1.0, 2.0, 3.0], False), ([0.0, 1.0, 10.0], False), ([1.0, 2.0], False)],
)
def test_even_steps_in_proportion_have_a_logarithmic_axis(values, expected):
    sweep = Sweep(nonlinear(), PUSH, law="original", grids={"feel.damping": values})
    assert sweep_maps.logarithmic(SweepResult(sweep, None), "feel.damping") is expected


def test_input_without_end_has_its_own_measures(tmp_path):
    scenario = Scenario(StopToStop(200.0, 1.0), duration_s=1.0)
    result = run_sweep(Sweep(nonlinear(), scenario, law="original", runs=40))
    page = write_sweep(result, summarize(result), tmp_path, UnitSystem.SI)
    assert "40 loaders stay within bounds; largest column angle" in words(page)
    assert "overshoot" not in words(page).lower()


@pytest.mark.parametrize("name", [PAGE, SUMMARY, "plan.json", "runs.nc"])
def test_folder_in_place_of_file_is_refused(tmp_path, name):
    (tmp_path / name).mkdir()
    whose = FOLDER if name in FOLDER.files else RUNS_FOLDER
    with pytest.raises(InputError, match="is a folder; expected to write a file of that name"):
        whose.check(tmp_path)


# In a browser.


page = views_of(SWEEPS, fast=0)
TestPage = EveryPage


@pytest.mark.browser
def test_every_plot_shows_something(page):
    empty = page.evaluate(
        """() => [...document.querySelectorAll('.plotly-graph-div')].filter(plot => {
            const room = plot.getBoundingClientRect();
            const seen = [...plot.querySelectorAll('.trace path, .hm image')].filter(one => {
                const box = one.getBoundingClientRect();
                return box.width + box.height > 4 && box.left < room.right && box.right > room.left;
            });
            return seen.length === 0;
        }).map(plot => plot.id)"""
    )
    assert empty == []


@pytest.mark.browser
def test_plot_text_is_not_clipped(page):
    """Titles, legend and ticks lie inside their plot; the legend lies above the curves."""
    selector = ".legendtext, [class*=title] text, [class*=tick] text, .cbaxis text"
    assert words_cut(page, selector, ROUNDING_PX) == []


@pytest.mark.browser
def test_the_plots_are_wide_enough_to_read(page):
    """Labels beside a plot leave it at least 40 % of its width."""
    narrow = page.evaluate(
        """() => [...document.querySelectorAll('.plotly-graph-div')].filter(plot =>
            plot._fullLayout._size.w < 0.4 * plot.getBoundingClientRect().width).map(plot => plot.id)"""
    )
    assert narrow == []
