"""The page in a real browser, over the real loop: drag, change the feel, release, a trip, at the width of a desk and of a phone."""

import pytest

import forcefeel as ff

WIDTHS = (1280, 390)
LONGEST_MS = 40_000
LEAST_PX = 44
"""Of what a finger has to meet."""

pytestmark = pytest.mark.browser


@pytest.fixture(scope="module")
def running():
    with ff.live.start(ff.digital_elevator(), "robust", host=0) as loop:
        yield loop


@pytest.fixture(scope="module")
def console(running):
    with ff.live.Console(running, port=0) as found:
        yield found


@pytest.fixture(scope="module", params=WIDTHS)
def page(request, browser, console):
    window = browser.new_page(viewport={"width": request.param, "height": 900})
    window.set_default_timeout(LONGEST_MS)
    window.complaints, window.requested = [], []
    window.on(
        "console", lambda said: window.complaints.append(said.text) if said.type in {"error", "warning"} else None
    )
    window.on("pageerror", lambda error: window.complaints.append(str(error)))
    window.on("request", lambda asked: window.requested.append(asked.url))
    window.goto(console.address)
    window.click("#on")
    window.locator("#state.active").wait_for()
    yield window
    window.close()


def until(page, holds):
    for _ in range(LONGEST_MS // 50):
        if holds():
            return
        page.wait_for_timeout(50)
    pytest.fail("it did not come to that")


def test_the_hand_drags_the_column(page, running):
    page.evaluate("window.scrollTo(0, 0)")
    grip = page.locator("#column").bounding_box()
    x, y = grip["x"] + grip["width"] / 2, grip["y"] + 40
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 40, y)
    until(page, lambda: running.hand_force_n > 10)
    page.mouse.up()
    until(page, lambda: running.hand_force_n == 0)


def test_the_feel_is_changed(page, running):
    before = running.loader["feel.stiffness"]
    number = page.locator("[id='number-feel.stiffness']")
    number.fill("8000" if before > 950 else "9000")
    number.press("Enter")
    until(page, lambda: running.loader["feel.stiffness"] != before)
    wanted = (8000 if before > 950 else 9000) * 0.112985
    assert running.loader["feel.stiffness"] == pytest.approx(wanted, rel=1e-4)  # the factor's six digits


def test_a_release_is_made_and_judged_and_told_to_who_comes_later(page):
    if page.viewport_size["width"] == WIDTHS[0]:
        page.locator("[data-test=release][data-side=positive]:enabled").click()
    page.locator("#judged:not([hidden])").wait_for()
    assert page.inner_text("#judged strong") == "Release from 50 % of the throw, positive: passed"
    assert page.locator("#judged tbody tr").count() > 5


def test_a_stop_is_seen_cleared_and_left(page):
    page.keyboard.press("Escape")
    page.locator("#state.tripped").wait_for()
    assert "stop" in page.inner_text("#trips").lower()
    page.click("#trips button")
    page.locator("#trips li").wait_for(state="detached")
    page.click("#off")
    page.click("#on")
    page.locator("#state.active").wait_for()


def test_a_fault_is_made_and_repaired(page, running):
    page.locator("#fault").select_option("silent")
    page.click("#break")
    page.locator("#state.tripped").wait_for()
    assert "sensors silent" in page.inner_text("#trips")
    page.click("#repair")
    until(page, lambda: page.get_attribute("#break", "aria-pressed") == "false")
    page.click("#off")
    page.click("#trips button")
    page.locator("#trips li").wait_for(state="detached")
    page.click("#on")
    page.locator("#state.active").wait_for()
    assert running.state.name == "active"


def test_the_simulator_is_told(page):
    page.locator("#simulator:not([hidden])").wait_for()
    assert page.inner_text("#host") == "none yet; share in the feel 0.00"


def test_it_fits_its_window_and_fingers(page):
    assert page.evaluate("document.documentElement.scrollWidth <= window.innerWidth")
    small = page.evaluate(
        """least => [...document.querySelectorAll('button, select, .slider input, .choice label')].filter(one => one.offsetParent)
            .filter(one => one.getBoundingClientRect().height < least - 0.5).map(one => one.outerHTML)""",
        LEAST_PX,
    )
    assert small == []


def test_nothing_is_asked_for_beyond_the_machine_and_nothing_is_complained_of(page, console):
    assert page.complaints == []
    own = console.address.partition("?")[0]
    assert {url for url in page.requested if not url.startswith((own, "data:"))} == set()
    assert "token" not in page.url
