"""Dry friction of the column that a law knows: releases that are rendered with and without, hands that feel it or do not."""

from dataclasses import replace

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.envelope.cases import NOMINAL, Case, Kind
from forcefeel.envelope.plan import make_plan
from forcefeel.envelope.run import compute
from forcefeel.laws.law import Law
from forcefeel.laws.sampled.known_friction import SLOW_RAD_PER_S
from forcefeel.laws.sampled.law_designs import LAW_DESIGNS, LawDesign
from forcefeel.laws.sampled.sampled_law import OF_FRICTION
from forcefeel.loader.built_in import BUILT_IN
from forcefeel.simulation.inputs import Recorded, Release
from tests.parametrization import mostly_slow

GRID = {"stiffness": "5, 12, 30 %", "frequency": "0.7, 2 Hz", "damping": "0.3, 0.7"}
FRICTION = {"column.coulomb_friction": "1 lb", "column.static_friction": "1.2 lb"}
"""An eighth of the force with which the softest of these feels lets go of the elevator at 10 deg."""
NONE = dict.fromkeys(FRICTION)


def rendered(machine, law, grid=GRID, case=NOMINAL):
    """Share of the settings whose release is within tolerance, in one case."""
    plan = make_plan(machine, [law] if isinstance(law, str) else {"law": law}, grid, arms=())
    object.__setattr__(plan, "cases", (case,))
    return compute(plan).shares(next(iter(plan.laws))).nominal_share


PLAIN = LawDesign(
    "plain",
    "of the loader without its friction",
    lambda it, feel: LAW_DESIGNS["robust"].design(it.replace(NONE, si=True), feel),
)


@pytest.mark.parametrize("name", ["elevator-2khz", "elevator-electric"])
def test_friction_known_to_the_law_is_compensated(name):
    loader = BUILT_IN[name]()
    loader = loader.replace(FRICTION)
    assert rendered(loader, PLAIN) < 0.5
    assert rendered(loader, "robust") > 0.8  # of 12 settings 12 and 10


def test_force_curve_matches_the_feel_except_for_breakaway():
    """Slowly to and fro: where the column moves, the width of the loop is the damping's alone; without, twice the friction more."""
    feel = {"feel.inertia": 0.5, "feel.damping": 3.0, "feel.stiffness": 20.0}
    loader = ff.digital_elevator().replace(feel | FRICTION, si=True).with_tolerances({"column.coulomb_friction": "1 %"})
    time = np.linspace(0.0, 10.0, 2001)
    force = 20.0 * np.sin(2 * np.pi * 0.2 * time)
    off = {}
    for known, law in (
        ("friction", Law.of("robust", loader)),
        ("none", Law.of("robust", loader.with_tolerances({"column.coulomb_friction": None}).replace(NONE, si=True))),
    ):
        history = ff.simulate(loader, ff.Scenario(Recorded(time, force), 10.0, 5e-4, 5e-3), law).history
        angle, rate = history.column_angle_rad.values, history.column_velocity_rad_per_s.values
        torque = 20.0 * angle + 3.0 * rate
        moving = (np.abs(rate) > 0.2 * np.abs(rate).max()) & (history.time_s.values > 5.0)
        push = np.interp(history.time_s.values, time, force)
        off[known] = np.mean((push - torque / loader["column.grip_arm"]) * np.sign(rate), where=moving)
    assert off["none"] == pytest.approx(loader["column.coulomb_friction"], rel=0.05)  # the noise of the sensors
    # Measured: 0.053; 0.044 where a released column is let go of within 10 in place of 5 ms.
    assert abs(off["friction"]) < 0.06 * loader["column.coulomb_friction"]


def test_friction_level_is_saved_and_interpolated_between_laws(tmp_path):
    loader = ff.digital_elevator().replace(FRICTION)
    law = Law.of("robust", loader)
    law.save(tmp_path / "law.json")
    again = Law.of(tmp_path / "law.json", loader)
    np.testing.assert_array_equal(again.sampled.rows(), law.sampled.rows())
    other = Law.of("robust", loader.replace({"column.coulomb_friction": "2 lb", "column.static_friction": None}))
    level = law.sampled.between(other.sampled, 0.5).friction[0, -OF_FRICTION]
    assert level == pytest.approx(1.5 * loader["column.coulomb_friction"] * loader["column.grip_arm"])


