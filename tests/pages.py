"""Pages as their readers and their browser see them, and what is asked of every page."""

import re
import shutil
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlparse

import pytest

from forcefeel.page.script import SCRIPT

WIDTHS = (1280, 390)
ROUNDING_PX = 1.0
LARGEST_PAGE = 2_000_000
"""Bytes."""
LONGEST_MS = 120_000
"""Of a wait, on a busy machine."""

DRAWN = """() => [...document.querySelectorAll('.plotly-graph-div')].every(plot => plot.querySelector('.trace, .hm'))"""


class Words(HTMLParser):
    """The text that a reader sees, and what the page refers to."""

    def __init__(self) -> None:
        super().__init__()
        self.words: list[str] = []
        self.references: list[str] = []
        self._hidden = 0

    def handle_starttag(self, tag, attrs):
        self._hidden += tag in {"script", "style"}
        self.references += [value for name, value in attrs if name in {"src", "href"} and value]

    def handle_endtag(self, tag):
        self._hidden -= tag in {"script", "style"}

    def handle_data(self, data):
        if not self._hidden:
            self.words.append(data)


def words(page: Path) -> Words:
    parsed = Words()
    parsed.feed(page.read_text(encoding="utf-8"))
    return parsed


class OnDemand(dict):
    """Results by name, each made when it is first read: the fast tests look at one of several."""

    def __init__(self, make: Callable[[str], object]) -> None:
        super().__init__()
        self._make = make

    def __missing__(self, name: str) -> object:
        return self.setdefault(name, self._make(name))


def views_of(names: Iterable[str], fast: int = 1):
    """The fixture ``page``: each of the module's ``pages`` at each width; ``called`` is its name.

    Only the first page at the narrow width is not slow, or none if ``fast`` is 0. All are loaded in one window and from beside
    one script: another window or script would be compiled once more.
    """
    views = [
        pytest.param((name, width), marks=pytest.mark.browser, id=f"{name}-{width}")
        for width in sorted(WIDTHS)
        for name in names
    ]
    views = [*views[:fast], *(view._replace(marks=[*view.marks, pytest.mark.slow]) for view in views[fast:])]

    @pytest.fixture(scope="module", params=views)
    def page(request, window, pages):
        name, width = request.param
        folder = pages[name].parent
        if not (script := folder.parent / SCRIPT).exists():
            shutil.copy(folder / SCRIPT, script)
        show(window, Path(shutil.copy(pages[name], folder.parent / f"{name}.html")), width)
        window.called = name
        return window

    return page


SELDOM = """(() => {
    const frame = window.requestAnimationFrame.bind(window);
    window.requestAnimationFrame = (draw) => setTimeout(() => frame(draw), 60);
})()"""


def seldom_drawn(page):
    """The page, whose drawing moves a dozen times a second: without a graphics card sixty times take a whole core."""
    page.add_init_script(SELDOM)
    return page


@contextmanager
def new_window(browser) -> Iterator:
    """A window whose ``complaints`` and ``requested`` tell what its page logs and requests."""
    window = browser.new_page()
    window.set_default_timeout(LONGEST_MS)
    window.complaints, window.requested = [], []
    window.on(
        "console",
        lambda message: window.complaints.append(message.text) if message.type in {"error", "warning"} else None,
    )
    window.on("pageerror", lambda error: window.complaints.append(str(error)))
    window.on("request", lambda request: window.requested.append(request.url))
    yield window
    window.close()


def show(window, page: Path, width: int) -> None:
    """Loads a page in a window of a width and waits for its plots."""
    window.goto("about:blank")
    window.emulate_media(media="screen", color_scheme="light")
    window.set_viewport_size({"width": width, "height": 900})
    window.mouse.move(0, 0)
    window.complaints.clear()
    window.requested.clear()
    window.goto(page.as_uri())
    window.wait_for_function(DRAWN)


def words_cut(page, words: str, rounding: float) -> list[str]:
    """Words, found by a CSS selector, that lie outside their plot, and plots whose legend lies over the curves."""
    return page.evaluate(
        """([selector, rounding]) => [...document.querySelectorAll('.plotly-graph-div')].flatMap(plot => {
            const room = plot.getBoundingClientRect();
            const words = plot.querySelectorAll(selector);
            const outside = [...words].filter(word => {
                const box = word.getBoundingClientRect();
                return box.left < room.left - rounding || box.right > room.right + rounding
                    || box.top < room.top - rounding || box.bottom > room.bottom + rounding;
            }).map(word => plot.id + ': ' + word.textContent);
            const legend = plot.querySelector('.legend .bg');
            const curves = room.top + plot._fullLayout._size.t;
            const over = legend && legend.getBoundingClientRect().bottom > curves + rounding;
            return over ? [...outside, plot.id + ': legend over the curves'] : outside;
        })""",
        [words, rounding],
    )


