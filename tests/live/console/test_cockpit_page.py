"""The page of a cockpit in a real browser: controls, states, links, a panel for each axis, on a desk and on a phone."""

import json
import re
from dataclasses import replace
from pathlib import Path
from urllib.request import Request, urlopen

import pytest

import forcefeel as ff
from tests.pages import seldom_drawn

STICKS = Path(__file__).parents[3] / "examples" / "cockpit" / "linked-sticks.toml"
WIDTHS = (1280, 390)
FIRST, SECOND = "stick-pitch", "stick-pitch-first-officer"
LONGEST_MS = 40_000

pytestmark = pytest.mark.browser


@pytest.fixture(scope="module")
def cockpit():
    project = ff.loader.read_project(STICKS)
    # Only a whole second of late cycles stops it, on a busy machine too.
    unhurried = project.each(lambda _, loader: loader.replace({"safety.overrun_time": 1.0}, si=True))
    with ff.live.start_cockpit(replace(project, loaders=unhurried), "robust") as running:
        yield running


@pytest.fixture(scope="module")
def console(cockpit):
    with ff.live.Console(cockpit, port=0) as server:
        yield server


@pytest.fixture(scope="module", params=[WIDTHS[0], pytest.param(WIDTHS[1], marks=pytest.mark.slow)])
def page(request, browser, console):
    window = seldom_drawn(browser.new_page(viewport={"width": request.param, "height": 900}))
    window.set_default_timeout(LONGEST_MS)
    window.complaints = []
    window.on(
        "console", lambda said: window.complaints.append(said.text) if said.type in {"error", "warning"} else None
    )
    window.on("pageerror", lambda error: window.complaints.append(str(error)))
    window.goto(console.address)
    for axis in (FIRST, SECOND):
        row(window, axis).locator("td.number").first.filter(has_text="deg").wait_for()  # its panel is connected
    window.click("#on")
    for axis in (FIRST, SECOND):
        state(window, axis, "active")
    yield window
    window.close()


def row(page, axis):
    return page.locator("#axes tbody tr").filter(has=page.locator(f"th:text-is('{axis}')"))


def state(page, axis, name):
    row(page, axis).locator("td").first.filter(has_text=name).wait_for()


def until(page, holds):
    for _ in range(LONGEST_MS // 50):
        if holds():
            return
        page.wait_for_timeout(50)
    pytest.fail("it did not come to that")


def test_drag_in_a_panel_moves_both_linked_controls(page, cockpit):
    grip = page.frame_locator(f"iframe[title='{FIRST}']").locator("#column .grip")
    page.evaluate("window.scrollTo(0, document.querySelector('iframe').getBoundingClientRect().top + window.scrollY)")
    box = grip.bounding_box()
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    page.mouse.down()
    page.mouse.move(box["x"] + box["width"] / 2 + 40, box["y"] + box["height"] / 2)
    angle = cockpit[SECOND].columns.index("column_angle_rad")
    until(page, lambda: abs(cockpit[SECOND].history(most=1)[-1, angle]) > 0.002)
    page.mouse.up()
    until(page, lambda: cockpit[FIRST].hand_force_n == 0)


@pytest.mark.slow
@pytest.mark.parametrize("page", WIDTHS[:1], indirect=True, scope="module")  # its script knows no width
def test_link_is_opened_and_closed(page, cockpit):
    button = page.locator("#links button").first
    button.click()
    page.locator("#controls .shaft.open").wait_for(state="attached")
    assert not any(session.settings.link_holds for session in cockpit.values())
    button.filter(has_text="Connect").click()
    until(page, lambda: all(session.settings.link_holds for session in cockpit.values()))


@pytest.mark.parametrize("page", WIDTHS[:1], indirect=True, scope="module")  # its script knows no width
def test_priority_is_taken_and_given(page, cockpit):
    button = page.locator("#links button", has_text=f"Priority {SECOND}")
    button.click()
    until(page, lambda: cockpit[SECOND].priority)
    page.locator("#links button[aria-pressed=true]").wait_for()
    button.click()
    until(page, lambda: not cockpit[SECOND].priority)


@pytest.mark.parametrize("page", WIDTHS[:1], indirect=True, scope="module")  # its script knows no width
def test_stop_of_the_cockpit_is_shown_cleared_and_followed_by_restart(page):
    page.keyboard.press("Escape")
    for axis in (FIRST, SECOND):
        state(page, axis, "tripped")
        row(page, axis).filter(has_text=re.compile("emergency stop|another axis")).wait_for()
    page.click("#off")
    page.click("#acknowledge")
    for axis in (FIRST, SECOND):
        state(page, axis, "off")
    page.click("#on")
    for axis in (FIRST, SECOND):
        state(page, axis, "active")


def test_page_fits_the_window_and_reports_no_error(page):
    assert page.evaluate("document.documentElement.scrollWidth <= window.innerWidth")
    assert page.complaints == []


def test_paths_are_those_of_the_axes(console):
    token = {"Authorization": f"Bearer {console.admission.control}"}

    def read(path):
        with urlopen(Request(console.address.partition("?")[0] + path, headers=token)) as answer:
            return answer.read()

    assert json.loads(read("axes.json")) == [FIRST, SECOND]
    assert b'id="column"' in read(f"axis/{SECOND}/")
    with pytest.raises(OSError, match="404"):
        read("axis/roll/")
