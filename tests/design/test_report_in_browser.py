"""The report in a real browser, at the width of a desk and of a phone."""

import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Page

from forcefeel.design.page.page import write_report
from forcefeel.design.workflow import design_loader
from forcefeel.loader.built_in import elevator
from forcefeel.loader.loader import Loader
from forcefeel.units import UnitSystem
from tests.pages import ROUNDING_PX, WIDTHS, EveryPage, OnDemand, views_of

pytestmark = pytest.mark.browser

PLOTS = 10  # figures 2, 8, 9, 10, 11a, 11b, 14 and three views of the s-plane
SMALLEST_LETTERS_PX = 9


def _soft() -> Loader:
    """A loader that no compensation keeps stable at its setting: every warning of the page is in view."""
    loader = elevator()
    return loader.replace({key: loader[key] / 8 for key in ("feel.inertia", "feel.damping", "feel.stiffness")}, si=True)


REPORTS = {"us": (elevator, UnitSystem.US), "unstable": (_soft, UnitSystem.SI)}


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("reports")

    def write(name: str) -> Path:
        make, units = REPORTS[name]
        return write_report(design_loader(make()), folder / name, units)

    return OnDemand(write)


page = views_of(REPORTS)
TestPage = EveryPage


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


def test_plot_labels_are_not_clipped(page):
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


def test_drawing_labels_do_not_overlap(page):
    words = _boxes(page, ".drawing text")
    assert len(words) > 40
    clashes = [(one["text"], other["text"]) for k, one in enumerate(words) for other in words[:k] if _meet(one, other)]
    assert clashes == []


def test_drawing_contains_its_labels(page):
    left, top, width, height = (float(edge) for edge in page.get_attribute(".drawing svg", "viewBox").split())
    outside = [
        one["text"]
        for one in _boxes(page, ".drawing text")
        if one["left"] < left or one["right"] > left + width or one["top"] < top or one["bottom"] > top + height
    ]
    assert outside == []


def test_drawing_boxes_contain_their_labels(page):
    boxes, words = _boxes(page, "#electronics rect"), _boxes(page, "#electronics text")
    loose = [
        one["text"]
        for one in words
        if not any(box["left"] <= one["left"] and one["right"] <= box["right"] for box in boxes if _meet(one, box))
    ]
    assert len(boxes) == 3
    assert loose == []


def test_drawing_text_is_legible(page):
    """Its letters are large enough on the screen, on a phone by scrolling sideways."""
    smallest = page.evaluate(
        """() => Math.min(...[...document.querySelectorAll('.drawing text')].map(one =>
            parseFloat(getComputedStyle(one).fontSize) * one.getScreenCTM().a))"""
    )
    assert smallest >= SMALLEST_LETTERS_PX


def test_hovering_over_a_curve_shows_its_values(page):
    page.evaluate("document.getElementById('figure-14').scrollIntoView({block: 'center', behavior: 'instant'})")
    box = page.locator("#figure-14 .nsewdrag >> nth=0").bounding_box()
    page.mouse.move(box["x"] + box["width"] / 3, box["y"] + box["height"] / 2)
    page.mouse.move(box["x"] + box["width"] / 3 + 2, box["y"] + box["height"] / 2)
    page.wait_for_selector("#figure-14 .hoverlayer text")
    shown = page.locator("#figure-14 .hoverlayer").text_content()
    assert "compensated" in shown
    assert "°" in shown


# Light, dark, and without its script.

CONTRAST = 4.5
"""Least contrast of text on its ground, WCAG 2.2 AA."""

_COLORS = """() => [
    getComputedStyle(document.body).backgroundColor, getComputedStyle(document.querySelector('main p')).color,
    document.getElementById('figure-14')._fullLayout.plot_bgcolor, document.querySelector('#figure-14 .ytick text').style.fill,
]"""


def _luminance(color: str) -> float:
    """Relative luminance of ``rgb(1, 2, 3)`` or ``#010203``."""
    hexadecimal = [int(color[k : k + 2], 16) for k in (1, 3, 5)] if color.startswith("#") else []
    parts = [part / 255 for part in hexadecimal or map(int, re.findall(r"\d+", color)[:3])]
    linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
    return float(np.dot(linear, (0.2126, 0.7152, 0.0722)))


@pytest.mark.slow
@pytest.mark.parametrize("page", [("us", WIDTHS[0])], indirect=True, scope="module")
def test_text_and_plots_are_legible_in_light_and_dark_mode(page):
    for scheme in ("dark", "light"):  # as the reader's system changes
        page.emulate_media(color_scheme=scheme)
        page.evaluate("() => new Promise(drawn => requestAnimationFrame(() => requestAnimationFrame(drawn)))")
        ground, ink, panel, ticks = map(_luminance, page.evaluate(_COLORS))
        for back, front in ((ground, ink), (panel, ticks)):
            dark, light = sorted((back, front))
            assert (light + 0.05) / (dark + 0.05) >= CONTRAST
            assert (back < front) == (scheme == "dark")


def test_page_without_its_files_names_the_missing_file(browser, pages, tmp_path):
    alone = shutil.copy(pages["us"], tmp_path / "report.html")
    window = browser.new_page()
    window.goto(alone.as_uri())
    missing = window.locator(".plotly-graph-div").all_inner_texts()
    window.close()
    assert len(missing) == PLOTS
    assert all("drawn by plotly.min.js, which did not load" in one for one in missing)
