"""A loader is the same wherever it stands: what a law does about a trimmed neutral is what it does about zero, moved."""

from math import radians

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.laws.sampled.law_designs import LAW_DESIGNS
from forcefeel.loader.built_in import open_loader
from forcefeel.loader.parameters import TABLE
from forcefeel.simulation import HandsOff, Release, Schedule

TRIM = radians(4.0)
WITH_SENSOR = {"grip_sensor.gain": 1.0, "grip_sensor.noise": "0.05 lb"}
# Without what differs from place to place: stops, converters' steps, noise.
SMOOTH = {f"{sensor}.noise": None for sensor in ("load_cell", "potentiometer", "column_sensor", "grip_sensor")}
SAME = 1e-9  # rad, of a motion of a tenth: sums in another order
SECONDS = 0.6


def smooth(name):
    loader = open_loader(name).replace(WITH_SENSOR, si=True)
    steps = {key: None for key in TABLE if key.endswith(".resolution")}
    return loader.replace({**SMOOTH, **steps}, si=True)


def moved(loader, method, scenario_of):
    """The column's angle about zero, and about the trim."""
    law = ff.Law.of(method, loader)
    return [
        ff.simulate(loader, scenario_of(trim), law).history["column_angle_rad"].to_numpy() - trim
        for trim in (0.0, TRIM)
    ]


CASES = [
    (name, method.name)
    for name in ("elevator-2khz", "elevator-electric", "sidestick-pitch")
    for method in LAW_DESIGNS.values()
    if method.serves(smooth(name))
]


@pytest.mark.parametrize(("name", "method"), CASES)
def test_release_about_trimmed_neutral_is_the_shifted_release(name, method):
    def scenario(trim):
        return ff.Scenario(Release(trim + radians(5.0), start_s=0.1), SECONDS, trim_rad=Schedule((0.0,), (trim,)))

    about_zero, about_trim = moved(smooth(name), method, scenario)
    assert np.ptp(about_zero) > radians(2.0)
    np.testing.assert_allclose(about_trim, about_zero, rtol=0, atol=SAME)


@pytest.mark.parametrize("name", ["elevator-2khz", "elevator-electric"])
def test_trimmed_column_settles_at_its_neutral(name):
    scenario = ff.Scenario(HandsOff(), 6.0, trim_rad=Schedule((0.0, 0.5, 1.5), (0.0, 0.0, TRIM)))
    angle = ff.simulate(smooth(name), scenario, "robust").history["column_angle_rad"].to_numpy()
    assert angle[-1] == pytest.approx(TRIM, rel=1e-3)  # what is left of the motion after 4.5 s
