"""A column on a shaft is not taken for one that strikes a stop: the other column pushes it while it turns."""

from dataclasses import replace

import numpy as np
import pytest

import forcefeel as ff
from forcefeel import _core
from forcefeel.loader.arms import ARM_ROWS, ARMS, Arm
from tests.linked.pairs import project

OFF_RAD = np.radians(0.3)
"""Of a pair of perfect loaders; a law that takes the shaft for a stop was 1.5 to 4 deg off."""

RELEASE_RAD, DURATION_S = np.radians(10.0), 4.0


@pytest.mark.parametrize(
    "feel", [(1.167, 4.93, 32.54), (2.93, 12.37, 81.67), (6.526, 11.6, 515.75), (3.3, 2.07, 32.54)], ids=str
)
def test_released_pair_with_a_firm_arm_on_one_side_follows_two_perfect_loaders(feel):
    """The first column free, an arm at the second: settings that failed as the law took a push over the shaft for contact."""
    axes = project("transport-column")
    link = axes.links["pitch"]
    own = axes.loaders["pitch"].replace(
        dict(zip(("feel.inertia", "feel.damping", "feel.stiffness"), feel, strict=True)), si=True
    )
    held = own.replace(dict(zip(ARM_ROWS, ARMS[Arm.FIRM], strict=True)), si=True)
    axes = replace(axes, loaders={"pitch": own, "pitch-first-officer": held})
    release = ff.Release(RELEASE_RAD)
    both = ff.linked.LinkedScenario(ff.Scenario(release, DURATION_S), release)
    run = ff.linked.simulate_linked(axes, "pitch", both, "robust")
    arm = np.array(ARMS[Arm.FIRM]) * own["column.grip_arm"] ** 2
    rows = np.array([feel]), np.array([feel]) + arm
    samples = len(run.history["time_s"])
    ideal = _core.linked_feels(*rows, link.values, (RELEASE_RAD, 1e-3), samples)[0]
    for side, expected in zip(("first", "second"), ideal, strict=True):
        assert np.abs(run.history[f"{side}_column_angle_rad"].to_numpy() - expected).max() < OFF_RAD
