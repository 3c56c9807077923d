"""A linked pair as a user has it: statics, breakout, energy, jam, and one side alone."""

from dataclasses import replace

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.errors import InputError
from tests.linked.pairs import DEG, LB, LB_IN, link_values, project, raw, simulated

Step, Scenario = ff.Step, ff.Scenario

BREAKOUT, NO_STEP_LB = 0.05, 2.0
"""Required: of the breakout force, and of the force at re-engagement."""

SETTLED, STATICS = 5e-3, 0.02
"""Of the sum of both feels and of the torque: what friction and the sensors' noise leave at the end of a run."""

ALIKE = 0.01
"""Of the largest angle: a shaft, and a soft link over one period of delay."""

ENERGY = 5e-3
"""Of the energy that passes through the link: its torque is sampled."""


def values_of(run, *names):
    return (run.history[name].to_numpy() for name in names)


def test_both_feels_hold_a_pilot_who_is_alone():
    run = simulated("transport-column", Scenario(Step(40 * LB), 6.0))
    stiffness = run.loaders[0]["feel.stiffness"]
    first, second, torque = (
        row[-1] for row in values_of(run, "first_column_angle_rad", "second_column_angle_rad", "second_link_torque_n_m")
    )
    pushed = 40 * LB * run.loaders[0]["column.grip_arm"]
    assert stiffness * (first + second) == pytest.approx(pushed, rel=SETTLED)
    assert torque == pytest.approx(stiffness * second, rel=STATICS)
    assert torque == pytest.approx(run.link["stiffness"] * (first - second - 0.05 * DEG), rel=STATICS)
    assert run.measures.peak_force_fight_n == 0


def test_link_without_stiffness_leaves_each_loader_alone():
    loaders = ff.digital_elevator(), ff.loader.electric("aileron-wheel")
    scenarios = [Scenario(Step(force), 1.0, 2.5e-4, 1e-3) for force in (60.0, -20.0)]
    rows = raw(loaders, scenarios, link_values(stiffness=1e-9), "robust").T
    for side, (loader, scenario) in enumerate(zip(loaders, scenarios, strict=True)):
        alone = ff.simulate(loader, scenario, "robust").history["column_angle_rad"].to_numpy()
        # The noise of the second side is another stream.
        np.testing.assert_allclose(rows[3 * side], alone, rtol=0, atol=(1e-9, 2e-3)[side] * np.abs(alone).max())


@pytest.mark.parametrize("kind", ff.linked.LinkKind)
@pytest.mark.parametrize("sign", [1, -1])
def test_breakout_force_and_re_engagement_without_a_step(sign, kind):
    """The second column is jammed, the first pushed slowly beyond the breakout and back."""
    ramp = ff.Recorded([0.0, 8.0, 16.0], [0.0, sign * 70 * LB, 0.0])
    jam = ff.linked.Jam("pitch-first-officer", 0.1)
    run = simulated("transport-column", Scenario(ramp, 16.0), kind=kind, jam=jam)
    angle, torque, hand, beyond = values_of(
        run, "first_column_angle_rad", "first_link_torque_n_m", "first_hand_force_n", "link_gives_way"
    )
    arm, stiffness = run.loaders[0]["column.grip_arm"], run.loaders[0]["feel.stiffness"]
    out, back = np.argmax(beyond), len(beyond) - np.argmax(beyond[::-1])
    assert 2000 < out < back - 2000 < 14000
    assert np.all(beyond[out:back])
    at_breakout = 1000 / 20000 + 0.05 * DEG
    expected = (1000 * LB_IN + stiffness * at_breakout) / arm
    for k in (out, back):
        assert -sign * torque[k] == pytest.approx(1000 * LB_IN, rel=BREAKOUT)
        assert sign * hand[k] == pytest.approx(expected, rel=BREAKOUT)
        assert sign * angle[k] == pytest.approx(at_breakout, rel=BREAKOUT)
    jammed = run.history["second_column_angle_rad"].to_numpy()
    after = 1000 * LB_IN + 2000 * LB_IN * (sign * (angle - jammed) - at_breakout)
    np.testing.assert_allclose(-sign * torque[out:back], after[out:back], rtol=BREAKOUT)
    assert np.abs(np.diff(torque)).max() / arm / LB < NO_STEP_LB
    assert run.measures.gave_way_at_s == pytest.approx(out * 1e-3)


def test_jammed_column_stays_where_it_was():
    jam = ff.linked.Jam("pitch-first-officer", 0.3)
    run = simulated("transport-column", Scenario(Step(40 * LB, 0.1)), jam=jam)
    first, second = values_of(run, "first_column_angle_rad", "second_column_angle_rad")
    assert np.ptp(second[:300]) > 0.02
    assert np.ptp(second[305:]) < 1e-12
    assert np.ptp(first[305:]) > 0.005


def test_opened_link_leaves_the_second_column_free():
    run = simulated("transport-column", Scenario(Step(40 * LB, 0.1), 4.0), disconnect_s=0.5)
    torque, second = values_of(run, "first_link_torque_n_m", "second_column_angle_rad")
    assert np.abs(torque[:500]).max() > 20
    assert not torque[501:].any()
    assert abs(second[-1]) < 0.02 * np.abs(second).max()
    assert run.note == "the link was opened at 0.500 s"