SLOW, REST = 5 - OF_FRICTION, -1
"""Places of v_s and v_r among the numbers of the friction."""

AT_REST_DEG = 0.02


@pytest.mark.parametrize("name", ["elevator-2khz", "aileron-wheel"])
@pytest.mark.parametrize("true_share", [0.8, 1.0, 1.2])
def test_released_column_comes_to_rest(name, true_share):
    """Hands off for 12 s after a release from 3 deg, friction exact and off: the column ends near the neutral, within 0.02 deg.

    The wheel is light: with v_s of a heavy column, without the part for rest, it swings on in each of these cases.
    """
    feel = {"feel.stiffness": 200.0, "feel.inertia": 2.25, "feel.damping": 12.7}  # 1.5 Hz, damping ratio 0.3
    loader = BUILT_IN[name]().replace(feel if name == "elevator-2khz" else {}, si=True)
    friction_n = 9.0 if name == "elevator-2khz" else 2.2
    friction = {"column.coulomb_friction": friction_n, "column.static_friction": 1.2 * friction_n}
    loader = loader.replace(friction, si=True)
    law = Law.of("robust", loader)
    true = {key: true_share * value for key, value in friction.items()}

    def last_quarter(law):
        run = ff.simulate(loader.replace(true, si=True), ff.Scenario(Release(np.radians(3)), 12.0), law)
        angle = np.degrees(run.history.column_angle_rad.values)
        return angle[-len(angle) // 4 :]

    last = last_quarter(law)
    assert np.ptp(last) < AT_REST_DEG
    numbers = law.sampled.friction.copy()
    numbers[:, SLOW], numbers[:, REST] = SLOW_RAD_PER_S, 0.0
    if name == "aileron-wheel":
        restless = Law.of(replace(law.sampled, friction=numbers), loader, name="restless")
        assert np.ptp(last_quarter(restless)) > AT_REST_DEG
    # The spring has less than a tenth of the friction, and what the link gives as it is unloaded.
    friction_n_m = loader["column.coulomb_friction"] * loader["column.grip_arm"]
    assert abs(last[-1]) < np.degrees(0.15 * friction_n_m / loader["feel.stiffness"])


SOFT = {"stiffness": "1, 2.5, 6 %", "frequency": "0.5, 1, 2 Hz", "damping": "0.1, 0.7"}


@pytest.mark.parametrize("share", mostly_slow([-0.2, 0.2]))
def test_friction_error_is_learned_hands_off(share):
    """Breakaway off with it. Measured: all of 18 soft settings; 3 and 6 under a law that is sure of what it was told."""
    loader = ff.digital_elevator().replace(FRICTION)
    certain = loader.with_tolerances({"column.coulomb_friction": "0.01 %"})
    fixed = LawDesign(
        "fixed", "of a friction that is certain", lambda _, feel: LAW_DESIGNS["robust"].design(certain, feel)
    )
    case = Case("off", Kind.PLANT, dict.fromkeys(FRICTION, share))
    learnt, told = (rendered(loader, law, SOFT, case) for law in ("robust", fixed))
    assert learnt > 0.9
    assert told < 0.5


def test_learned_friction_is_bounded_by_its_tolerance():
    """And a bit beyond, for its noise."""
    loader = ff.digital_elevator().replace(FRICTION)
    for stated, ends in ((None, (-0.2, 0.2)), ("5 %", (-0.05, 0.05)), ({"uniform": ["0.7 lb", "1.1 lb"]}, (-0.3, 0.1))):
        law = Law.of("robust", loader.with_tolerances({"column.coulomb_friction": stated}) if stated else loader)
        np.testing.assert_allclose(
            law.sampled.friction[0, -7:-5], np.multiply(1.3, ends), rtol=1e-9
        )  # digits of a file


AS_IT_IS = FRICTION | {
    "column.static_friction": "1.3 lb",
    "column.stribeck_velocity": "0.05 rad/s",
    "column.friction_asymmetry": 0.2,
}


def test_friction_by_direction_that_falls_over_a_velocity_is_compensated():
    """A fifth more than stated, measured: 17 of 18 soft settings; 5 where the law is told of a fast column's friction alone."""
    loader = ff.digital_elevator().replace(AS_IT_IS)
    fast = loader.replace(FRICTION | dict.fromkeys(AS_IT_IS.keys() - FRICTION.keys()))
    told = LawDesign("told", "of a fast column", lambda _, feel: LAW_DESIGNS["robust"].design(fast, feel))
    case = Case("off", Kind.PLANT, dict.fromkeys(FRICTION, 0.2))
    known, level_alone = (rendered(loader, law, SOFT, case) for law in ("robust", told))
    assert known > 0.8
    assert level_alone < 0.4


def test_law_of_a_light_column_does_not_depend_on_the_settings_beside_it():
    loader = BUILT_IN["aileron-wheel"]().replace(FRICTION)
    own = np.array([loader[f"feel.{row}"] for row in ("inertia", "damping", "stiffness")])
    feel = own * np.array([[1.0, 1.0, 1.0], [0.05, 0.2, 1.0]])
    together = Law.of("robust", loader, feel).sampled.friction
    alone = [Law.of("robust", loader, feel[k : k + 1]).sampled.friction[0] for k in range(len(feel))]
    np.testing.assert_array_equal(together, alone)
    assert len(set(together[:, SLOW])) == len(feel)


def test_friction_varies_by_default_without_a_stated_tolerance():
    cases = make_plan(ff.digital_elevator().replace(FRICTION), ["robust"], GRID).cases
    assert {case.change for case in cases if case.parameter == "column.coulomb_friction"} == {-0.2, 0.2}
    assert not [case for case in make_plan(ff.digital_elevator(), ["robust"], GRID).cases if "friction" in case.name]


def test_hand_motion_does_not_change_the_learned_friction():
    """Slowly to and fro, friction as told and 10 % off: it feels by how much it is off. Where its way through zero torque teaches
    for good, the level goes to its lower end: 18 % more is felt of each."""
    feel = {"feel.inertia": 0.5, "feel.damping": 3.0, "feel.stiffness": 20.0}
    time = np.linspace(0.0, 10.0, 2001)
    force = 20.0 * np.sin(2 * np.pi * 0.2 * time)
    stated = ff.digital_elevator().replace(feel | FRICTION, si=True)
    law = Law.of("robust", stated)
    for off in (-0.1, 0.0, 0.1):
        loader = stated.replace({key: (1 + off) * stated[key] for key in FRICTION}, si=True)
        history = ff.simulate(loader, ff.Scenario(Recorded(time, force), 10.0, 5e-4, 5e-3), law).history
        angle, rate = history.column_angle_rad.values, history.column_velocity_rad_per_s.values
        moving = (np.abs(rate) > 0.2 * np.abs(rate).max()) & (history.time_s.values > 5.0)
        push = np.interp(history.time_s.values, time, force) - (20.0 * angle + 3.0 * rate) / loader["column.grip_arm"]
        width = np.mean(push * np.sign(rate), where=moving) / stated["column.coulomb_friction"]
        assert width == pytest.approx(off, abs=0.05)  # measured: -0.058, 0.042, 0.143; 1 % of it without learning


def beside_feel(friction, share_off, stiffness_share, push_share, releases, period_s):
    """What a slow hand feels beside the programmed feel after some releases, in N, and the column's rate in rad/s.

    `elevator-2khz`, a feel of 1 Hz and damping 0.5; friction falls over 0.05 rad/s and is off by a share.
    """
    loader, omega = ff.digital_elevator(), 2 * np.pi
    stiffness, falls = stiffness_share * loader["feel.maximum_stiffness"], {"column.stribeck_velocity": 0.05}
    feel = {"feel.stiffness": stiffness, "feel.inertia": stiffness / omega**2, "feel.damping": stiffness / omega}
    stated = loader.replace(friction).replace(feel | falls, si=True)
    machine = stated.replace({key: (1 + share_off) * stated[key] for key in FRICTION}, si=True)
    start = 6.0 * releases
    time = np.arange(0.0, start + 1.25 * period_s, 0.01)
    push = push_share * stiffness / stated["column.grip_arm"]
    force = np.where(time < start, 0.0, push * np.sin(2 * np.pi * (time - start) / period_s))
    for k in range(releases):
        held = (time >= 6.0 * k) & (time < 6.0 * k + 2.0)
        force[held] = (-1) ** k * 1.5 * push * np.minimum(1.0, (time[held] - 6.0 * k) / 0.8)
    scenario = ff.Scenario(Recorded(time, force), time[-1], 5e-4, 5e-3)
    history = ff.simulate(machine, scenario, Law.of("robust", stated)).history
    angle, rate, at = (history[key].values for key in ("column_angle_rad", "column_velocity_rad_per_s", "time_s"))
    of_feel = (stiffness * angle + feel["feel.damping"] * rate) / machine["column.grip_arm"]
    pushed = at > start
    return np.interp(at, time, force)[pushed] - of_feel[pushed], rate[pushed]


LB = 4.4482216152605


def test_slow_hand_does_not_make_a_column_heavy_that_friction_holds():
    """A fifth more friction than stated holds the column and lets it go, again and again, as a slow hand turns round. The law took
    that for a stiff contact, damped the feel on its way back, and the hand felt 4.6 lb beside the programmed feel."""
    beside, rate = beside_feel(FRICTION | {"column.static_friction": "1.3 lb"}, 0.2, 0.2, 0.1, 0, 20.0)
    moving = (np.abs(rate) > 0.2 * np.abs(rate).max()) & (np.arange(len(rate)) > len(rate) // 5)
    assert np.abs(beside[moving]).max() < 1.2 * LB


THREE = {"column.coulomb_friction": "3 lb", "column.static_friction": "3.9 lb"}


def test_column_that_friction_stops_after_a_release_is_not_heavy():
    """While friction holds the column, the loop moves the load cell's force to and fro by less than the friction. The law took
    that for a stiff contact, and the next push had to overcome 17 lb. Measured: 6.9 lb, 4.7 of them breakaway."""
    beside, _ = beside_feel(THREE, 0.2, 0.5, 0.1, 2, 8.0)
    assert np.abs(beside).max() < 8.0 * LB


@pytest.mark.parametrize("off", mostly_slow([0.2, -0.2]))
def test_slow_sweep_after_releases_knows_friction_that_has_drifted(off):
    """3 lb of friction and a fifth more or less, mean along the motion. Measured: 0.68 and -0.72 lb at once, 0.26 and -0.04 after
    four releases. Where a slow way through zero torque taught as a release does, 0.9 lb remained."""
    for releases, felt in ((0, (0.5, 0.9)), (4, (0.0, 0.3))):
        beside, rate = beside_feel(THREE, off, 0.2, 0.12, releases, 40.0)
        moving = (np.abs(rate) > 0.2 * np.abs(rate).max()) & (np.arange(len(rate)) > len(rate) // 5)
        assert felt[0] < np.sign(off) * np.mean((beside * np.sign(rate))[moving]) / LB < felt[1]


@pytest.mark.slow
def test_observer_includes_viscous_friction():
    """Measured of 18 soft settings: all; 8 where it is not."""
    loader = ff.digital_elevator().replace({"column.viscous_friction": "10 lb in s/rad"})
    bare = loader.replace({"column.viscous_friction": None})
    without = LawDesign("without", "", lambda _, feel: LAW_DESIGNS["robust"].design(bare, feel))
    known, unknown = (rendered(loader, law, SOFT) for law in ("robust", without))
    assert known > 0.95
    assert unknown < 0.8
