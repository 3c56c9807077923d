"""Faults injected into supervised loaders, and runs without one: what a hand is given, and no false trips."""

import numpy as np
import pytest
from numpy.typing import NDArray

import forcefeel as ff
from forcefeel import _core
from forcefeel.loader.built_in import open_loader

MOST_ENERGY_J, MOST_TIME_ABOVE_S = 10.0, 0.02
RUNS = 1200
"""Some fifty of each kind. ``benchmarks/faults.py`` and ``benchmarks/linked_faults.py`` run millions."""

GRIP = {"grip_sensor.gain": 1.0, "grip_sensor.noise": "0.02 lb", "grip_sensor.resolution": "0.01 lb"}

KIND, STOPPED, WRONG, ABOVE, FORCE, EXCESS = 0, 3, 5, 10, 11, 12
"""Columns of the outcomes."""


@pytest.fixture(scope="module")
def loaders() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """A hydraulic loader, the same with a light feel and dry friction that its law knows, an electric one and a light one, each
    under its law; and the last two with a force sensor at the grip."""
    of = [open_loader(name) for name in ("elevator-2khz", "elevator-2khz", "elevator-electric", "sidestick-pitch")]
    light = {key: 0.3 * of[1][key] for key in ("feel.inertia", "feel.damping", "feel.stiffness")}
    of[1] = (
        of[1].replace(light, si=True).replace({"column.coulomb_friction": "2 lb", "column.static_friction": "2.4 lb"})
    )
    of += [loader.replace(GRIP) for loader in of[2:]]
    made = [ff.Law.of("robust", loader).sampled for loader in of]
    return np.array([loader.si_values for loader in of]), np.array([law.rows()[0] for law in made if law is not None])


def test_fault_gives_hand_less_than_ten_joules(loaders) -> None:
    outcomes = _core.supervised_faults(*loaders, seed=3, count=RUNS, faults=1)
    kinds = np.array(_core.fault_kinds())[outcomes[:, KIND].astype(int)]
    assert set(kinds) == set(_core.fault_kinds())
    assert not outcomes[:, WRONG].any()
    assert outcomes[:, EXCESS].max() < MOST_ENERGY_J
    of_loader = ~np.isin(kinds, ["LargestForce", "LastingForce"])
    assert outcomes[of_loader, ABOVE].max() <= MOST_TIME_ABOVE_S
    for kind in ("Late", "Silence", "DriveHardover", "Huge", "Reversed"):
        assert (outcomes[kinds == kind, STOPPED] >= 0).mean() > 0.8
    # A law that goes to and fro between both limits.
    assert (outcomes[kinds == "Swinging", STOPPED] >= 0).mean() > 0.45
    for kind in ("GripStuck", "GripNoisy"):
        assert (outcomes[kinds == kind, STOPPED] >= 0).any()
    # What is lost for less than the silence, and a spike where there is power, are bridged; a start is not.
    for kind in ("None", "Lost", "Spike", "HostSilent"):
        assert (outcomes[kinds == kind, STOPPED] >= 0).mean() < 0.05


def test_legal_runs_are_not_stopped(loaders) -> None:
    outcomes = _core.supervised_faults(*loaders, seed=3, count=600, faults=0)
    assert not outcomes[:, WRONG].any()
    assert (outcomes[:, STOPPED] < 0).all()


def test_column_that_runs_into_its_end_stop_under_a_grip_sensor_is_not_stopped(loaders) -> None:
    """The feel went on by its own motion, the hand lighter than its spring, and the drive pushed the column into the stop."""
    electric = tuple(rows[4:5] for rows in loaders)
    outcomes = _core.supervised_faults(*electric, seed=7, first=9479, count=1, faults=0)
    assert (outcomes[:, STOPPED] < 0).all()


def test_loop_begins_without_a_jolt_between_near_end_stops() -> None:
    """What the sensors show at rest was taken beyond the stops, and the column was thrown with up to 318 N, hands off."""
    loader = open_loader("sidestick-pitch").replace({"column.stop_low": "-5 deg", "column.stop_high": "5 deg"})
    law = ff.Law.of("robust", loader).sampled
    assert law is not None
    of = np.array([loader.si_values]), law.rows()
    # Every fifth run has no hand, and every tenth nothing else but the stops. A few begin pressed into one.
    runs = [_core.supervised_faults(*of, seed=1, first=10 * k + 5, count=1, faults=0)[0] for k in range(30)]
    assert all(run[STOPPED] < 0 for run in runs)
    assert np.mean([run[FORCE] < 2.0 for run in runs]) > 0.8


def test_fault_on_one_side_of_a_link_leaves_the_other_side_within_its_limits() -> None:
    """Electronic link of two sticks: the other side is not stopped. Shaft of two columns: it stops with the first."""
    project = ff.loader.read_project("examples/cockpit/linked-sticks.toml")
    sticks = project.links["stick-pitch"]
    pair = [open_loader(name) for name in ("sidestick-pitch", "elevator-2khz")]
    laws = [ff.Law.of("robust", loader).sampled for loader in pair]
    values = np.array([loader.si_values for loader in pair])
    rows = np.array([law.rows()[0] for law in laws if law is not None])
    shaft = ff.loader.read_project("examples/cockpit/transport-column.toml").links["pitch"]
    links = [((0, 0), sticks.values.tolist(), 2, False), ((1, 1), shaft.values.tolist(), None, False)]
    outcomes = _core.supervised_pair_faults(values, rows, links, seed=5, count=RUNS, faults=1)
    sides = outcomes[:, 4:].reshape(len(outcomes), 2, -1)
    faulty = outcomes[:, 1].astype(int)
    at, other = sides[np.arange(len(sides)), faulty], sides[np.arange(len(sides)), 1 - faulty]
    electronic = outcomes[:, 0] == 0
    # No side has a force sensor at the grip that could stick.
    at_grip = np.isin(at[:, KIND], [_core.fault_kinds().index(kind) for kind in ("GripStuck", "GripNoisy")])
    assert (at[electronic & ~at_grip, STOPPED] >= 0).mean() > 0.7
    assert (other[electronic, STOPPED] < 0).all()
    stopped = ~electronic & (at[:, STOPPED] >= 0)
    assert ((other[stopped, STOPPED] >= 0) & (other[stopped, STOPPED] <= at[stopped, STOPPED] + 1)).all()
    assert not other[:, WRONG].any()
    assert other[:, EXCESS].max() < MOST_ENERGY_J
    by_hand = np.isin(at[:, KIND], [_core.fault_kinds().index(kind) for kind in ("LargestForce", "LastingForce")])
    largest = np.array([loader["safety.absolute_force"] for loader in pair])[outcomes[:, 0].astype(int)]
    assert (outcomes[~by_hand, 2] < largest[~by_hand]).all()
    # Electronic: no more than the breakout, and the link's damper with both at the largest speed.
    most = sticks["breakout"] + 2 * sticks["damping"] * pair[0]["safety.speed_limit"]
    assert outcomes[electronic & ~by_hand, 2].max() < most / pair[0]["column.grip_arm"]
