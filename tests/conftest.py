"""Hypothesis: a fast profile for every run, others by ``HYPOTHESIS_PROFILE``. And the browser of the page tests."""

import os
import shutil
from collections.abc import Iterator
from functools import cache

import numpy as np
import pytest
from cyclopts.argument import _collection
from hypothesis import settings
from pydantic import TypeAdapter

from forcefeel.live import rendered
from tests.command_line import runs
from tests.pages import new_window

# Derandomized: a failure is one of the code, not of the day.
settings.register_profile("fast", max_examples=20, deadline=None, derandomize=True, database=None)
settings.register_profile("validate", max_examples=60, deadline=None, derandomize=True, database=None)
settings.register_profile("slow", max_examples=2000, deadline=None, database=None, print_blob=True)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "fast"))


# ``forcefeel("law", "my.toml", ...)`` in the empty folder of a test.
forcefeel = runs()


class KeptAdapter(TypeAdapter):
    """An adapter of pydantic that is made once for each type."""

    @cache
    def __new__(cls, *kind, **options):
        return TypeAdapter(*kind, **options)

    def __class_getitem__(cls, kind):
        return TypeAdapter[kind]


@pytest.fixture(scope="session", autouse=True)
def kept_types() -> Iterator[None]:
    """Groups and validators of a command's options are made once: for thousands of commands it is a third of their time."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("pydantic.TypeAdapter", KeptAdapter)
        patch.setattr(_collection, "_resolve_groups_from_callable", cache(_collection._resolve_groups_from_callable))
        yield


@pytest.fixture(scope="module")
def coarse_range() -> Iterator[None]:
    """What a host may ask of a loader is tried at fewer springs between the same ends, its own among them; all take it 3 s."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(rendered, "_SPRINGS", np.geomspace(1 / 256, 1024, 10))
        patch.setattr(rendered, "_RATIOS", np.geomspace(0.02, 8.0, 6))
        yield


@pytest.fixture(scope="session")
def browser() -> Iterator:
    """A Chromium; without one the tests are skipped, or fail where it is required.

    Playwright's loop counts as running in this thread from here on: ``asyncio.run`` takes a thread of its own.
    """
    from playwright.sync_api import sync_playwright  # noqa: PLC0415  for few of the tests

    path = _chromium()
    with sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=path, args=["--no-sandbox", "--disable-gpu"])
        yield opened
        opened.close()


@pytest.fixture(scope="session")
def window(browser) -> Iterator:
    """A window in which pages are shown, one after another: their script is compiled once."""
    with new_window(browser) as opened:
        yield opened


def _chromium() -> str:
    given = os.environ.get("FORCEFEEL_CHROMIUM")
    found = given or next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    if found:
        return found
    missing = "no Chromium found: install chromium, or set FORCEFEEL_CHROMIUM to its path"
    if os.environ.get("FORCEFEEL_REQUIRE_BROWSER") == "1":
        pytest.fail(missing)
    pytest.skip(missing)
