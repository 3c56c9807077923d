"""The page of a flight schedule in a browser, at the width of a desk and of a phone."""

from pathlib import Path

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.flight_schedule import ScheduleAxis, ScheduleCheck, check_schedule, design_schedule, second_order_feel
from forcefeel.flight_schedule.page.page import write_schedule
from forcefeel.units import UnitSystem
from tests.pages import EveryPage, OnDemand, views_of

pytestmark = pytest.mark.browser

PRESSURE = ScheduleAxis("dynamic pressure", "lb/ft^2", (50, 100, 200, 400))


def _line() -> ScheduleCheck:
    loader = ff.digital_elevator()
    stiffness = np.array([0.1, 0.2, 0.4, 0.8]) * loader["feel.maximum_stiffness"]
    schedule = design_schedule(loader, [PRESSURE], second_order_feel(stiffness, [1.0, 1.2, 1.5, 2.0], 0.6))
    return check_schedule(schedule, 4, changes={"linkage.ratio": 0.2})


def _unstable_plane() -> ScheduleCheck:
    """Two axes, a setting beyond critical damping, and an observer that loses a soft feel; a rule that is not verified."""
    loader = ff.digital_elevator()
    stiffness = np.outer([0.02, 0.1, 0.4, 0.8], [1.0, 1.5]) * loader["feel.maximum_stiffness"]
    axes = [PRESSURE, ScheduleAxis("flaps", "deg", (0, 30))]
    schedule = design_schedule(loader, axes, second_order_feel(stiffness, 1.5, [0.4, 1.2]), "observer")
    return check_schedule(schedule, 2, changes={"linkage.ratio": 0.2}, arms=(), rule="cs-fstd-a")


SCHEDULES = {"line": (_line, UnitSystem.US), "unstable": (_unstable_plane, UnitSystem.SI)}


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("schedules")

    def write(name: str) -> Path:
        make, units = SCHEDULES[name]
        return write_schedule(make(), folder / name, units)

    return OnDemand(write)


page = views_of(SCHEDULES, fast=0)
TestPage = EveryPage


def test_every_axis_has_a_panel_with_name_and_unit(page):
    titles = page.evaluate(
        """() => [...document.querySelectorAll('.plotly-graph-div')].map(plot =>
            [...plot.querySelectorAll('.infolayer [class$="title"]')].map(one => one.textContent))"""
    )
    assert len(titles) == 2
    for plot in titles:
        assert "Dynamic pressure, lb/ft²" in plot
        assert ("Flaps, deg" in plot) == ("flaps" in page.inner_text("h1"))


def test_verdict_matches_the_table(page):
    unstable = page.locator("#stability td:nth-child(4)")
    bad = [cell for cell in page.locator("#stability table tbody td.bad").all_inner_texts() if cell]
    verdict = page.inner_text(".verdict")
    assert unstable.count() == 3
    assert bool(bad) == verdict.startswith("Not stable")
    assert ("bad" in (page.get_attribute(".verdict", "class") or "")) == bool(bad)


def test_every_knot_and_midpoint_has_a_row(page):
    plane = "flaps" in page.inner_text("h1")
    assert page.locator("#knots tbody tr").count() == (8 if plane else 4)
    assert page.locator("#releases tbody tr").count() == 3


def test_unverified_items_are_listed(page):
    text = page.inner_text("#conclusions")
    assert ("firm arm" in text) == (not page.inner_text(".verdict").startswith("Not stable"))
    assert "Not verified against a source" in text
