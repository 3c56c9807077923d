"""``forcefeel frontier`` as a user types it, and the folder that it writes."""

import json
import re

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.errors import InputError
from forcefeel.frontier import run as frontier_run
from forcefeel.frontier.page.page import PAGE, RESULTS
from forcefeel.frontier.result import Limit
from tests.command_line import runs

SMALL = (
    *("--grid", "stiffness=3, 100 %"),
    *("--grid", "frequency=2, 4 Hz"),
    *("--grid", "damping=0.2, 1.5"),
)
COUNT = 8


command = runs("frontier", report=True)


@pytest.fixture
def run(command, monkeypatch):
    """Runs ``forcefeel frontier ...`` with two errors; the others have their own tests."""
    monkeypatch.setattr(frontier_run, "ERRORS", (0.02, 0.1))
    return command


@pytest.mark.slow
def test_built_in_loader_has_a_frontier(run, tmp_path):
    status, out, err = run(*SMALL, "--out", "found")
    assert (status, err) == (0, "")
    assert f"of {COUNT} programmed feels" in " ".join(out.split())
    assert "bound on any linear law" in " ".join(out.split())
    assert "column half as heavy" in out
    assert {one.name for one in (tmp_path / "found").iterdir()} == {PAGE, RESULTS, "plotly.min.js"}
    page = (tmp_path / "found" / PAGE).read_text(encoding="utf-8")
    text = re.sub(r"<[^>]*>", " ", re.sub(r"<(script|style).*?</\1>", "", page, flags=re.DOTALL))
    assert not re.search(r"\d\.\d{7}", text)
    assert "not verified" in text.lower()


@pytest.mark.slow
def test_results_are_consistent(run, tmp_path):
    status, out, _ = run(*SMALL, "--json", "--units", "si")
    assert status == 0
    found = json.loads(out)
    stored = json.loads((tmp_path / "forcefeel-frontier" / RESULTS).read_text(encoding="utf-8"))
    assert {key: value for key, value in found.items() if key != "page"} == stored
    assert found["settings"] == COUNT
    assert sum(row["value"] for row in found["limits"].values()) == pytest.approx(100)
    limits = np.array(found["limit_of_each_setting"])
    assert limits.shape == (2, 2, 2)
    every = found["shares"]["worst_case_share"]["value"]
    assert 100 * (limits == list(Limit).index(Limit.NONE)).mean() == pytest.approx(every)
    assert found["tightening"]["passes_in_every_case"]["value"] == pytest.approx(every)
    assert len(found["bound"]["possible"]) == len(found["bound"]["inertia_known_to"])
    assert found["law"] == "published"


@pytest.mark.slow
def test_python_interface_gives_the_frontier():
    grid = {"stiffness": "10, 100 %", "frequency": "2, 4 Hz", "damping": "0.3, 1"}
    found = ff.find_frontier(ff.elevator(), "original", grid, changes={"column.inertia": 0.15}, arms=())
    assert found.inertia_tolerance == 0.15
    assert 0.15 in found.bound.errors
    assert found.limits.shape == (2, 2, 2)
    assert found.possible.shape == (8,)
    with pytest.raises(InputError, match=r"column\.inertia: expected a tolerance"):
        ff.find_frontier(ff.elevator(), "original", grid, changes={"linkage.ratio": 0.1})


def test_existing_frontier_is_not_overwritten(run, tmp_path):
    assert run(*SMALL)[0] == 0
    before = (tmp_path / "forcefeel-frontier" / RESULTS).read_bytes()
    status, _, err = run(*SMALL, "--angle", "5 deg")
    assert status == 2
    assert "--replace" in err
    assert (tmp_path / "forcefeel-frontier" / RESULTS).read_bytes() == before
    (tmp_path / "taken").write_text("mine")
    assert run(*SMALL, "--out", "taken")[0] == 2


def test_interrupted_run_writes_nothing(run, tmp_path, monkeypatch):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(frontier_run, "run_levels", interrupted)
    status, _, err = run(*SMALL)
    assert status == 130
    assert "nothing is written" in err
    assert not (tmp_path / "forcefeel-frontier").exists()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--rule", "part61"), "part60-a-2014"),
        (("--law", "best"), "original, published, converged"),
        (("--law", "robust"), "controller.period"),
        (("--grid", "mass=1..2:3"), "unknown axis"),
        (("--angle", "10"), "--angle: expected"),
        (("there-is-none.toml",), "there-is-none.toml"),
    ],
)
def test_invalid_input_exits_2_with_remedy(run, tmp_path, words, message):
    status, out, err = run(*words)
    assert (status, out) == (2, "")
    assert message in err
    assert "Traceback" not in err
    assert not list(tmp_path.iterdir())
