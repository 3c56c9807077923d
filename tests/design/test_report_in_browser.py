"""The report in a real browser, at the width of a desk and of a phone."""

import os
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, sync_playwright

from forcefeel.design.page import write_report
from forcefeel.design.workflow import design_loader
from forcefeel.loader.built_in import elevator
from forcefeel.loader.loader import Loader
from forcefeel.units import UnitSystem
from tests.pages import opened

pytestmark = pytest.mark.browser

PLOTS = 10  # figures 2, 8, 9, 10, 11a, 11b, 14 and three views of the s-plane
WIDTHS = (1280, 390)
ROUNDING_PX = 1.0
SMALLEST_LETTERS_PX = 9


def _soft() -> Loader:
    """A loader that no compensation keeps stable at its setting: every warning of the page is in view."""
    loader = elevator()
    return loader.replace({key: loader[key] / 8 for key in ("feel.inertia", "feel.damping", "feel.stiffness")})


REPORTS = {"us": (elevator, UnitSystem.US), "si": (elevator, UnitSystem.SI), "unstable": (_soft, UnitSystem.US)}


VIEWS = {f"{name}-{width}": (name, width) for name in REPORTS for width in WIDTHS}


def _chromium() -> str:
    given = os.environ.get("FORCEFEEL_CHROMIUM")
    found = given or next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    if found:
        return found
    missing = "no Chromium found: install chromium, or set FORCEFEEL_CHROMIUM to its path"
    if os.environ.get("FORCEFEEL_REQUIRE_BROWSER") == "1":
        pytest.fail(missing)
    pytest.skip(missing)


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    path = _chromium()
    with sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=path, args=["--no-sandbox", "--disable-gpu"])
        yield opened
        opened.close()


