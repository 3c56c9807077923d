"""A fault of the drive on the page of its axis, by name, in a real browser; the emulated machine waits for the loop."""

import time

import pytest

import forcefeel as ff
from forcefeel.live.console import session as console_session
from tests.live.test_bus import cockpit_on_bus, running, until, yoke
from tests.pages import seldom_drawn

pytestmark = pytest.mark.browser

LONGEST_MS = 40_000


@pytest.fixture(scope="module")
def wired():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(console_session, "HELD_UP_S", LONGEST_MS / 1e3)
        with running(yoke()) as (session, emulator), ff.live.Console(session, port=0) as console:
            yield session, emulator, console


def test_page_names_the_drives_fault_until_it_is_well(browser, wired):
    session, emulator, console = wired
    session.on()
    until(lambda: session.state.name == "active")
    page = seldom_drawn(browser.new_page(viewport={"width": 390, "height": 900}))
    page.set_default_timeout(LONGEST_MS)
    page.goto(console.address)
    page.locator("#state.active").wait_for()
    assert page.locator("#drive").is_hidden()
    emulator.fail(40)
    page.locator("#drive", has_text="Drive: moteus: under voltage; check the supply.").wait_for()
    assert "drive fault" in page.inner_text("#trips")
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    emulator.fail(0)
    until(lambda: _acknowledged(session))
    page.locator("#drive").wait_for(state="hidden")
    page.close()


def _acknowledged(session):
    time.sleep(0.1)  # a loop that is held up has room for 64 requests
    session.off()
    session.acknowledge()
    return not session.state.drive_fault


@pytest.mark.slow
def test_cockpit_names_the_fault_beside_its_axis(browser, tmp_path):
    wired = {axis: yoke(node=node) for node, axis in enumerate(("roll", "pitch"), 2)}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(console_session, "HELD_UP_S", LONGEST_MS / 1e3)
        with cockpit_on_bus(tmp_path, wired) as (cockpit, emulator), ff.live.Console(cockpit, port=0) as console:
            page = seldom_drawn(browser.new_page(viewport={"width": 390, "height": 900}))
            page.set_default_timeout(LONGEST_MS)
            page.goto(console.address)
            emulator.fail(40, axis=1)
            rows = {
                axis: page.locator("#axes tbody tr").filter(has=page.locator(f"th:text-is('{axis}')")) for axis in wired
            }
            rows["pitch"].locator("td", has_text="moteus: under voltage; check the supply").wait_for()
            assert "moteus" not in rows["roll"].inner_text()
            assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
            page.close()
