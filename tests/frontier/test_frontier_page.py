"""The page of a frontier in a browser, at the width of a desk and of a phone."""

from pathlib import Path

import pytest

import forcefeel as ff
from forcefeel.frontier.page.maps import COLORS
from forcefeel.units import UnitSystem
from tests.pages import EveryPage, OnDemand, views_of

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


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("frontiers")

    def write(name: str) -> Path:
        make, units = FRONTIERS[name]
        return ff.frontier.write_frontier(make(), folder / name, units)

    return OnDemand(write)


page = views_of(FRONTIERS, fast=0)
TestPage = EveryPage


def test_maps_are_visible(page):
    widths = page.evaluate(
        "() => [...document.querySelectorAll('.maps svg')].map(one => one.getBoundingClientRect().width)"
    )
    assert widths
    assert min(widths) >= SMALLEST_PANEL_PX


def test_every_map_color_is_in_its_legend(page):
    drawn, listed = page.evaluate(
        """() => [
            [...new Set([...document.querySelectorAll('.maps rect')].map(one => one.getAttribute('fill')))],
            [...document.querySelectorAll('.legend i')].map(one => one.getAttribute('style'))
        ]"""
    )
    assert set(drawn) <= set(COLORS.values())
    assert len(drawn) == len(listed)
    assert all(any(color in style for style in listed) for color in drawn)


def test_bound_and_achieved_share_are_drawn(page):
    names = page.evaluate("() => document.getElementById('shares').data.map(one => one.name)")
    assert names[:3] == [
        "bound on any linear law",
        "inertia and geometry tightened",
        "all tightened in proportion",
    ]


def test_forbidden_and_unverified_items_are_listed(page):
    text = " ".join(page.text_content("main").split())
    assert "The valve excludes no setting" in text
    if "14 CFR" not in text:
        assert "not verified against the document" in text
        assert "half the delay" in text
