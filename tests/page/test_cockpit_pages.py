"""The test guide and the envelopes of a cockpit: one valve, one motor; the pages in a browser, and what stands in the folder."""

import json
import re
from pathlib import Path

import pytest

import forcefeel as ff
from forcefeel.envelope import find_cockpit, make_plan
from forcefeel.qualification import QualificationSetup, qualify_cockpit
from tests.pages import EveryPage, views_of, words

GUIDE, ENVELOPES = "guide", "envelopes"
GRID = {"stiffness": "30, 100 %", "frequency": "1, 2 Hz", "damping": "0.5, 1"}
LAWS = {"hydraulic": "original", "electric": "robust"}
TESTS = ("release-25-positive", "static")


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> ff.loader.Project:
    file = tmp_path_factory.mktemp("cockpit") / "cockpit.toml"
    file.write_text('[axes]\npitch = "elevator-2khz"\nyaw = "rudder-pedals"\n', encoding="utf-8")
    return ff.loader.read_project(file)


@pytest.fixture(scope="module")
def guide(project):
    return qualify_cockpit(project, lambda loader: QualificationSetup(tests=TESTS, laws=(LAWS[loader.drive],)))


@pytest.fixture(scope="module")
def envelopes(project):
    def plan(loader: ff.Loader) -> ff.envelope.Plan:
        return make_plan(loader, ["robust"], GRID, changes={"linkage.stiffness": 0.2}, arms=())

    return find_cockpit(project, plan)


@pytest.fixture(scope="module")
def pages(guide, envelopes, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("pages")
    units = ff.UnitSystem.US
    return {
        GUIDE: ff.qualification.write_qualification(guide, folder / GUIDE),
        ENVELOPES: ff.envelope.write_envelope(envelopes, folder / ENVELOPES, units),
    }


page = views_of((GUIDE, ENVELOPES), fast=0)
TestPage = EveryPage


@pytest.mark.slow
def test_each_axis_has_same_rows_and_law_as_alone(project, guide):
    assert {axis: one.sections[0].name for axis, one in guide.axes.items()} == {"pitch": "original", "yaw": "robust"}
    assert [one.sections[0].results[0].trial.test.number for one in guide.axes.values()] == ["2.a.1.a", "2.a.3.a"]
    alone = ff.qualify_loader(project.loaders["yaw"], QualificationSetup(tests=TESTS, axis="yaw"))
    assert [one.outcome for one in guide.axes["yaw"].sections[0].results] == [
        one.outcome for one in alone.sections[0].results
    ]
    assert guide.axes["yaw"].fulfilled
    assert not guide.fulfilled


def test_guide_has_linked_row_per_test_and_axis(pages, guide):
    text = pages[GUIDE].read_text(encoding="utf-8")
    articles = re.findall(r'<article class="test" id="([\w-]+)"', text)
    assert len(articles) == len(set(articles)) == sum(len(one.sections[0].results) for one in guide.axes.values())
    within = {one.removeprefix("#") for one in words(pages[GUIDE]).references if one.startswith("#")}
    assert within <= set(re.findall(r' id="([\w-]+)"', text))
    assert set(articles) <= within
    stored = json.loads((pages[GUIDE].parent / "results.json").read_text(encoding="utf-8"))
    assert stored["status"] == "does not qualify"
    assert [one["rule"]["axis"] for one in stored["axes"].values()] == ["pitch", "yaw"]


def test_axes_table_links_to_existing_pages(pages, envelopes):
    folder = pages[ENVELOPES].parent
    for name in ("envelope.html", "envelope-pitch.html", "envelope-yaw.html"):
        links = [one for one in words(folder / name).references if not one.startswith(("#", "data:"))]
        assert [one for one in links if not (folder / one).is_file()] == []
    stored = json.loads((folder / "results.json").read_text(encoding="utf-8"))
    for row in envelopes.rows:
        alone = stored["axes"][row.axis]["laws"][row.law]["shares"]
        assert alone["nominal_share"]["value"] == pytest.approx(100 * row.nominal_share)
    assert [row["axis"] for row in stored["table"]] == ["pitch", "yaw"]


def test_loader_envelope_replaces_cockpit_envelope(envelopes, tmp_path):
    ff.envelope.write_envelope(envelopes, tmp_path / "out", ff.UnitSystem.US)
    one = ff.envelope.write_envelope(envelopes.axes["yaw"], tmp_path / "out", ff.UnitSystem.US, replace=True)
    assert {file.name for file in one.parent.iterdir()} == {
        "envelope.html",
        "envelope.nc",
        "plotly.min.js",
        "results.json",
        "settings.csv",
    }
