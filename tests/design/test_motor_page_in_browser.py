"""The page of an electric loader's design in a real browser, at the width of a desk and of a phone."""

import pytest

import forcefeel as ff
from tests.pages import (  # noqa: F401  what is asked of every page
    test_browser_console_has_no_messages,
    test_no_content_is_clipped,
    test_page_is_small_and_every_plot_has_text,
    test_table_headers_have_scope_and_whole_words,
    test_tables_and_drawings_stay_in_their_boxes,
    test_tick_labels_do_not_overlap,
    test_tool_bar_does_not_cover_legend,
    views_of,
)

pytestmark = pytest.mark.browser

UNITS = {"us": ff.UnitSystem.US}


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    folder, design = tmp_path_factory.mktemp("motors"), ff.design_loader(ff.loader.electric("sidestick-roll"))
    return {name: ff.design.write_report(design, folder / name, units) for name, units in UNITS.items()}


page = views_of(UNITS)