class EveryPage:
    """What is required of every page in a browser: a module of tests names it ``TestPage``, beside its fixture ``page``."""

    def test_browser_console_has_no_messages(self, page):
        assert page.complaints == []

    def test_page_requests_only_itself_and_its_script(self, page):
        asked = {url for url in page.requested if not url.startswith(("data:", "blob:"))}
        assert asked == {page.url, page.url.rpartition("/")[0] + f"/{SCRIPT}"}

    def test_no_content_is_clipped(self, page):
        folded = page.evaluate("document.documentElement.scrollWidth")
        page.evaluate("document.querySelectorAll('details').forEach(one => one.open = true)")
        unfolded = page.evaluate("document.documentElement.scrollWidth")
        page.evaluate("document.querySelectorAll('details').forEach(one => one.open = false)")
        assert max(folded, unfolded) <= page.evaluate("innerWidth")

    def test_tables_and_drawings_stay_in_their_boxes(self, page):
        wide = page.evaluate(
            """() => [...document.querySelectorAll('main *')].filter(one =>
                !one.closest('.box') && !one.closest('.drawing') && !one.closest('.plotly-graph-div') &&
                one.getBoundingClientRect().right > innerWidth + 1).map(one => one.outerHTML.slice(0, 80))"""
        )
        assert wide == []

    def test_tick_labels_do_not_overlap(self, page):
        clashes = page.evaluate(
            """() => [...document.querySelectorAll('.plotly-graph-div')].flatMap(plot =>
                ['x', 'x2', 'x3', 'y', 'y2', 'y3'].flatMap(axis => {
                    const labels = [...plot.querySelectorAll(`.${axis}tick text`)].map(text =>
                        ({text: text.textContent, box: text.getBoundingClientRect()})).filter(one => one.box.width > 0);
                    return labels.slice(1).filter((one, k) => {
                        const before = labels[k].box;
                        return one.box.left < before.right && before.left < one.box.right
                            && one.box.top < before.bottom && before.top < one.box.bottom;
                    }).map(one => plot.id + ': ' + one.text);
                }))"""
        )
        assert clashes == []

    def test_page_is_small_and_every_plot_has_text(self, page):
        assert Path(unquote(urlparse(page.url).path)).stat().st_size < LARGEST_PAGE
        says = page.evaluate(
            "() => [...document.querySelectorAll('.plotly-graph-div')].map(one => [one.role, one.ariaLabel])"
        )
        assert [one for one in says if one[0] != "group" or not re.match(r"Plot( over|\.).*\d", one[1])] == []

    def test_table_headers_have_scope_and_whole_words(self, page):
        wrong = page.evaluate(
            """() => [...document.querySelectorAll('th')].flatMap(head => {
                const wanted = head.closest('thead') ? 'col' : 'row';
                if (head.scope !== wanted || !head.textContent.trim()) return ['scope of ' + head.textContent];
                const walk = document.createTreeWalker(head, NodeFilter.SHOW_TEXT), broken = [];
                while (wanted === 'col' && walk.nextNode()) {
                    for (const word of walk.currentNode.data.matchAll(/[A-Za-z]{2,}/g)) {
                        const range = document.createRange();
                        range.setStart(walk.currentNode, word.index);
                        range.setEnd(walk.currentNode, word.index + word[0].length);
                        if (new Set([...range.getClientRects()].map(one => one.top)).size > 1) broken.push(word[0]);
                    }
                }
                return broken;
            })"""
        )
        assert wrong == []

    def test_tool_bar_does_not_cover_legend(self, page):
        covered = page.evaluate(
            """() => [...document.querySelectorAll('.plotly-graph-div')].filter(plot => {
                const legend = plot.querySelector('.legend .bg'), bar = plot.querySelector('.modebar');
                if (!legend || !bar) return false;
                const a = legend.getBoundingClientRect(), b = bar.getBoundingClientRect();
                return a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
            }).map(plot => plot.id)"""
        )
        assert covered == []
        offered = {
            one.lower() for one in page.locator(".modebar-btn").evaluate_all("all => all.map(one => one.ariaLabel)")
        }
        assert offered <= {
            "autoscale",
            "reset axes",
            "zoom",
            "pan",
            "download plot as a png",
        }  # and none that sends it away

    def test_navigation_stays_in_view(self, page):
        page.evaluate("scrollTo({top: document.documentElement.scrollHeight, behavior: 'instant'})")
        top = page.evaluate("document.querySelector('nav').getBoundingClientRect().top")
        page.evaluate("scrollTo({top: 0, behavior: 'instant'})")
        assert abs(top) <= ROUNDING_PX
