"""A recording of the console: a hand drags the column of a simulated loader and lets go, as an animated picture."""

import io
import time
from pathlib import Path
from typing import TYPE_CHECKING

from PIL import Image

import forcefeel as ff
from forcefeel.loader.built_in import open_loader

if TYPE_CHECKING:
    from collections.abc import Iterator

    from playwright.sync_api import Browser, Page

WINDOW = {"width": 1000, "height": 760}
FRAMES_A_SECOND, LASTS_S = 8, 9.0
_PATIENCE_MS = 60_000
_HAND = ((0.5, 0), (1.5, 60), (2.5, 60), (2.6, None), (4.5, 0), (5.5, -70), (6.5, -70), (6.6, None))
"""Times in s, and the places of the hand beside the grip in pixels; None where it lets go."""


def record(browser: "Browser", loader: str, picture: Path) -> None:
    """Runs a built-in loader under ``robust``, and writes what its console shows."""
    running = ff.live.start(open_loader(loader), "robust")
    with running, ff.live.Console(running, port=0) as console:
        page = browser.new_page(viewport=WINDOW)
        page.goto(console.address, timeout=_PATIENCE_MS)
        page.click("#on")
        page.locator("#state.active").wait_for(timeout=_PATIENCE_MS)
        frames = list(_frames(page))
        page.close()
    picture.parent.mkdir(parents=True, exist_ok=True)
    first, *others = frames
    each_ms = [round(1000 * (after - before)) for (before, _), (after, _) in zip(frames, others, strict=False)]
    first[1].save(
        picture,
        save_all=True,
        append_images=[image for _, image in others],
        duration=[*each_ms, 500],
        loop=0,
        quality=60,
    )


def _frames(page: "Page") -> "Iterator[tuple[float, Image.Image]]":
    """Times and pictures, as many as the machine takes, while the hand moves."""
    page.evaluate("window.scrollTo(0, 0)")
    box = page.locator("#column").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + 40
    begun, left = time.monotonic(), list(_HAND)
    held = False
    while (now := time.monotonic() - begun) < LASTS_S:
        while left and left[0][0] <= now:
            _, at = left.pop(0)
            if at is None:
                page.mouse.up()
            else:
                page.mouse.move(x + at, y, steps=5)
                if not held:
                    page.mouse.down()
            held = at is not None
        yield now, Image.open(io.BytesIO(page.screenshot())).convert("RGB")
        page.wait_for_timeout(max(0.0, 1000 / FRAMES_A_SECOND - 1000 * (time.monotonic() - begun - now)))
