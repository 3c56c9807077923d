"""A sweep over linked pairs: each pair is the run of its own loaders and link, and the summary is that of the pairs."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import spearmanr

import forcefeel as ff
from forcefeel.errors import InputError
from forcefeel.loader.links import LINK_TABLE
from forcefeel.sweep.linked_result import LINKED_MEASURES
from tests.linked.pairs import LB, LB_IN, project

COLUMN = str(Path("examples/cockpit/transport-column.toml").resolve())

BREAKOUT = 0.05
"""Required, of the breakout force: the override's spring and the damper add to it."""

PUSHED = ff.linked.LinkedScenario(
    ff.Scenario(ff.Recorded([0.0, 3.0, 4.0], [0.0, 70 * LB, 70 * LB]), 4.0),
    jam=ff.linked.Jam("pitch-first-officer", 0.1),
)
OPENED = ff.linked.LinkedScenario(ff.Scenario(ff.Step(25 * LB), 2.0), ff.Step(-5 * LB), disconnect_s=1.0)


def sweep(scenario, runs=24, **more):
    return ff.sweep.LinkedSweep(project("transport-column"), "pitch", scenario, ("robust", "robust"), runs=runs, **more)


@pytest.fixture(scope="module")
def opened():
    return ff.sweep.run_linked_sweep(sweep(OPENED))


def test_each_pair_is_the_run_of_its_own_loaders_and_link(opened):
    plan = opened.sweep
    laws = [ff.Law.of("robust", loader) for loader in plan.loaders]
    for k in (0, 7, 23):
        row = {name: float(opened.runs[name][k]) for name in opened.runs}
        loaders = {
            axis: loader.replace(
                {key.partition(".")[2]: value for key, value in row.items() if key.startswith(f"{side}.")}, si=True
            )
            for side, (axis, loader) in zip(("first", "second"), plan.project.loaders.items(), strict=True)
        }
        values = np.array([row.get(f"link.{name}", plan.joint[name]) for name in LINK_TABLE])
        changed = replace(plan.project, loaders=loaders, links={"pitch": replace(plan.joint, values=values)})
        # The laws are those of the nominal loaders.
        run = ff.linked.simulate_linked(changed, "pitch", OPENED, *laws)
        for name in ("peak_force_fight_n", "largest_difference_rad", "final_difference_rad"):
            assert row[name] == getattr(run.measures, name)
        after = run.history.where(run.history["time_s"] >= 1.0, drop=True)
        swings = []
        for side in ("first", "second"):
            angle, end = after[f"{side}_column_angle_rad"].to_numpy(), getattr(run.measures, f"{side}_final_angle_rad")
            swings.append(np.max(np.sign(end) * angle) - abs(end))
        assert row["swing_rad"] == pytest.approx(max(swings), rel=1e-9)  # sums in another order
    assert opened.share("held").runs == 24


def test_both_loaders_and_the_link_are_drawn_independently(opened):
    stiffness = [opened.runs[f"{side}.linkage.stiffness"].to_numpy() for side in ("first", "second")]
    assert not np.isclose(*stiffness).any()
    of_link = opened.runs["link.stiffness"].to_numpy() / opened.sweep.joint["stiffness"]
    assert 0.8 <= of_link.min() < 0.9
    assert 1.1 < of_link.max() <= 1.2


def test_numbers_do_not_depend_on_threads_or_number_of_runs(opened):
    again = ff.sweep.run_linked_sweep(sweep(OPENED, runs=10), threads=1)
    for name in (*LINKED_MEASURES, "link.damping"):
        np.testing.assert_array_equal(again.runs[name], opened.runs[name][:10])


def test_link_gives_way_at_the_breakout_of_each_pair():
    result = ff.sweep.run_linked_sweep(sweep(PUSHED))
    rows = result.runs["link.breakout"].to_numpy() / result.sweep.loaders[0]["column.grip_arm"]
    np.testing.assert_allclose(result.runs["breakout_force_n"], rows, rtol=BREAKOUT)
    assert result.share("gave way").runs == 24
    rho = spearmanr(result.runs["link.breakout"], result.runs["breakout_force_n"]).statistic
    assert result.ranking("breakout_force_n")[0] == ("link.breakout", pytest.approx(rho))


def test_stated_tolerances_replace_assumed_ones():
    vary = {"link.stiffness": None, "link.damping": None, "link.breakout": "900 lb in..1100 lb in", "link.play": "10 %"}
    plan = sweep(PUSHED, vary=vary | {"linkage.stiffness": None})
    assert [key for key in plan.varied if key.startswith("link.")] == ["link.breakout", "link.play"]
    assert plan.varied["link.breakout"].low == pytest.approx(900 * LB_IN)
    assert "second.linkage.stiffness" not in plan.varied


@pytest.mark.parametrize(
    ("vary", "message"),
    [
        ({"link.stifness": "20 %"}, "vary: link.stifness: expected a row of a link"),
        ({"link.delay": "20 %"}, "vary: link.delay: expected a row of a link"),
        ({"link.breakout": "20 lb"}, "vary: link.breakout: expected a tolerance such as"),
        ({"link.play": "0..200 deg"}, "vary: link.play: expected bounds within"),
        ({"linkag.stiffness": "20 %"}, "vary: unknown parameter"),
    ],
)
def test_bad_tolerance_is_refused(vary, message):
    with pytest.raises(InputError, match=message):
        sweep(PUSHED, vary=vary)


def test_command_sweeps_the_pair_of_a_project(forcefeel, tmp_path):
    words = ("sweep", COLUMN, "--law", "robust", "--force", "80 lb", "--second-force", "-70 lb", "--runs", "8")
    status, out, _ = forcefeel(*words, "--vary", "link.breakout=10 %", "--json", "--out", "pairs")
    told = json.loads(out)
    assert (status, told["runs"], told["link"]) == (0, 8, "pitch")
    assert {row["status"]: row["runs"] for row in told["statuses"]}["gave way"] == 8
    assert set(told["measures"]) >= {"peak_force_fight_n", "largest_difference_rad", "breakout_force_n"}
    assert told["varied"]["link.breakout"]["high"]["value"] == pytest.approx(1100.0)
    page = (tmp_path / "pairs" / "sweep.html").read_text(encoding="utf-8")
    assert "8 pairs: the link gave way" in page
    assert len((tmp_path / "pairs" / "runs.csv").read_text(encoding="utf-8").splitlines()) == 9


@pytest.mark.parametrize("option", [("--grid", "feel.stiffness=1..2 N m/rad:2"), ("--redesign",), ("--resume",)])
def test_option_of_one_loader_exits_with_2(forcefeel, option):
    status, _, error = forcefeel("sweep", COLUMN, *option)
    assert status == 2
    assert f"{option[0]}: is for one loader" in error
