"""The page in a real browser, over the real loop: drag, change the feel, release, a trip, at the width of a desk and of a phone."""

import pytest

import forcefeel as ff
from forcefeel.live.console import session
from tests.live.unhurried import unhurried_elevator
from tests.pages import seldom_drawn

WIDTHS = (1280, 390)
LONGEST_MS = 200_000
"""Of a wait: a release takes 12 s of cycles, and a busy machine misses most of them."""
LEAST_PX = 44
"""Of what a finger has to meet."""

PAD = """
window.axes = null;
window.looks = 0;
navigator.getGamepads = () => (window.looks++, window.axes ? [null, { axes: window.axes }] : [null]);
"""
"""A game pad of a test: its axes, or none, and how often the page looked at it."""

SOCKETS = """
window.sockets = [];
const Real = WebSocket;
window.WebSocket = class extends Real { constructor(...to) { super(...to); window.sockets.push(this); } };
"""
"""The page's connections, for a test to cut."""

pytestmark = [pytest.mark.browser, pytest.mark.usefixtures("coarse_range")]


@pytest.fixture(scope="module")
def running():
    with ff.live.start(unhurried_elevator(), "robust", host=0) as loop:
        yield loop


@pytest.fixture(scope="module")
def console(running):
    """A server that a busy machine does not hold up: what it then leaves out is tried in ``test_console_apart``."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(session, "HELD_UP_S", LONGEST_MS / 1e3)
        with ff.live.Console(running, port=0) as found:
            yield found


@pytest.fixture(scope="module", params=[WIDTHS[0], pytest.param(WIDTHS[1], marks=pytest.mark.slow)])
def page(request, browser, console):
    window = seldom_drawn(browser.new_page(viewport={"width": request.param, "height": 900}))
    window.set_default_timeout(LONGEST_MS)
    window.complaints, window.requested = [], []
    window.on(
        "console", lambda said: window.complaints.append(said.text) if said.type in {"error", "warning"} else None
    )
    window.on("pageerror", lambda error: window.complaints.append(str(error)))
    window.on("request", lambda asked: window.requested.append(asked.url))
    window.add_init_script(PAD)
    window.add_init_script(SOCKETS)
    window.goto(console.address)
    window.click("#on")
    window.locator("#state.active, #state.tripped").wait_for()
    assert window.inner_text("#state") == "active", window.inner_text("#trips")
    yield window
    window.close()


@pytest.fixture(scope="module")
def pages_before():
    """Pages whose release was judged."""
    return []


def until(page, holds):
    for _ in range(LONGEST_MS // 50):
        if holds():
            return
        page.wait_for_timeout(50)
    pytest.fail("it did not come to that")


def grip(page):
    page.evaluate("window.scrollTo(0, 0)")
    box = page.locator("#column").bounding_box()
    return box["x"] + box["width"] / 2, box["y"] + 40


def test_hand_drag_moves_the_column(page, running):
    x, y = grip(page)
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 40, y)
    until(page, lambda: running.hand_force_n > 10)
    page.mouse.up()
    until(page, lambda: running.hand_force_n == 0)


def push(page, axis):
    """As a hand does, that stays for longer than the page takes to look."""
    page.evaluate("axis => { window.axes = axis; window.looks = 0; }", axis)
    until(page, lambda: page.evaluate("window.looks") > 1)


@pytest.mark.slow
@pytest.mark.parametrize("page", WIDTHS[:1], indirect=True, scope="module")  # its script knows no width
def test_game_pad_pulls_after_centering_and_only_with_control(page, running):
    """No push is as strong as the grip's limit: a slow browser may hold it for longer than the 5 s that the limit allows."""
    push(page, [0.0, -0.8])
    page.wait_for_timeout(200)
    assert running.hand_force_n == 0  # it was pushed when it came
    push(page, [0.02, 0.05])
    page.locator("#pad", has_text="a game pad pulls too").wait_for()
    push(page, [0.1, -0.2])  # the axis that is pushed further
    until(page, lambda: running.hand_force_n < -10)
    half = running.hand_force_n
    push(page, [0.1, 0.4])
    until(page, lambda: running.hand_force_n == pytest.approx(-2 * half, rel=1e-6))  # of doubles as JSON
    push(page, [0.0, 0.0])
    until(page, lambda: running.hand_force_n == 0)
    push(page, [0.4, 0.0])
    until(page, lambda: running.hand_force_n > 10)
    page.click("#take")
    page.locator("#holder", has_text="No client").wait_for()
    page.wait_for_timeout(300)
    assert running.hand_force_n == 0
    assert page.inner_text("#holder") == "No client has control."
    page.click("#take")
    page.locator("#holder", has_text="You have control.").wait_for()
    page.wait_for_timeout(200)
    assert running.hand_force_n == 0  # it has not been in its middle since
    push(page, [0.0, 0.0])
    page.wait_for_timeout(200)
    push(page, [0.4, 0.0])
    until(page, lambda: running.hand_force_n > 10)
    push(page, None)  # its plug is pulled
    until(page, lambda: running.hand_force_n == 0)
    assert running.trips == ()


