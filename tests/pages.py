"""Pages as their readers and their browser see them, for the tests of every page."""

from collections.abc import Iterator
from contextlib import contextmanager
from html.parser import HTMLParser
from pathlib import Path

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


@contextmanager
def opened(browser, page: Path, width: int) -> Iterator:
    """The page in a window so wide, its plots drawn; ``complaints`` and ``requested`` tell what it said and asked for."""
    window = browser.new_page(viewport={"width": width, "height": 900})
    window.complaints, window.requested = [], []
    window.on(
        "console",
        lambda message: window.complaints.append(message.text) if message.type in {"error", "warning"} else None,
    )
    window.on("pageerror", lambda error: window.complaints.append(str(error)))
    window.on("request", lambda asked: window.requested.append(asked.url))
    window.goto(page.as_uri())
    window.wait_for_function(DRAWN, timeout=20_000)
    yield window
    window.close()


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