def test_no_energy_comes_out_of_the_link_of_a_pair():
    draws = np.random.default_rng(36)
    loader = ff.digital_elevator()
    times = np.linspace(0, 2, 9)
    for run in range(40):
        forces = [ff.Recorded(times, np.r_[0, draws.uniform(-300, 300, 8)]) for _ in range(2)]
        scenarios = [Scenario(force, 2.0, 5e-4, 5e-4) for force in forces]
        link = link_values(
            stiffness=draws.uniform(100, 3000),
            damping=draws.uniform(0, 20),
            play=draws.uniform(0, 0.02),
            breakout=draws.uniform(20, 150),
            stiffness_after=draws.uniform(0, 300),
        )
        events = {
            "uncouples": bool(draws.integers(2)),
            "disconnect": int(draws.integers(1, 8000)),
            "jam": (int(draws.integers(2)), int(draws.integers(1, 8000))),
        }
        rows = raw((loader, loader), scenarios, link, "robust", outputs=(0, 1), **events).T
        power = rows[4] * rows[1] + rows[5] * rows[3]
        out = np.cumsum(0.5 * (power[1:] + power[:-1])) * 5e-4
        through = np.abs(power).sum() * 5e-4
        assert out.max() <= ENERGY * through, (run, events)


def test_release_of_both_moves_both_alike():
    release = ff.Release(10 * DEG)
    run = simulated("uncoupling", Scenario(release, 3.0), release)
    first, second = values_of(run, "first_column_angle_rad", "second_column_angle_rad")
    assert np.abs(first - second).max() < 1e-3
    assert run.measures.peak_link_force_n < 1.0


def test_electronic_link_acts_as_a_mechanical_one_where_it_is_soft():
    loader = ff.digital_elevator()
    scenarios = [Scenario(Step(force, 0.1), 2.0) for force in (100.0, 0.0)]
    link = link_values(stiffness=450.0, damping=2.0)
    shaft, wire = (raw((loader, loader), scenarios, link, "robust", **joint).T for joint in ({}, {"delay": 1}))
    for side in (0, 3):
        np.testing.assert_allclose(wire[side], shaft[side], rtol=0, atol=ALIKE * np.abs(shaft[0]).max())


def test_law_at_the_grip_holds_against_a_shaft_and_is_named():
    axes = project("linked-sticks")
    loaders = {axis: loader.replace({"grip_sensor.gain": 1.0}) for axis, loader in axes.loaders.items()}
    pushed = ff.linked.LinkedScenario(Scenario(Step(4 * LB), 3.0))
    second = {}
    for kind in ff.linked.LinkKind:
        links = {name: replace(link, kind=kind) for name, link in axes.links.items()}
        run = ff.linked.simulate_linked(replace(axes, loaders=loaders, links=links), "stick-pitch", pushed, "grip")
        warned = "feels the hand alone" in " ".join(ff.linked.linked_conclusions(run, ff.UnitSystem.US).findings)
        second[kind] = run.measures.second_final_angle_rad, warned
    assert second["mechanical"] == (pytest.approx(0.0, abs=1e-3 * DEG), True)  # at rest but for noise
    assert second["electronic"][0] > 0.3 * DEG
    assert not second["electronic"][1]


@pytest.mark.parametrize(
    ("first", "more", "told"),
    [
        (Scenario(Step(1.0)), {"disconnect_s": 3.0}, "disconnect_s: expected a time within the run of 2 s, got 3 s"),
        (
            Scenario(Step(1.0)),
            {"jam": ff.linked.Jam("roll", 1.0)},
            "jam: expected pitch or pitch-first-officer, got 'roll'",
        ),
        (Scenario(ff.Release(0.1)), {}, "a release is of both pilots, alike"),
        (Scenario(ff.Recorded([0.0, 3.0], [5.0, 5.0])), {}, "expected a first force of 0, as the link is at rest"),
    ],
)
def test_impossible_scenario_is_refused(first, more, told):
    with pytest.raises(InputError, match=told):
        simulated("transport-column", first, **more)


def test_project_without_that_link_is_refused():
    with pytest.raises(InputError, match="link: expected one of pitch, got 'pich'; did you mean pitch"):
        ff.linked.simulate_linked(project("uncoupling"), "pich", ff.linked.LinkedScenario(Scenario()))


def test_friction_holds_the_collective_of_both_pilots():
    """3 lb in each feel computer; between them the shaft turns by 0.2 deg under 2 lb."""
    cockpit = project("helicopter")
    assert ff.loader.axes.rule_axis("collective-first-officer") == "collective"
    time = np.arange(0.0, 6.001, 0.001)

    def angles(force_n):
        raised = ff.simulation.Recorded(time, np.interp(time, [0, 0.5, 3, 3.1], [0, force_n, force_n, 0]))
        scenario = ff.linked.LinkedScenario(ff.Scenario(raised, 6.0, 5e-4, 5e-4))
        history = ff.linked.simulate_linked(cockpit, "collective", scenario, "robust").history
        return [np.degrees(history[f"{side}_column_angle_rad"].to_numpy()) for side in ("first", "second")]

    assert max(np.abs(angle).max() for angle in angles(2 * LB)) < 0.2
    for angle in angles(7 * LB):
        assert angle[5000] > 3
        assert angle[-1] > 0.9 * angle[6500]
