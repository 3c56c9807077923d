"""``frontier`` on a project: limits of its links, and what is refused."""

import json
from pathlib import Path

import pytest

import forcefeel as ff

EXAMPLES = Path("examples/cockpit").resolve()


def test_command_writes_the_limits_of_a_link(forcefeel, tmp_path, monkeypatch):
    monkeypatch.setitem(ff.frontier.link_frontier.__kwdefaults__, "delays", (1, 10))
    out = tmp_path / "out"
    status, text, _ = forcefeel("frontier", f"{EXAMPLES}/linked-sticks.toml", "--out", str(out), "--json")
    link = json.loads(text)["links"]["stick-pitch"]
    assert (status, link["law"], len(link["limits"])) == (0, "robust", 6)
    stiffness = [limit["stiffness"]["value"] for limit in link["limits"]]
    # Longer delays take less, more damping takes more.
    assert stiffness[0] > stiffness[3]
    assert stiffness[0] < stiffness[1] < stiffness[2]
    assert 0 < link["used"] < 0.1
    page = (out / "frontier.html").read_text(encoding="utf-8")
    assert "the largest stable stiffness of its links" in page


def test_project_without_links_and_options_of_one_loader_are_refused(forcefeel, tmp_path):
    for name, options, told in (
        ("cockpit", (), "has no table [links]"),
        ("linked-sticks", ("--grid", "damping=0.3,1"), "--grid: is for one loader"),
    ):
        status, out, error = forcefeel("frontier", f"{EXAMPLES}/{name}.toml", *options, "--out", str(tmp_path / name))
        assert (status, out) == (2, "")
        assert told in error


def test_delays_are_whole_periods():
    project = ff.loader.read_project(f"{EXAMPLES}/linked-sticks.toml")
    with pytest.raises(ff.InputError, match=r"delays: expected whole periods from 1 to 255, got \[0\]"):
        ff.frontier.link_frontier(project, "robust", delays=[0])
