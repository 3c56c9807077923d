"""What a host's packets do to the column under a law, in virtual time: each packet comes before a cycle of its own."""

import numpy as np
import pytest

import forcefeel as ff
from tests.live.planned import planned

APART = 33
"""Cycles between two packets: of a host with 60 a second, at 2 kHz."""
BEGINS = 606 * APART
ACTIVE, AUTOPILOT = 1, 2
NONE = {
    "dynamic_pressure": 0.0,
    "spring_factor": 1.0,
    "trim": 0.0,
    "autopilot_position": 0.0,
    "autopilot_force": 0.0,
    "added_force": 0.0,
    "shaker": 0.0,
    "pusher_force": 0.0,
    "trim_runaway_rate": 0.0,
    "jam_force": 0.0,
}
STANDS_RAD = 2.5e-3
"""Friction, resolution of the sensors and what is left of a transient."""
LOADERS = {"elevator-2khz": ff.digital_elevator, "elevator-electric": lambda: ff.loader.electric("elevator-electric")}


def guided(loader, parts, hand=()):
    """Columns of a run under ``robust``: the host's switches and values from a cycle on each, the hand's force likewise."""
    wishes, ends = [(0, "on", [])], [begin for begin, *_ in parts[1:]] + [parts[-1][0] + 14_000]
    for (begin, switches, values), end in zip(parts, ends, strict=True):
        numbers = [*({**NONE, **values}.values())]
        wishes += [(cycle, "host", [float(cycle), float(switches), *numbers]) for cycle in range(begin, end, APART)]
    force = np.zeros(ends[-1])
    for begin, newtons in hand:
        force[begin:] = newtons
    return planned(loader, force, wishes, host="127.0.0.1:0")


@pytest.mark.parametrize("name", LOADERS)
def test_an_autopilot_drives_the_column_back_and_a_hand_overrides_it(name):
    loader = LOADERS[name]()
    arm, stiffness = loader["column.grip_arm"], loader["feel.stiffness"]
    angle, force = 0.05, 0.05 * stiffness / arm
    engaged = ACTIVE | AUTOPILOT
    weak = {"autopilot_position": angle, "autopilot_force": 0.5 * force}
    found = guided(
        loader,
        [(0, engaged, {**weak, "autopilot_force": 10 * force}), (BEGINS, engaged, weak)],
        hand=[(10_000, -force), (BEGINS, -force)],
    )
    column = found["column_angle_rad"]
    # The servo's spring of four times the feel's against that: 4 G (theta_a - theta) = G theta.
    assert column[9_000:10_000].mean() == pytest.approx(0.8 * angle, abs=STANDS_RAD)
    # A hand beside it: 5 G theta = 4 G theta_a - R_p F.
    assert column[19_000:20_000].mean() == pytest.approx(0.8 * angle - angle / 5, abs=STANDS_RAD)
    # It slips at half the hand's force: G theta = R_p (F_a - F).
    assert column[-1000:].mean() == pytest.approx(-0.5 * angle, abs=STANDS_RAD)
    assert found["added_force_n"][-1] == pytest.approx(0.5 * force, rel=1e-6)  # single precision
    assert not found["trips"].any()  # being driven back is no runaway
    # No step: what a packet changes takes as long as packets are apart.
    assert np.abs(np.diff(found["added_force_n"])).max() < 1.001 * 9.5 * force / APART


def test_trim_and_added_force_move_the_column_to_where_the_spring_holds_them():
    loader = ff.digital_elevator()
    found = guided(loader, [(0, ACTIVE, {"trim": 0.03, "added_force": 40.0})])
    expected = 0.03 + 40.0 * loader["column.grip_arm"] / loader["feel.stiffness"]
    assert found["column_angle_rad"][-1000:].mean() == pytest.approx(expected, abs=STANDS_RAD)
