"""The page of an electric loader's design in a real browser, at the width of a desk and of a phone."""

import pytest

import forcefeel as ff
from tests.pages import EveryPage, OnDemand, views_of

pytestmark = pytest.mark.browser

UNITS = {"us": ff.UnitSystem.US}


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    folder, design = tmp_path_factory.mktemp("motors"), ff.design_loader(ff.loader.electric("sidestick-roll"))
    return OnDemand(lambda name: ff.design.write_report(design, folder / name, UNITS[name]))


page = views_of(UNITS, fast=0)
TestPage = EveryPage
