"""The force sensor at the grip, from records of the bench's own machine, which shares no line with the engine."""

from dataclasses import replace

import bench_machine
import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import forcefeel as ff
from forcefeel.bench.experiments import Experiment
from forcefeel.bench.identification.grip_sensor import GAIN, MASS, OFFSET, find_grip_sensor
from forcefeel.bench.records import BenchRecord
from forcefeel.commission.identified import identify_loader
from forcefeel.commission.plan import CommissionPlan
from tests.parametrization import mostly_slow

RATE_HZ, SAMPLES, PERIOD_S = 1000.0, 4000, 5e-4
TRUE = {GAIN: 1.06, MASS: 0.4, OFFSET: -0.7}
NOISE_N, STEP_N = 0.05, 0.02
BESIDE = "is neither the hand's recorded force nor that of the mass"
SURE = 4.0
"""Standard errors; the noise has one seed."""
NOISE_WITHIN = 0.2
"""Of the declared noise: steps, and an acceleration from a spline, come on top."""
OFFSET_WITHIN = 0.05
"""Of the offset: k alone is fitted there."""
WITHIN = 2e-3
"""Of the value; the motion is the engine's own, in steps of half a millisecond."""


@pytest.fixture(scope="module")
def loader():
    rows = {GAIN: 1.0, MASS: 0.3, "grip_sensor.noise": NOISE_N, "grip_sensor.resolution": STEP_N}
    return ff.elevator().replace({"controller.period": PERIOD_S, "controller.delay": PERIOD_S} | rows, si=True)


def recorded(experiment, size, crossed=(0.0, 0.0), **drive):
    """A record of the report's loader with the sensor at its grip, by the equation of the sensor's own head."""
    time_s = np.arange(SAMPLES) / RATE_HZ
    random = np.random.default_rng(5)
    lines = np.geomspace(0.5, 25.0, 30)
    signal = (
        size * np.sin(2 * np.pi * (np.outer(time_s, lines) + random.random(30))).sum(axis=1) * np.clip(time_s, 0, 1)
    )
    under = Experiment.read(experiment)
    ((channel, given),) = drive.items()
    force = channel == "pilot_force"
    cross_talk, friction_lb = crossed
    machine = bench_machine.Machine(coulomb_friction=friction_lb, static_friction=friction_lb)
    found = bench_machine.run(
        machine,
        str(under.loop),
        RATE_HZ,
        controller=bench_machine.Controller(PERIOD_S, delay=1),
        **{given: signal / bench_machine.LBF if force else signal},
    )
    angle, rate = found["column_angle"][0], found["column_velocity"][0]
    hand = signal if force else 0.0
    arm = 31.375 * bench_machine.INCH
    shown = TRUE[GAIN] * (hand - TRUE[MASS] * arm * CubicSpline(time_s, rate)(time_s, 1)) + TRUE[OFFSET]
    link = found["load_cell_force"][0] * bench_machine.LBF
    shown = shown + cross_talk * machine.ratio * machine.base_arm / machine.grip_arm * link
    shown = np.round((shown + NOISE_N * random.standard_normal(SAMPLES)) / STEP_N) * STEP_N
    return BenchRecord("bench", under, time_s, {channel: signal, "column_angle": angle, "grip_force": shown})


@pytest.fixture(scope="module")
def shaken():
    return recorded("servo-closed", 0.08, test_signal="test_signal")


def noise(seed):
    return NOISE_N * np.random.default_rng(seed).standard_normal(SAMPLES)


def in_place_of(record, signal):
    return replace(record, channels={**record.channels, "grip_force": signal})


def test_hands_off_record_identifies_mass_and_offset(loader, shaken):
    found = find_grip_sensor(loader, [shaken], None)
    assert found.wrong == found.notes == ()
    assert set(found.rows) == {MASS, OFFSET}
    told = {MASS: TRUE[GAIN] * TRUE[MASS] / loader[GAIN], OFFSET: TRUE[OFFSET]}
    for key, (value, deviation) in found.rows.items():
        assert abs(value - told[key]) < SURE * deviation + WITHIN * abs(told[key])
    assert found.noise == pytest.approx(NOISE_N, rel=NOISE_WITHIN)
    assert "weight or a spring balance" in found.advice[0]  # which tells the gain


@pytest.mark.slow
def test_measured_hand_force_identifies_the_gain(loader):
    pulled = recorded("loader pilot_force", 6.0, pilot_force="force")
    found = find_grip_sensor(loader, [pulled], None)
    assert (found.wrong, found.advice) == ((), ())
    assert set(found.rows) == {GAIN, MASS, OFFSET}
    for key, (value, deviation) in found.rows.items():
        assert abs(value - TRUE[key]) < SURE * deviation + WITHIN * abs(TRUE[key])
    in_pounds = in_place_of(pulled, pulled.channels["grip_force"] / bench_machine.LBF)
    (wrong, *_) = find_grip_sensor(loader, [in_pounds], None).wrong
    assert "shows 0.24 times as much of the hand's force as the file predicts: check its unit" in wrong


