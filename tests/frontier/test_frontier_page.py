"""The page of a frontier in a browser, at the width of a desk and of a phone."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Page

import forcefeel as ff
from forcefeel.frontier.page.maps import COLORS
from forcefeel.units import UnitSystem
from tests.design.test_report_in_browser import (  # noqa: F401  the same demands on another page
    WIDTHS,
    browser,
    test_nothing_is_asked_for_but_the_page,
    test_nothing_is_cut_off,
    test_tables_and_drawing_stay_in_their_boxes,
    test_the_console_is_silent,
    test_tick_labels_do_not_overlap,
)
from tests.pages import opened

pytestmark = pytest.mark.browser

SMALLEST_PANEL_PX = 100


def _digital() -> ff.frontier.Frontier:
    """A digital loader whose spool is too small for some settings, few cases, a rule that is not verified."""
    loader = ff.digital_elevator().replace({"valve.flow_limit": "25 in^3/s", "column.coulomb_friction": "1 lb"})
    grid = {"stiffness": "10, 100 %", "frequency": "2, 4 Hz", "damping": "0.4, 1"}
    return ff.find_frontier(
        loader, "robust", grid, changes={"column.inertia": 0.2}, arms=(), rule="cs-fstd-a", threads=1
    )


def _analog() -> ff.frontier.Frontier:
    grid = {"stiffness": "1..100 %:6:log", "frequency": "1..4 Hz:3:log", "damping": "0.4, 1.5"}
    changes = {"column.inertia": 0.2, "linkage.ratio": 0.2, "linkage.stiffness": 0.2, "valve.current_gain": 0.3}
    return ff.find_frontier(ff.elevator(), grid=grid, changes=changes)


FRONTIERS = {"analog": (_analog, UnitSystem.US), "digital": (_digital, UnitSystem.SI)}
VIEWS = {f"{name}-{width}": (name, width) for name in FRONTIERS for width in WIDTHS}


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("frontiers")
    return {name: ff.frontier.write_frontier(make(), folder / name, units) for name, (make, units) in FRONTIERS.items()}


@pytest.fixture(scope="module", params=VIEWS.values(), ids=VIEWS)
def page(request, browser, pages) -> Iterator[Page]:  # noqa: F811  the browser's fixture
    name, width = request.param
    with opened(browser, pages[name], width) as window:
        yield window


def test_the_maps_can_be_seen(page):
    widths = page.evaluate(
        "() => [...document.querySelectorAll('.maps svg')].map(one => one.getBoundingClientRect().width)"
    )
    assert widths
    assert min(widths) >= SMALLEST_PANEL_PX


def test_every_colour_of_a_map_is_in_its_legend(page):
    drawn, listed = page.evaluate(
        """() => [
            [...new Set([...document.querySelectorAll('.maps rect')].map(one => one.getAttribute('fill')))],
            [...document.querySelectorAll('.legend i')].map(one => one.getAttribute('style'))
        ]"""
    )
    assert set(drawn) <= set(COLORS.values())
    assert len(drawn) == len(listed)
    assert all(any(color in style for style in listed) for color in drawn)


def test_bound_and_achieved_are_drawn(page):
    names = page.evaluate("() => document.getElementById('shares').data.map(one => one.name)")
    assert names[:3] == [
        "bound on any linear law",
        "achieved, inertia and geometry tightened",
        "achieved, all in proportion",
    ]


def test_what_is_forbidden_or_not_verified_is_said(page):
    text = page.inner_text("main")
    if "14 CFR" in text:
        assert "The valve forbids none" in text
    else:
        assert "The valve's flow forbids" in text.replace("\N{RIGHT SINGLE QUOTATION MARK}", "'")
        assert "not verified against the document" in text
        assert "half the delay" in text
