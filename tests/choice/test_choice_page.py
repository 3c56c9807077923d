"""The page of a choice among laws in a browser, at the width of a desk and of a phone."""

from pathlib import Path

import pytest

import forcefeel as ff
from forcefeel.choice import choose, score_laws
from forcefeel.choice.page.page import write_choice
from forcefeel.laws.law import names_for
from forcefeel.units import UnitSystem
from tests.pages import ROUNDING_PX, EveryPage, OnDemand, views_of, words_cut

pytestmark = pytest.mark.browser

GRID = {"stiffness": "1, 100 %", "frequency": "2, 4 Hz", "damping": "0.3, 1"}
FEW = {"changes": {"linkage.stiffness": 0.2}, "arms": ()}
PLOTS = {"auto": 3, "analog": 3, "one": 2, "unstable": 1}


def _write(name: str, folder: Path) -> Path:
    if name == "one":
        return write_choice(
            score_laws(ff.digital_elevator(), ("observer",), over_envelope=False), None, folder, UnitSystem.SI
        )
    if name == "unstable":
        loader = ff.elevator()
        soft = loader.replace(
            {key: loader[key] / 100 for key in ("feel.inertia", "feel.damping", "feel.stiffness")}, si=True
        )
        return write_choice(score_laws(soft, ("published",), over_envelope=False), None, folder, UnitSystem.US)
    scored = score_laws(ff.digital_elevator() if name == "auto" else ff.elevator(), grid=GRID, **FEW)
    return write_choice(scored, choose(scored), folder, UnitSystem.US)


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("methods")
    return OnDemand(lambda name: _write(name, folder / name))


page = views_of(PLOTS, fast=0)
TestPage = EveryPage


def test_all_plots_are_present(page):
    assert page.locator(".plotly-graph-div").count() == PLOTS[page.called]


def test_plot_labels_are_not_clipped(page):
    assert (
        words_cut(page, ".xtitle, .ytitle, .legendtext, .annotation-text, .xtick text, .ytick text", ROUNDING_PX) == []
    )


def test_trade_off_labels_do_not_overlap(page):
    over = page.evaluate(
        """() => {
            const boxes = [...document.querySelectorAll('#trade-off .annotation-text')].map(
                one => [one.textContent, one.getBoundingClientRect()]);
            return boxes.flatMap(([name, a], k) => boxes.slice(k + 1)
                .filter(([, b]) => a.left < b.right && b.left < a.right && a.top + 2 < b.bottom && b.top + 2 < a.bottom)
                .map(([other]) => `${name} over ${other}`));
        }"""
    )
    assert over == []


def test_every_law_has_a_point_and_a_bar(page):
    names = {"auto": len(names_for(ff.digital_elevator())), "analog": 3}.get(page.called)
    if names:
        assert page.locator("#trade-off .annotation-text").count() == names
        assert page.locator("#trade-off .point").count() == names
    if page.called == "auto":
        assert page.locator("#margins-and-noise .point").count() >= 6 * (names - 1)  # one may have a bar of no end


def test_verdict_is_marked_bad_for_rejected_laws(page):
    assert page.locator(".verdict.bad").count() == (page.called in {"analog", "unstable"})