@pytest.mark.parametrize(("cross_talk", "friction_lb"), mostly_slow([(0.02, 1.0), (0.01, 0.0), (-0.03, 0.0)]))
def test_cross_talk_of_the_links_force_is_identified_as_gain_and_mass(loader, cross_talk, friction_lb):
    """``K_g - c`` and ``K_g m_o - c J / R_p^2``; dry friction adds a share of it to the residual."""
    rubs = dict.fromkeys(("column.coulomb_friction", "column.static_friction"), f"{friction_lb} lb")
    known = loader.replace(rubs) if friction_lb else loader
    pulled = recorded("loader pilot_force", 6.0, (cross_talk, friction_lb), pilot_force="force")
    found = find_grip_sensor(known, [pulled], None)
    assert found.wrong == ()
    gain = TRUE[GAIN] - cross_talk
    mass = (TRUE[GAIN] * TRUE[MASS] - cross_talk * loader["column.inertia"] / loader["column.grip_arm"] ** 2) / gain
    for key, told in {GAIN: gain, MASS: mass, OFFSET: TRUE[OFFSET]}.items():
        value, deviation = found.rows[key]
        assert abs(value - told) < SURE * deviation + WITHIN * abs(told)
    rubbed = abs(cross_talk) * friction_lb * bench_machine.LBF
    assert found.noise == pytest.approx(np.hypot(NOISE_N, rubbed), rel=NOISE_WITHIN)


@pytest.mark.parametrize(
    ("seen", "sentence"),
    [
        (lambda shown: noise(3), "shows nothing of the force of the mass"),
        (lambda shown: noise(16), "shows nothing of the force of the mass"),  # by chance 3.7 deviations of nothing
        (lambda shown: np.where(np.arange(SAMPLES) % 1000 < 200, TRUE[OFFSET], shown), BESIDE),
        (lambda shown: np.clip(shown, -0.2 * np.ptp(shown), 0.2 * np.ptp(shown)) + noise(4), BESIDE),
        (lambda shown: np.full(SAMPLES, 1.5), "shows 0.337 lb from the first sample to the last"),
        (lambda shown: -shown, "with the wrong sign"),
        (lambda shown: shown / bench_machine.LBF**2, "0.071 times as much of the force of the mass"),
        (lambda shown: np.clip(shown, -0.5 * np.ptp(shown), 0.2 * np.ptp(shown)), "is clipped at"),
    ],
    ids=[
        "sees-nothing",
        "but-by-chance",
        "drops-out",
        "cut-off-ahead-of-noise",
        "stuck",
        "reversed",
        "too-little",
        "clipped",
    ],
)
def test_inactive_or_inconsistent_grip_sensor_is_reported(loader, shaken, seen, sentence):
    found = find_grip_sensor(loader, [in_place_of(shaken, seen(shaken.channels["grip_force"]))], None)
    assert found.rows == {}
    assert sentence in found.wrong[0]


def test_inactive_grip_sensor_rejects_the_law(loader, shaken):
    quick, blind = CommissionPlan(fit=("k",)), in_place_of(shaken, 0.0 * shaken.time_s)
    stated = loader.with_tolerances({GAIN: "5 %", MASS: "20 %"})
    good, bad = (identify_loader(stated, [one], quick) for one in (shaken, blind))
    assert good.loader is not None
    assert good.loader.tolerances[GAIN] == stated.tolerances[GAIN]  # hands off nothing shows it
    assert good.loader.tolerances[MASS].deviation < 1e-2 * good.loader[MASS]
    assert good.loader[OFFSET] == pytest.approx(TRUE[OFFSET], rel=OFFSET_WITHIN)
    assert {MASS, OFFSET} <= {one.key for one in good.outcome.parameters}
    (wanting,) = (one for one in bad.outcome.wanting if "grip_force" in one)
    assert "stuck" in wanting
    assert not bad.outcome.ok


def test_missing_grip_sensor_data_is_reported(loader, shaken):
    without = replace(shaken, channels={name: it for name, it in shaken.channels.items() if name != "grip_force"})
    (said,) = find_grip_sensor(loader, [without], None).notes
    assert "No record holds grip_force" in said
    (said,) = find_grip_sensor(ff.elevator(), [shaken], None).notes
    assert "the loader file has no grip_sensor" in said
    assert find_grip_sensor(ff.elevator(), [without], None).notes == ()
