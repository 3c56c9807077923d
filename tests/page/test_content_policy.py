"""The content security policy of a page: its own scripts run, what came into it does not."""

import pytest

from forcefeel.page.render import with_policy
from tests.pages import new_window

PAGE = """<!DOCTYPE html>
<html><head>
<script src="beside.js"></script>
<script>const own = "ä";</script>
</head><body style="color: red">OTHER</body></html>
"""
FOREIGN = '<script>var foreign = 1;</script><img src="x" onerror="foreign = 2"><img src="https://example.org/a.png">'


@pytest.mark.browser
def test_only_scripts_of_the_page_run(browser, tmp_path):
    (tmp_path / "beside.js").write_text("const beside = 1;", encoding="utf-8")
    page = tmp_path / "page.html"
    page.write_text(with_policy(PAGE).replace("OTHER", FOREIGN), encoding="utf-8")
    with new_window(browser) as window:
        failed = {}
        window.on("requestfailed", lambda request: failed.update({request.url.rpartition("/")[2]: request.failure}))
        window.goto(page.as_uri())
        ran = "[typeof own, typeof beside, typeof foreign, getComputedStyle(document.body).color]"
        assert window.evaluate(ran) == ["string", "number", "undefined", "rgb(255, 0, 0)"]
        assert failed == {"x": "csp", "a.png": "csp"}
