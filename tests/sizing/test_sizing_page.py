"""The page of a sizing in a browser, at the width of a desk and of a phone."""

from pathlib import Path

import pytest

import forcefeel as ff
from tests.pages import (  # noqa: F401  what is asked of every page
    test_a_page_is_small_and_every_plot_has_its_text,
    test_heads_name_rows_and_columns_and_keep_their_words_whole,
    test_nothing_is_asked_for_but_the_page_and_its_script,
    test_nothing_is_cut_off,
    test_tables_and_drawing_stay_in_their_boxes,
    test_the_console_is_silent,
    test_the_navigation_stays_in_view,
    test_the_tool_bar_leaves_the_legend_free,
    test_tick_labels_do_not_overlap,
    views_of,
)

pytestmark = pytest.mark.browser

LOADERS = {
    "motor": ff.loader.electric("desktop-yoke").replace({"pilot.force": "250 N"}),
    "valve": ff.digital_elevator(),
}


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("sizes")
    found = {
        name: ff.sizing.write_sizing(ff.sizing.size_drive(loader), folder / name, ff.UnitSystem.US)
        for name, loader in LOADERS.items()
    }
    project = folder / "cockpit.toml"
    project.write_text('[axes]\npitch = "elevator-1974"\nyaw = "rudder-pedals"\n', encoding="utf-8")
    cockpit = ff.sizing.size_cockpit(ff.loader.read_project(project))
    return {**found, COCKPIT: ff.sizing.write_cockpit(cockpit, folder / COCKPIT, ff.UnitSystem.SI)}


COCKPIT = "cockpit"
page = views_of((*LOADERS, COCKPIT))


def test_the_picture_has_the_drive_and_all_that_is_asked(page):
    if page.called == COCKPIT:
        assert page.evaluate("() => document.querySelectorAll('.plotly-graph-div').length") == 2
        return
    names = page.evaluate("() => document.getElementById('force-speed').data.map(one => one.name)")
    curves = {
        "motor": ["limit of the motor for a short time", "limit of the motor continuously"],
        "valve": ["limit of the valve"],
    }
    asked = ff.sizing.size_drive(LOADERS[page.called]).demands
    assert names == [*curves[page.called], *(one.name for one in asked)]
