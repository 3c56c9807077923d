"""The part of a law for contact: quiet against a stop and a clamp, where the law alone swings."""

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.errors import InputError

QUIET_RAD = np.radians(0.5)
"""Range of the column's angle in the last half second; damped, it creeps towards the stop."""


def _light() -> ff.Loader:
    """A light feel of little damping: 400 lb in/rad, 1.5 Hz, 0.15."""
    omega = 2 * np.pi * 1.5
    stiffness = 400 * 0.112985
    inertia = stiffness / omega**2
    feel = {"feel.stiffness": stiffness, "feel.inertia": inertia, "feel.damping": 2 * 0.15 * omega * inertia}
    return ff.digital_elevator().replace(feel, si=True)


def _range_at_the_end(loader: ff.Loader, law: ff.Law, force: str) -> float:
    history = ff.simulate(loader, ff.Scenario(ff.Step(force), duration_s=8.0), law).history
    return float(np.ptp(history["column_angle_rad"].to_numpy()[-500:]))


@pytest.mark.parametrize("clamped", [False, True])
def test_a_light_feel_is_quiet_against_a_stop_and_in_a_clamp(clamped: bool) -> None:
    loader = _light()
    law = ff.Law.of("robust", loader)
    held = (
        {"pilot.arm_stiffness": 1e5, "pilot.arm_damping": 300.0} if clamped else {"column.stop_high": np.radians(5.0)}
    )
    there = loader.replace(held, si=True)
    assert _range_at_the_end(there, law, "1.8 lb") > 5 * QUIET_RAD
    assert _range_at_the_end(there, law.with_contact(loader), "1.8 lb") < QUIET_RAD


def test_a_free_release_is_the_same_with_and_without_it() -> None:
    loader = ff.digital_elevator()
    law = ff.Law.of("robust", loader)
    runs = [
        ff.simulate(loader, ff.Scenario(ff.Release(0.17), duration_s=2.0), given).history["column_angle_rad"]
        for given in (law, law.with_contact(loader))
    ]
    np.testing.assert_array_equal(*runs)


def test_a_law_file_keeps_it(tmp_path: object) -> None:
    loader = ff.digital_elevator()
    law = ff.Law.of("robust", loader).with_contact(loader)
    path = f"{tmp_path}/law.json"
    law.save(path)
    np.testing.assert_array_equal(ff.Law.of(path, loader).sampled.contact, law.sampled.contact)


def test_a_law_of_gains_has_none() -> None:
    loader = ff.elevator()
    with pytest.raises(InputError, match="original has no part for contact"):
        ff.Law.of("original", loader).with_contact(loader)


@pytest.mark.parametrize("name", ["torque-mode", "load-cell"])
def test_a_law_that_estimates_no_hand_from_the_load_cell_has_none(name: str) -> None:
    loader = ff.loader.electric("elevator-electric")
    with pytest.raises(InputError, match=f"{name} has no part for contact"):
        ff.Law.of(name, loader).with_contact(loader)
