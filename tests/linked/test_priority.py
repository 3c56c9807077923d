"""Priority of one of two active sidesticks, and the dual-input cue, against cases worked out by hand."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.errors import InputError
from tests.linked.pairs import project

STICKS = str(Path("examples/cockpit/linked-sticks.toml").resolve())

SETTLED = 0.02
"""Of an angle at rest: friction and the sensors' noise."""

LATE_S = 2e-3
"""Of a change of priority: a sample, and the force of the step before."""


def sticks(first, second, duration_s=3.0, *, button=None, **rows):
    """A run of two sticks without a breakout, SI rows of the link changed."""
    axes = project("linked-sticks")
    link = axes.links["stick-pitch"]
    values = np.array([{"breakout": np.inf, **rows}.get(row, link[row]) for row in ff.loader.links.LINK_TABLE])
    # Without breakout and soft stops of the feel, so that a hand can be worked out by hand.
    loaders = {
        axis: loader.replace(dict.fromkeys(row for row in loader.given if row.startswith("feel.")))
        for axis, loader in axes.loaders.items()
    }
    changed = replace(axes, loaders=loaders, links={"stick-pitch": replace(link, values=values)})
    scenario = ff.linked.LinkedScenario(ff.Scenario(first, duration_s), second, button=button)
    return ff.linked.simulate_linked(changed, "stick-pitch", scenario, "robust")


def ramp(force, until, duration_s=3.0):
    """A force that rises to a time and falls back to zero at the end."""
    return ff.Recorded(np.array([0.0, until, duration_s]), np.array([0.0, force, 0.0]))


def test_pilot_who_presses_the_button_flies_with_the_own_feel_and_the_other_follows():
    button = ff.linked.Button("stick-pitch-first-officer", 0.5)
    run = sticks(ff.Step(10.0), ff.Step(-20.0), button=button)
    loader, stiffness = run.loaders[0], run.link["stiffness"]
    feel, arm = loader["feel.stiffness"], loader["column.grip_arm"]
    second = -20.0 * arm / feel
    first = (10.0 * arm + stiffness * second) / (feel + stiffness)
    assert run.measures.second_final_angle_rad == pytest.approx(second, rel=SETTLED)
    assert run.measures.first_final_angle_rad == pytest.approx(first, rel=SETTLED)
    assert run.history["commanded_angle_rad"].to_numpy()[-1] == pytest.approx(second, rel=SETTLED)
    assert run.history["second_link_torque_n_m"].to_numpy()[-1] == 0
    assert (run.measures.first_priority_s, run.measures.second_priority_s) == (0, pytest.approx(2.5, abs=LATE_S))


def test_force_above_the_threshold_takes_priority_until_half_of_it():
    # Above 30 N from 0.75 s on, at 40 N at 1 s, below 15 N from 2.25 s on.
    run = sticks(ff.Step(5.0), ramp(40.0, 1.0), priority_force=30.0)
    holds = run.history["time_s"].to_numpy()[run.history["priority"].to_numpy() == 2]
    assert (holds[0], holds[-1]) == (pytest.approx(0.75, abs=LATE_S), pytest.approx(2.25, abs=LATE_S))
    assert run.measures.first_priority_s == 0


def test_button_goes_before_force():
    run = sticks(
        ramp(40.0, 1.0), ff.Step(5.0), button=ff.linked.Button("stick-pitch-first-officer", 1.0), priority_force=30.0
    )
    time, priority = run.history["time_s"].to_numpy(), run.history["priority"].to_numpy()
    assert priority[np.searchsorted(time, 0.9)] == 1
    assert set(priority[time > 1.0 + LATE_S]) == {2}


def test_both_hands_give_the_cue_and_the_mean_without_priority():
    pulse = ff.simulation.Pulse(10.0, 0.3, 1.0)
    run = sticks(ff.Step(10.0, 0.8), pulse, dual_input_force=8.0)
    assert run.measures.dual_input_s == pytest.approx(0.5, abs=LATE_S)
    angles = [run.history[f"{side}_column_angle_rad"].to_numpy() for side in ("first", "second")]
    np.testing.assert_allclose(
        run.history["commanded_angle_rad"], np.mean(angles, axis=0), rtol=0, atol=1e-12
    )  # one sum of two floats
    assert not run.history["priority"].any()


def test_button_is_refused_on_a_shaft_and_for_another_axis():
    scenario = ff.linked.LinkedScenario(ff.Scenario(ff.Step(1.0)), button=ff.linked.Button("pitch", 0.5))
    with pytest.raises(InputError, match="button: is of an electronic link, and pitch is mechanical"):
        ff.linked.simulate_linked(project("transport-column"), "pitch", scenario, "robust")
    with pytest.raises(InputError, match="button: expected stick-pitch or stick-pitch-first-officer, got 'pitch'"):
        ff.linked.simulate_linked(project("linked-sticks"), "stick-pitch", scenario, "robust")


def test_command_tells_priority(forcefeel):
    options = ("--force", "2 lb", "--priority", "0.5 s: stick-pitch-first-officer")
    status, text, _ = forcefeel("simulate", STICKS, *options)
    assert status == 0
    assert "Priority: stick-pitch-first-officer for 1.5 s" in " ".join(text.split())
