"""Envelope with both hands on: a slack link changes nothing, a late one swings on, and the command says so."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.envelope.cases import REFERENCE_ARMS
from forcefeel.envelope.cockpit.pair import pair_settings
from forcefeel.envelope.settings import Settings
from tests.linked.pairs import project

STICKS = str(Path("examples/cockpit/linked-sticks.toml").resolve())
GRID = {"stiffness": "30, 60 %", "frequency": "1.5, 3 Hz", "damping": "0.4, 0.7"}
ARMS = REFERENCE_ARMS[::2]


def linked(kind="mechanical", **rows):
    """The envelope of two sticks on a link of other rows."""
    axes = project("linked-sticks")
    link = axes.links["stick-pitch"]
    values = np.array([rows.get(row, link[row]) for row in ff.loader.links.LINK_TABLE])
    changed = replace(link, values=values, kind=ff.linked.LinkKind(kind))
    cockpit = ff.envelope.find_cockpit(
        replace(axes, links={"stick-pitch": changed}),
        lambda loader: ff.envelope.make_plan(loader, ["robust"], GRID, changes={}, arms=ARMS),
    )
    return cockpit.pairs[0]


@pytest.mark.slow
def test_slack_link_leaves_each_side_as_alone():
    pair = linked(stiffness=1e-3, damping=0.0)
    assert pair.arms == ("hands off", "light", "firm")
    assert pair.rendered.sum() >= 6
    assert pair.linked_share == 1
    assert all(row.passes == 1 and row.unstable == 0 for row in pair.rows)


def test_stiff_late_link_swings_on_with_the_hands_off():
    pair = linked("electronic", stiffness=1500.0, breakout=1e4, delay=0.03, injected_damping=0.0)
    rows = {(row.first, row.second): row for row in pair.rows}
    # Two free sticks far beyond k d = c. Where the swing beats at its limits, a figure of the rule fails instead.
    free = rows["hands off", "hands off"]
    assert free.unstable > 0  # five of eight; at 0.02 s, by stiffness and noise, none to four
    assert free.passes == 0
    assert pair.linked_share == 0


def test_settings_of_a_pair_are_some_of_the_grid():
    whole = Settings.of({})
    some, index = pair_settings(whole)
    assert some.shape == (4, 5, 6)
    np.testing.assert_array_equal(whole.rows[index], some.rows)


@pytest.mark.slow
def test_command_judges_links(forcefeel, tmp_path):
    grid = [text for name, values in GRID.items() for text in ("--grid", f"{name}={values}")]
    options = ("--no-contact", "--draws", "0", "--out", str(tmp_path / "out"))
    status, text, _ = forcefeel("envelope", STICKS, *grid, *options, "--json")
    (link,) = json.loads(text)["links"]
    assert (status, link["between"], link["settings"]) == (0, ["stick-pitch", "stick-pitch-first-officer"], 8)
    assert len(link["arms"]) == 16
    assert link["rendered_alone"] <= 8
    page = (tmp_path / "out" / "envelope.html").read_text(encoding="utf-8")
    assert "Link stick-pitch: both hands on" in page
    assert "Stick-pitch, arm" in page


def test_link_that_cannot_run_is_refused_before_the_work(tmp_path):
    path = tmp_path / "pair.toml"
    path.write_text(
        '[axes]\npitch = "elevator-1974"\npitch-first-officer = "elevator-2khz"\n'
        '[links.pitch]\nbetween = ["pitch", "pitch-first-officer"]\nstiffness = "4000 lb in/rad"\n',
        encoding="utf-8",
    )
    with pytest.raises(ff.InputError, match=r"pair\.toml: controller\.period: expected one period"):
        ff.envelope.find_cockpit(
            ff.loader.read_project(path), lambda loader: ff.envelope.make_plan(loader, ["original"], GRID)
        )