@pytest.mark.parametrize("page", WIDTHS[:1], indirect=True, scope="module")  # its script knows no width
def test_closed_browser_releases_hand_and_loop_continues(page, browser, console, running):
    page.click("#take")
    page.locator("#holder", has_text="No client").wait_for()
    other = browser.new_context(viewport=page.viewport_size)
    window = seldom_drawn(other.new_page())
    window.goto(console.address)  # which takes control, since it is free
    window.locator("#holder", has_text="You have control.").wait_for()
    window.mouse.move(*grip(window))
    window.mouse.down()
    window.mouse.move(grip(window)[0] + 40, grip(window)[1])
    until(window, lambda: running.hand_force_n > 10)
    page.locator("#on:disabled").wait_for()
    other.close()
    until(page, lambda: running.hand_force_n == 0)
    page.locator("#holder", has_text="No client").wait_for()
    assert running.trips == ()
    assert running.state.name == "active"
    page.click("#take")
    page.locator("#holder", has_text="You have control.").wait_for()


@pytest.mark.parametrize("page", WIDTHS[:1], indirect=True, scope="module")  # its script knows no width
def test_feel_sliders_change_the_feel(page, running):
    before = running.loader["feel.stiffness"]
    number = page.locator("[id='number-feel.stiffness']")
    number.fill("8000" if before > 950 else "9000")
    number.press("Enter")
    until(page, lambda: running.loader["feel.stiffness"] != before)
    wanted = (8000 if before > 950 else 9000) * 0.112985
    assert running.loader["feel.stiffness"] == pytest.approx(wanted, rel=1e-4)  # the factor's six digits


@pytest.mark.slow
def test_release_verdict_is_shown_also_to_later_pages(page, running, pages_before):
    """The first page waits for a release, 12 s; the later one shows its verdict and begins another, which the next test stops."""
    first = not pages_before
    pages_before.append(page)
    if first:
        page.locator("[data-test=release][data-side=positive]:enabled").click()
    page.locator("#judged strong", has_text="positive").wait_for()
    assert page.inner_text("#judged strong") == "Release from 50 % of the throw, positive: passed"
    assert page.locator("#judged tbody tr").count() > 5
    if not first:
        page.locator("[data-test=release][data-side=negative]:enabled").click()
        until(page, lambda: running.hand_force_n < -1)


def test_stop_is_shown_cleared_and_followed_by_restart(page):
    page.keyboard.press("Escape")
    page.locator("#state.tripped").wait_for()
    assert "stop" in page.inner_text("#trips").lower()
    page.click("#trips button")
    page.locator("#trips li").wait_for(state="detached")
    page.click("#off")
    page.click("#on")
    page.locator("#state.active").wait_for()


@pytest.mark.parametrize("page", WIDTHS[:1], indirect=True, scope="module")  # its script knows no width
def test_stop_without_connection_is_sent_first_on_reconnect(page, running):
    """The page's socket is closed under it, which opens another a second later."""
    page.evaluate("() => { for (const one of window.sockets) one.close(); }")
    page.locator("#state.lost").wait_for()
    assert page.locator("main[inert]").count()  # nothing that would be lost can be pressed
    page.keyboard.press("Escape")
    until(page, lambda: running.state.name == "tripped")
    page.locator("#state.tripped").wait_for()
    page.click("#trips button")
    page.locator("#trips li").wait_for(state="detached")
    page.click("#off")
    page.click("#on")
    page.locator("#state.active").wait_for()


@pytest.mark.parametrize("page", WIDTHS[:1], indirect=True, scope="module")  # its script knows no width
def test_fault_is_injected_and_cleared(page, running):
    page.locator("#fault").select_option("no_samples")
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


def test_simulator_status_is_shown(page):
    page.locator("#simulator:not([hidden])").wait_for()
    assert page.inner_text("#host") == "none yet; share in the feel 0.00"


def test_page_fits_window_and_touch_targets(page):
    assert page.evaluate("document.documentElement.scrollWidth <= window.innerWidth")
    small = page.evaluate(
        """least => [...document.querySelectorAll('button, select, .slider input, .choice label')].filter(one => one.offsetParent)
            .filter(one => one.getBoundingClientRect().height < least - 0.5).map(one => one.outerHTML)""",
        LEAST_PX,
    )
    assert small == []


def test_page_makes_no_external_request_and_no_console_error(page, console):
    assert page.complaints == []
    own = console.address.partition("?")[0]
    assert {url for url in page.requested if not url.startswith((own, "data:"))} == set()
    assert "token" not in page.url


def test_axis_ticks_keep_their_decimals(page):
    """Marks 2.5 apart, as uPlot places them, with the decimal that they have."""
    marks = {2.5: ("0", "2.5", "5.0", "7.5"), 0.25: ("0", "0.25", "0.50", "0.75"), 0.2: ("0", "0.2", "0.4", "0.6")}
    marks |= {5: ("0", "5", "10", "15"), 250: ("0", "250", "500", "750")}
    for apart, texts in marks.items():
        found = page.evaluate(
            "apart => import('./numbers.js').then(({ tick }) => [0, 1, 2, 3].map(k => tick(k * apart, apart)))", apart
        )
        assert tuple(found) == texts
