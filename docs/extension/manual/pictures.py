"""Pictures of the pages that commands write, taken by a Chromium without a window."""

from pathlib import Path
from typing import Any

from playwright.sync_api import Browser, Page, sync_playwright
from sphinx.errors import ExtensionError

from forcefeel.errors import InputError
from forcefeel.page.chromium import VARIABLE, find_chromium
from manual.recording import record

_DRAWN = "() => [...document.querySelectorAll('.plotly-graph-div')].every(plot => plot.querySelector('.trace, .hm'))"
_PATIENCE_MS = 60_000


class Camera:
    """A Chromium that starts with the first picture."""

    def __init__(self) -> None:
        self._running: Any = None
        self._chromium: Browser | None = None
        self._page: tuple[Path, int, Page] | None = None

    def take(self, page_file: Path, picture: Path, selector: str, width: int) -> None:
        """Draws a page in a window so wide, and keeps the part that a CSS selector finds, or the first sheet of it.

        Raises:
            ExtensionError: If there is no Chromium, no such page, or nothing of it that the selector finds.
        """
        if not page_file.is_file():
            raise ExtensionError(f"picture: there is no page {page_file}")
        page = self._opened(page_file, width)
        picture.parent.mkdir(parents=True, exist_ok=True)
        if not selector:
            page.screenshot(path=picture)
            return
        element = page.locator(selector).first
        if not element.count():
            raise ExtensionError(f"picture: {page_file.name} has nothing that {selector!r} finds")
        element.screenshot(path=picture, timeout=_PATIENCE_MS)

    def record(self, loader: str, picture: Path) -> None:
        """Records the console of a built-in loader, see ``recording``."""
        record(self._started(), loader, picture)

    def close(self) -> None:
        """Ends the Chromium, if one was started."""
        if self._chromium:
            self._chromium.close()
            self._running.stop()
            self._chromium = self._page = None

    def _opened(self, page_file: Path, width: int) -> Page:
        if self._page and self._page[:2] == (page_file, width):
            return self._page[2]
        if self._page:
            self._page[2].close()
        page = self._started().new_page(viewport={"width": width, "height": 820}, device_scale_factor=1.5)
        page.goto(page_file.as_uri(), timeout=_PATIENCE_MS)
        page.wait_for_function(_DRAWN, timeout=_PATIENCE_MS)
        self._page = (page_file, width, page)
        return page

    def _started(self) -> Browser:
        if self._chromium is None:
            try:
                program = find_chromium()
            except InputError as error:
                raise ExtensionError(
                    f"pictures are taken by a Chromium, but it is missing: install it, set {VARIABLE} to it, "
                    "or build without pictures: make site PICTURES=0"
                ) from error
            self._running = sync_playwright().start()
            self._chromium = self._running.chromium.launch(
                executable_path=program, args=["--no-sandbox", "--disable-gpu"]
            )
        return self._chromium
