"""The page of an envelope in a browser, at the width of a desk and of a phone."""

from pathlib import Path

import pytest

import forcefeel as ff
from forcefeel.envelope.result import COLORS
from forcefeel.units import UnitSystem
from tests.pages import ROUNDING_PX, WIDTHS, EveryPage, OnDemand, views_of

pytestmark = pytest.mark.browser

SMALLEST_PANEL_PX = 60
FOLD_PX, FIRST_FINDINGS = 800, 5
GRID = {"stiffness": "1..100 %:9:log", "frequency": "0.5..4 Hz:6:log"}


def _stepped() -> ff.envelope.Envelope:
    """A loader with optional rows, one compensator, a rule that is not verified."""
    loader = ff.elevator().replace(
        {"valve.orifice": True, "column.coulomb_friction": "1 lb", "feel.coulomb_friction": "1 lb"}
    )
    grid = {"stiffness": "10, 30, 100 %", "frequency": "1..3 Hz:3", "damping": "0.3, 1"}
    return ff.find_envelope(loader, ("published",), grid, changes={"linkage.stiffness": 0.2}, arms=(), rule="cs-fstd-a")


ENVELOPES = {
    "compared": (lambda: ff.find_envelope(ff.elevator(), grid=GRID), UnitSystem.US),
    "stepped": (_stepped, UnitSystem.SI),
}


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("envelopes")

    def write(name: str) -> Path:
        make, units = ENVELOPES[name]
        return ff.envelope.write_envelope(make(), folder / name, units)

    return OnDemand(write)


page = views_of(ENVELOPES)
TestPage = EveryPage


def test_maps_are_visible(page):
    sizes = page.evaluate(
        """() => [...document.querySelectorAll('#maps > .maps svg')].map(one => {
            const {width, height} = one.getBoundingClientRect();
            return [width, height];
        })"""
    )
    assert sizes
    assert min(width for width, _ in sizes) >= SMALLEST_PANEL_PX
    assert min(height for _, height in sizes) >= SMALLEST_PANEL_PX / 2


def test_maps_and_first_findings_are_above_the_fold(page):
    lowest, findings = page.evaluate(
        """() => {
            const box = one => one.getBoundingClientRect().bottom + scrollY;
            return [box(document.querySelector('#maps > .maps')), document.querySelectorAll('#conclusions .findings li').length];
        }"""
    )
    assert 0 < findings <= FIRST_FINDINGS
    if page.viewport_size["width"] >= WIDTHS[0]:
        assert lowest <= FOLD_PX


def test_every_map_color_is_in_its_legend(page):
    drawn, listed = page.evaluate(
        """() => [
            [...new Set([...document.querySelectorAll('.maps rect')].map(one => one.getAttribute('fill')))],
            [...document.querySelectorAll('#maps > .legend i')].map(one => one.getAttribute('style')).filter(Boolean)
        ]"""
    )
    assert set(drawn) <= set(COLORS.values())
    assert all(any(color in style for style in listed) for color in drawn)


def test_loader_setting_is_marked_in_its_panel(page):
    outside = page.evaluate(
        """(rounding) => [...document.querySelectorAll('#maps > .maps .own')].filter(dot => {
            const at = dot.getBoundingClientRect(), room = dot.parentElement.getBoundingClientRect();
            const x = (at.left + at.right) / 2, y = (at.top + at.bottom) / 2;
            return x < room.left - rounding || x > room.right + rounding || y < room.top - rounding || y > room.bottom + rounding;
        }).length""",
        ROUNDING_PX,
    )
    assert outside == 0
    drawn = page.locator("#maps > .maps .own").count()
    assert bool(drawn) == ("the loader's own setting, at" in page.inner_text("#maps"))
    assert drawn == (3 if "14 CFR" in page.inner_text("main") else 0)  # out of the other one's grid


def test_omitted_and_unverified_items_are_listed(page):
    text = page.inner_text("main")
    if "14 CFR" in text:
        assert "Not verified against a source: firm arm" in text
    else:
        assert "not verified against the document" in text
        assert "feel coulomb friction" in text
