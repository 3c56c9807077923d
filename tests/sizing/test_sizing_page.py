"""The page of a sizing in a browser, at the width of a desk and of a phone."""

from pathlib import Path

import pytest

import forcefeel as ff
from tests.pages import EveryPage, views_of

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
    return {**found, COCKPIT: ff.sizing.write_sizing(cockpit, folder / COCKPIT, ff.UnitSystem.SI)}


COCKPIT = "cockpit"
page = views_of((*LOADERS, COCKPIT), fast=0)
TestPage = EveryPage


def test_plot_shows_drive_curves_and_all_demands(page):
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