@pytest.fixture(scope="module")
def reports(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("reports")
    return {name: write_report(design_loader(make()), folder / name, units) for name, (make, units) in REPORTS.items()}


@pytest.fixture(scope="module", params=VIEWS.values(), ids=VIEWS)
def page(request, browser, reports) -> Iterator[Page]:
    name, width = request.param
    with opened(browser, reports[name], width) as window:
        yield window


def test_the_console_is_silent(page):
    assert page.complaints == []


def test_nothing_is_asked_for_but_the_page(page):
    asked = {url for url in page.requested if not url.startswith(("data:", "blob:"))}
    assert asked == {page.url}


def test_every_curve_is_drawn(page):
    drawn = page.evaluate(
        """() => [...document.querySelectorAll('.plotly-graph-div')].map(plot => {
            const room = plot.getBoundingClientRect();
            const seen = path => {
                const box = path.getBoundingClientRect();
                return box.width + box.height > 4 && box.left < room.right && box.right > room.left
                    && box.top < room.bottom && box.bottom > room.top;
            };
            const traces = [...plot.querySelectorAll('.scatterlayer .trace')];
            return {
                name: plot.id,
                asked: plot.data.length,
                drawn: traces.filter(trace => [...trace.querySelectorAll('path')].some(seen)).length,
            };
        })"""
    )
    assert len(drawn) == PLOTS
    # A view of the s-plane need not hold a pole of every configuration.
    missing = [one for one in drawn if one["drawn"] < (1 if one["name"].startswith("poles") else one["asked"])]
    assert missing == []
    assert all(one["drawn"] == one["asked"] for one in drawn if one["name"] == "poles-all")


def test_nothing_is_cut_off(page):
    folded = page.evaluate("document.documentElement.scrollWidth")
    page.evaluate("document.querySelectorAll('details').forEach(one => one.open = true)")
    unfolded = page.evaluate("document.documentElement.scrollWidth")
    page.evaluate("document.querySelectorAll('details').forEach(one => one.open = false)")
    assert max(folded, unfolded) <= page.evaluate("innerWidth")


def test_tables_and_drawing_stay_in_their_boxes(page):
    wide = page.evaluate(
        """() => [...document.querySelectorAll('main *')].filter(one =>
            !one.closest('.box') && !one.closest('.drawing') && !one.closest('.plotly-graph-div') &&
            one.getBoundingClientRect().right > innerWidth + 1).map(one => one.outerHTML.slice(0, 80))"""
    )
    assert wide == []


def test_the_plots_show_their_words_whole(page):
    """Titles, legend and tick labels lie inside their plot; the legend lies above the curves."""
    cut = page.evaluate(
        """(rounding) => [...document.querySelectorAll('.plotly-graph-div')].flatMap(plot => {
            const room = plot.getBoundingClientRect();
            const words = plot.querySelectorAll('.legendtext, .xtitle, .ytitle, .x2title, .y2title, .x3title, .y3title,'
                + '.xtick text, .ytick text, .x2tick text, .y2tick text, .x3tick text, .y3tick text, .annotation-text');
            const outside = [...words].filter(word => {
                const box = word.getBoundingClientRect();
                return box.left < room.left - rounding || box.right > room.right + rounding
                    || box.top < room.top - rounding || box.bottom > room.bottom + rounding;
            }).map(word => plot.id + ': ' + word.textContent);
            const legend = plot.querySelector('.legend .bg').getBoundingClientRect();
            const curves = room.top + plot._fullLayout._size.t;
            return legend.bottom > curves + rounding ? [...outside, plot.id + ': legend over the curves'] : outside;
        })""",
        ROUNDING_PX,
    )
    assert cut == []


def test_tick_labels_do_not_overlap(page):
    clashes = page.evaluate(
        """() => [...document.querySelectorAll('.plotly-graph-div')].flatMap(plot =>
            ['x', 'x2', 'x3', 'y', 'y2', 'y3'].flatMap(axis => {
                const labels = [...plot.querySelectorAll(`.${axis}tick text`)].map(text =>
                    ({text: text.textContent, box: text.getBoundingClientRect()})).filter(one => one.box.width > 0);
                return labels.slice(1).filter((one, k) => {
                    const before = labels[k].box;
                    return one.box.left < before.right && before.left < one.box.right
                        && one.box.top < before.bottom && before.top < one.box.bottom;
                }).map(one => plot.id + ': ' + one.text);
            }))"""
    )
    assert clashes == []


def _boxes(page: Page, selector: str) -> list[dict]:
    return page.evaluate(
        """(selector) => [...document.querySelectorAll(selector)].map(one => {
            const {x, y, width, height} = one.getBBox();
            return {text: one.textContent.trim(), left: x, top: y, right: x + width, bottom: y + height};
        })""",
        selector,
    )


def _meet(one: dict, other: dict) -> bool:
    return (
        one["left"] < other["right"]
        and other["left"] < one["right"]
        and one["top"] < other["bottom"]
        and other["top"] < one["bottom"]
    )


def test_the_words_of_the_drawing_do_not_overlap(page):
    words = _boxes(page, ".drawing text")
    assert len(words) > 40
    clashes = [(one["text"], other["text"]) for k, one in enumerate(words) for other in words[:k] if _meet(one, other)]
    assert clashes == []


def test_the_drawing_holds_its_words(page):
    left, top, width, height = (float(edge) for edge in page.get_attribute(".drawing svg", "viewBox").split())
    outside = [
        one["text"]
        for one in _boxes(page, ".drawing text")
        if one["left"] < left or one["right"] > left + width or one["top"] < top or one["bottom"] > top + height
    ]
    assert outside == []


def test_the_boxes_of_the_drawing_hold_their_words(page):
    boxes, words = _boxes(page, "#electronics rect"), _boxes(page, "#electronics text")
    loose = [
        one["text"]
        for one in words
        if not any(box["left"] <= one["left"] and one["right"] <= box["right"] for box in boxes if _meet(one, box))
    ]
    assert len(boxes) == 3
    assert loose == []


def test_the_drawing_can_be_read(page):
    """Its letters are large enough on the screen, on a phone by scrolling sideways."""
    smallest = page.evaluate(
        """() => Math.min(...[...document.querySelectorAll('.drawing text')].map(one =>
            parseFloat(getComputedStyle(one).fontSize) * one.getScreenCTM().a))"""
    )
    assert smallest >= SMALLEST_LETTERS_PX


def test_pointing_at_a_curve_shows_its_numbers(page):
    page.evaluate("document.getElementById('figure-14').scrollIntoView({block: 'center', behavior: 'instant'})")
    box = page.locator("#figure-14 .nsewdrag >> nth=0").bounding_box()
    page.mouse.move(box["x"] + box["width"] / 3, box["y"] + box["height"] / 2)
    page.mouse.move(box["x"] + box["width"] / 3 + 2, box["y"] + box["height"] / 2)
    page.wait_for_selector("#figure-14 .hoverlayer text")
    shown = page.locator("#figure-14 .hoverlayer").text_content()
    assert "compensated" in shown
    assert "°" in shown
