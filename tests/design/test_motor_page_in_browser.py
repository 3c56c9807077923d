"""The page of an electric loader's design in a real browser, at the width of a desk and of a phone."""

import pytest

import forcefeel as ff
from tests.pages import (  # noqa: F401  what is asked of every page
    test_a_page_is_small_and_every_plot_has_its_text,
    test_heads_name_rows_and_columns_and_keep_their_words_whole,
    test_nothing_is_cut_off,
    test_tables_and_drawing_stay_in_their_boxes,
    test_the_console_is_silent,
    test_the_tool_bar_leaves_the_legend_free,
    test_tick_labels_do_not_overlap,
    views_of,
)

pytestmark = pytest.mark.browser

UNITS = {"us": ff.UnitSystem.US}


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    folder, design = tmp_path_factory.mktemp("motors"), ff.design_loader(ff.loader.electric("sidestick-roll"))
    return {name: ff.design.write_report(design, folder / name, units) for name, units in UNITS.items()}


page = views_of(UNITS)
