"""The page of an identification in a browser, at the width of a desk and of a phone."""

import dataclasses
from pathlib import Path

import pytest

from forcefeel.bench.identification.as_json import FitSettings
from forcefeel.bench.identification.page.page import write_identification
from forcefeel.bench.identification.result import Identification
from forcefeel.units import UnitSystem
from tests.identifications import determined, record_fitted, response_fitted, secrets_in, undetermined
from tests.pages import ROUNDING_PX, EveryPage, OnDemand, views_of, words_cut

pytestmark = pytest.mark.browser

WORDS = (
    ".legendtext, .xtitle, .ytitle, .x2title, .y2title, .x3title, .y3title, .xtick text, .ytick text, .annotation-text"
)
"""What a plot says beside its curves."""


def _records_alone() -> Identification:
    found = determined()
    return dataclasses.replace(found, fitted=record_fitted(), rigid=None)


CASES = {
    "determined": (determined, UnitSystem.US),
    "undetermined": (undetermined, UnitSystem.SI),
    "records": (_records_alone, UnitSystem.SI),
}


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("identifications")
    estimated = [response_fitted("closed test_signal to column_angle").data]

    def write(name: str) -> Path:
        make, units = CASES[name]
        return write_identification(make(), folder / name, units, FitSettings(), estimated=estimated)

    return OnDemand(write)


page = views_of(CASES, fast=0)
TestPage = EveryPage


def test_plot_labels_are_not_clipped(page):
    assert words_cut(page, WORDS, ROUNDING_PX) == []


def test_each_data_set_has_a_plot_and_a_row(page):
    names = page.evaluate("() => [...document.querySelectorAll('.plotly-graph-div')].map(plot => plot.id)")
    expected = {
        "determined": ["estimates-plot", "response-0", "record-0", "record-1"],
        "undetermined": ["estimates-plot", "response-0"],
        "records": ["estimates-plot", "record-0", "record-1"],
    }
    assert names == expected[page.called]
    assert page.locator("#data tbody tr").count() == len(names) - 1


def test_measured_initial_and_fitted_curves_are_drawn(page):
    drawn = page.evaluate(
        """() => [...document.querySelectorAll('.plotly-graph-div')].slice(1).map(plot => {
            const seen = path => path.getBoundingClientRect().width + path.getBoundingClientRect().height > 4;
            const traces = [...plot.querySelectorAll('.scatterlayer .trace')];
            return {
                names: [...new Set(plot.data.map(one => one.name))],
                missing: plot.data.length - traces.filter(one => [...one.querySelectorAll('path')].some(seen)).length,
            };
        })"""
    )
    for plot in drawn:
        assert plot["missing"] == 0
        assert {"the file's model", "fitted"} <= set(plot["names"])
        assert any(name.startswith("measured") for name in plot["names"])


def test_response_has_its_panels(page):
    plot = page.locator("#response-0")
    if page.called == "records":
        assert plot.count() == 0
        return
    titles = plot.locator("text[class$='title']").all_text_contents()
    assert [title for title in titles if title.startswith(("Gain", "Phase", "Residual"))] == [
        "Gain, dB re 1 deg/V",
        "Phase, deg",
        "Residual, %",
    ]
    assert ("Coherence" in titles) == (page.called == "determined")
    assert "95 % of the noise" in plot.locator(".legendtext").all_text_contents()


def test_page_uses_the_selected_units(page):
    text = page.inner_text("#estimates")
    assert ("lb/in" in text) == (page.called == "determined")
    assert ("N/cm" in text) == (page.called != "determined")


def test_page_shows_verdict_and_next_steps(page):
    lost = page.called == "undetermined"
    assert page.inner_text(".verdict").startswith(
        "2 of 3 parameters are not determined" if lost else "All 5 parameters are determined"
    )
    assert ("bad" in (page.get_attribute(".verdict", "class") or "")) == lost
    assert page.locator("a[href='loader.toml']").count() == (0 if lost else 2)
    assert page.locator("#apart").count() == (1 if lost else 0)
    assert ("loader file" in page.inner_text("#how summary")) == lost


def test_undetermined_parameter_has_no_value(page):
    cells = page.locator("#estimates tbody td:nth-child(4)").all_inner_texts()
    assert cells.count("not determined") == (2 if page.called == "undetermined" else 0)
    if page.called == "undetermined":
        annotations = page.locator("#estimates-plot .annotation-text").all_text_contents()
        assert annotations == ["not determined", "not determined"]
        assert secrets_in(page.inner_text("body")) == []


def test_correlation_table_is_square(page):
    count = 3 if page.called == "undetermined" else 5
    assert page.locator("#correlation tbody tr").count() == count
    assert page.locator("#correlation tbody td").count() == count * count
    assert page.locator("#correlation tbody tr:first-child td:nth-child(2)").inner_text() == "1"


def test_rigid_link_table_is_shown_where_tested(page):
    assert page.locator("#rigid").count() == (1 if page.called == "determined" else 0)
    if page.called == "determined":
        assert "34 %" in page.inner_text("#rigid")


def test_every_link_target_exists(page, pages):
    targets = [one.get_attribute("href") for one in page.locator("a").all()]
    folder = pages[page.called].parent
    for target in targets:
        if target.startswith("#"):
            assert page.locator(target).count() == 1
        else:
            assert (folder / target).is_file()
    assert (folder / "loader.toml").is_file() == (page.called != "undetermined")
