"""Late samples and a cut wire on either side of a link: what the hand on the other side feels of it."""

import numpy as np
import pytest

import forcefeel as ff
from tests.live.test_cockpit import COCKPITS, LARGEST_STEP_N, columns, running

LATE_BUT_BRIDGED, TOO_LATE = 2, 10
"""Cycles: with the first the law goes on, the second stops the loader."""

PUSHES = {"linked-sticks": 25.0, "transport-column": 60.0}
"""Forces of the first hand in N, which load the link."""

NOISE_N = 2.0
"""Of a load cell."""


@pytest.mark.parametrize("side", [0, 1])
@pytest.mark.parametrize(("fault", "by"), [("late", LATE_BUT_BRIDGED), ("late", TOO_LATE), ("no_samples", 0)])
@pytest.mark.parametrize("name", PUSHES)
def test_force_on_the_other_side_is_no_larger_than_a_legal_one(name, side, fault, by):
    """Electronic: no step, and at most the breakout. A shaft stops both, and the force at the grip stays in its limit."""
    project = ff.loader.read_project(COCKPITS / f"{name}.toml")
    ((_, link),) = project.links.items()
    with running(project) as cockpit:
        sides = tuple(cockpit.values())
        sides[0].hand_force_n = PUSHES[name]
        cockpit.wait(3000)
        before = len(columns(sides[1 - side])["cycle"])
        sides[side].inject_fault(fault, by=by)
        cockpit.wait(3000)
        rows = {key: values[before:] for key, values in columns(sides[1 - side]).items()}
        other = sides[1 - side].loader
        trips = [session.trips[0].name if session.trips else None for session in sides]
    tripped = {"late": "samples late", "no_samples": "sensors silent"}[fault] if by != LATE_BUT_BRIDGED else None
    shaft = link.kind == "mechanical"
    assert trips[side] == tripped
    assert trips[1 - side] == ("another axis" if tripped and shaft else None)
    of_link = rows["link_torque_n_m"] / other["column.grip_arm"]
    if shaft:
        lever = other["linkage.ratio"] * other["column.base_arm"] / other["column.grip_arm"]  # eq. (6)
        assert np.abs(lever * rows["load_cell_force_n"]).max() < other["safety.force_limit"]
    else:
        assert np.abs(of_link).max() <= link["breakout"] / other["column.grip_arm"] + NOISE_N
        assert np.abs(np.diff(of_link)).max() < LARGEST_STEP_N
        assert (of_link[-1] == 0) == (tripped is not None)
    assert np.abs(rows["column_angle_rad"]).max() > 0.01  # the link was loaded
