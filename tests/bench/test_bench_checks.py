"""What is wrong with bench data: every fault is found, clean data of many kinds pass; a response far from its prediction."""

from dataclasses import replace

import control
import numpy as np
import pytest
import scipy.signal

import forcefeel as ff
from forcefeel.bench.clipping import clipped
from forcefeel.bench.experiments import Experiment
from forcefeel.bench.plausibility import distance, misreading
from forcefeel.bench.record_checks import check_record
from forcefeel.bench.records import BenchRecord
from forcefeel.bench.response_checks import check_response
from forcefeel.bench.responses import Response
from forcefeel.errors import InputError
from forcefeel.loader.parameters import HYDRAULIC, TABLE, limits_si, required
from forcefeel.units import factor
from tests.parametrization import mostly_slow

CLOSED = Experiment.read("servo-closed")
RELEASE = Experiment.read("servo-closed release")
H = 1e-3  # s
T = np.arange(6000) * H
BEGIN = 300  # samples at rest before the drive begins
REST = np.arange(len(T)) < BEGIN

ELEVATOR = ff.elevator()
SERVO = ff.linear.servo(ELEVATOR, ff.linear.Linkage.COMPLIANT, closed=True)


def shifted(values):
    """The same, after the rest."""
    return np.r_[np.zeros(BEGIN), values[:-BEGIN]]


def multisine():
    lines = tuple((np.arange(1, 25) / 2).tolist())
    sample = ff.simulation.Multisine(1.0, lines, 2.0, seed=3).sample(6.0, H)
    return shifted(sample.start)


DRIVES = {
    "multisine": multisine(),
    "chirp": shifted(scipy.signal.chirp(T, 0.3, 6.0, 15.0, method="log", phi=-90)),
    "square": shifted(scipy.signal.square(2 * np.pi * 0.7 * T)),
    "doublet": np.where((T > 1) & (T < 1.5), 1.0, np.where((T >= 1.5) & (T < 2), -1.0, 0.0)),
    "step": np.where(T > 1, 1.0, 0.0),
    "three steps": np.floor(4 * T / 6.001) / 4,
    "noise": shifted(
        scipy.signal.lfilter(*scipy.signal.butter(2, 40, fs=1 / H), np.random.default_rng(5).standard_normal(len(T)))
    ),
    "binary": shifted(np.repeat(np.random.default_rng(6).choice([-1.0, 1.0], 300), 20)),
    "slow staircase": np.repeat(multisine()[::8], 8),  # sent at 125 Hz, recorded at 1 kHz
}


def answer(drive):
    """Angle and potentiometer of the closed servo, and the valve's current, K_2 (e - potentiometer) by eq. (13)."""
    potentiometer, angle = control.forced_response(SERVO, T, drive).outputs
    current = ELEVATOR["amplifier.admittance"] * (drive - potentiometer)
    return {"test_signal": drive, "column_angle": angle, "potentiometer": potentiometer, "valve_current": current}


ANSWERS = {name: answer(drive) for name, drive in DRIVES.items()}


def record(channels=None, time=T, experiment=CLOSED, **changes):
    return BenchRecord("bench", experiment, time, {**(channels or ANSWERS["multisine"]), **changes})


def rounded(values, bits):
    step = 2.2 * np.max(np.abs(values)) / 2**bits
    return np.round(values / step) * step


@pytest.mark.parametrize("kind", ANSWERS)
@pytest.mark.parametrize("bits", [8, 12, 16, None])
def test_clean_records_pass(kind, bits):
    channels = {name: rounded(values, bits) if bits else values for name, values in ANSWERS[kind].items()}
    check_record(record(channels))


@pytest.mark.parametrize("kind", ANSWERS)
@pytest.mark.parametrize("seed", range(3))
def test_noisy_records_pass(kind, seed):
    rng = np.random.default_rng(seed)
    noisy = {it: values + 0.01 * np.std(values) * rng.standard_normal(len(T)) for it, values in ANSWERS[kind].items()}
    check_record(record({it: rounded(values, 12) for it, values in noisy.items()}))


@pytest.mark.parametrize("kind", ["multisine", "chirp", "noise", "slow staircase"])
@pytest.mark.parametrize("bits", [10, 16, None])
@pytest.mark.parametrize("side", [-1, 1])
def test_clipped_channel_is_detected(kind, bits, side):
    angle = ANSWERS[kind]["column_angle"]
    limit = 0.7 * np.max(side * angle)
    cut = side * np.minimum(side * angle, limit)
    with pytest.raises(
        InputError, match=r"bench: column_angle is clipped at -?0\.\d+ rad from \d\.\d+ s to \d\.\d+ s; expected"
    ):
        check_record(record(ANSWERS[kind], column_angle=rounded(cut, bits) if bits else cut))


def test_current_at_its_limit_is_detected():
    chirp = ANSWERS["chirp"]
    with pytest.raises(InputError, match="valve_current is clipped"):
        check_record(record(chirp, valve_current=np.clip(chirp["valve_current"], -1e-3, 1e-3)))


def test_clipping_location_is_reported():
    wave = np.minimum(np.sin(2 * np.pi * T), 0.9)
    found = clipped(wave)
    first = np.flatnonzero(wave == 0.9)[0]
    assert (found.begin, found.end) == (first, first + np.argmax(wave[first:] != 0.9))
    assert clipped(np.sin(2 * np.pi * T)) is None


def with_sample(values, at, value):
    return np.r_[values[:at], value, values[at + 1 :]]


DRIVE, ANGLE = DRIVES["multisine"], ANSWERS["multisine"]["column_angle"]
FLICKER = 0.3e-3 * np.random.default_rng(1).integers(7, 9, len(T))
FAULTS = {
    "not a number": (record(column_angle=with_sample(ANGLE, 10, np.nan)), r"bench: row 11: expected finite numbers"),
    "backwards": (record(time=with_sample(T, 10, 0.0)), "bench: row 11: time runs backwards"),
    "gap": (record(time=T + (T > 1)), r"bench: row 1\d\d\d: a gap of 1\.001 s after 1"),
    "lengths": (record(column_angle=ANGLE[:-1]), "expected column_angle at each of the times"),
    "short": (
        record({it: x[:99] for it, x in ANSWERS["multisine"].items()}, T[:99]),
        "has 99 samples; expected at least 100",
    ),
    "in ms": (record(time=1000 * T), r"^bench: time: has a median step of 1 s; .* is the time in ms\?"),
    "in s": (record(time=T / 1000), r"^bench: time: has a median step of 1e-06 s; .* is the time in s, not in ms\?"),
    "still drive": (record(test_signal=np.full(len(T), 0.2)), "test_signal never moves from 0.2 V"),
    "flicker": (record(test_signal=FLICKER), r"test_signal moves by 0\.0003 V, which is no more than the resolution"),
    "dead channel": (record(column_angle=np.full(len(T), 0.2)), r"column_angle never moves from 0\.2 rad"),
    "one step": (
        record(column_angle=np.where(T == 3, 0.001, 0.0)),
        "column_angle never moves from 0 rad by more than one step",
    ),
    "no drive": (record({"column_angle": ANGLE}), "has no test_signal, which drives servo-closed test_signal"),
}


@pytest.mark.parametrize("step_s", [1e-5, 0.2])
def test_shortest_and_longest_steps_pass(step_s):
    check_record(record(time=T / H * step_s))


@pytest.mark.parametrize(("given", "message"), FAULTS.values(), ids=FAULTS)
def test_invalid_record_raises_input_error(given, message):
    with pytest.raises(InputError, match=message):
        check_record(given)


def test_error_names_file_and_line():
    places = [f"run.csv: line {i + 3}" for i in range(len(T) + 1)]
    with pytest.raises(InputError, match=r"^run\.csv: line 14: expected finite"):
        check_record(FAULTS["not a number"][0], places)
    with pytest.raises(InputError, match=r"^run\.csv: test_signal never moves"):
        check_record(FAULTS["still drive"][0], places)


# Cut out of a steady motion; not where drive or column happen to turn, as from rest.
@pytest.mark.parametrize("cut", [700, 1100, 1500, 1800, 2500])
def test_record_that_begins_in_motion_is_refused(cut):
    channels = {it: values[cut:] for it, values in ANSWERS["multisine"].items()}
    assert abs(channels["test_signal"][0]) > 0.05
    with pytest.raises(InputError, match=r"does not begin at rest: .* start to record before the drive begins"):
        check_record(record(channels, T[cut:]))


def test_loader_oscillating_before_the_drive_starts_is_refused():
    swing = np.where(REST, 0.5 * np.max(ANGLE) * np.sin(2 * np.pi * 3 * T), ANGLE)
    with pytest.raises(InputError, match="does not begin at rest: column_angle moves"):
        check_record(record(column_angle=swing))


@pytest.mark.parametrize("kind", ["multisine", "chirp", "noise", "binary"])
def test_drive_that_starts_with_the_record_passes(kind):
    drive = np.r_[DRIVES[kind][BEGIN:], np.zeros(BEGIN)]
    check_record(record(answer(drive)))


def let_go(at=500, frequency=2.0, damping=0.15):
    t = np.maximum(T - T[at], 0)
    w = 2 * np.pi * frequency
    pole = w * (-damping + 1j * np.sqrt(1 - damping**2))
    return 0.2 * np.real((1 - 1j * pole.real / pole.imag * -1) * np.exp(pole * t))


@pytest.mark.parametrize("bits", [12, 16, None])
@pytest.mark.parametrize("noise", [0.0, 0.002])
def test_releases_pass(bits, noise):
    angle = let_go() + 0.2 * noise * np.random.default_rng(0).standard_normal(len(T))
    check_record(record({"column_angle": rounded(angle, bits) if bits else angle}, experiment=RELEASE))


RELEASE_FAULTS = {
    "never let go": (np.where(T > 100, 0.0, 0.2) + 1e-4 * np.sin(9 * T), "has no release|moves before"),
    "moving before": (
        let_go() + np.where(T < 0.5, 0.05 * np.sin(20 * T), 0.0),
        "moves before it is let go|has no release",
    ),
    "in flight": (let_go(0)[60:], "column_angle moves before it is let go"),
    "clipped": (np.maximum(let_go(), -0.05), "is clipped at"),
}


@pytest.mark.parametrize(("angle", "message"), RELEASE_FAULTS.values(), ids=RELEASE_FAULTS)
def test_invalid_release_raises_input_error(angle, message):
    with pytest.raises(InputError, match=message):
        check_record(record({"column_angle": angle}, T[: len(angle)], RELEASE))


LINES_HZ = np.geomspace(0.2, 40, 60)
GOOD = Response("line", CLOSED, "test_signal", "potentiometer", LINES_HZ, SERVO(2j * np.pi * LINES_HZ)[0, 0])
ONES = np.ones(60)
RESPONSE_FAULTS = {
    "two lines": ({"frequency_hz": LINES_HZ[:2], "value": GOOD.value[:2]}, "has 2 lines; expected 3 at least"),
    "lengths": ({"value": GOOD.value[:-1]}, "expected value at each of"),
    "coherence length": ({"coherence": ONES[:9]}, "expected coherence at each of"),
    "not a number": ({"value": with_sample(GOOD.value, 4, np.nan)}, "line 5: expected finite numbers"),
    "zero frequency": (
        {"frequency_hz": with_sample(LINES_HZ, 0, 0.0)},
        "line 1: the frequency is 0 Hz; expected one above 0",
    ),
    "negative": ({"frequency_hz": -LINES_HZ}, r"line 1: the frequency is -0\.2 Hz"),
    "negative later": ({"frequency_hz": with_sample(LINES_HZ, 4, -1.0)}, "line 5: the frequency is -1 Hz"),
    "twice": (
        {"frequency_hz": with_sample(LINES_HZ, 4, LINES_HZ[3])},
        r"line 5: the frequency of 0\.2\d* Hz is there twice",
    ),
    "unsorted": (
        {"frequency_hz": with_sample(LINES_HZ, 4, 0.21)},
        r"line 5: the frequency falls from 0\.26\d* Hz to 0\.21 Hz",
    ),
    "no gain": ({"value": with_sample(GOOD.value, 4, 0.0)}, "line 5: the gain is zero"),
    "percent": ({"coherence": 90 * ONES}, r"line 1: the coherence is 90; expected 0 to 1; is it in percent\?"),
    "incoherent": ({"coherence": 0.29 * ONES}, r"line: the coherence is 0\.29 at best; expected 0\.3"),
    "deviation": ({"deviation": with_sample(ONES, 4, 0.0)}, "line 5: the deviation is 0; expected a share above 0"),
}


@pytest.mark.parametrize(("changes", "message"), RESPONSE_FAULTS.values(), ids=RESPONSE_FAULTS)
def test_invalid_response_raises_input_error(changes, message):
    check_response(GOOD)
    check_response(replace(GOOD, coherence=with_sample(0.1 * ONES, 4, 0.31), deviation=ONES))
    with pytest.raises(InputError, match=message):
        check_response(replace(GOOD, **changes))


# What the linear models depend on.
KEYS = [key for key in required(HYDRAULIC) if key != "pilot.force"]
ENDS = [
    ("servo-open", "potentiometer", 0),
    ("servo-open", "column_angle", 1),
    ("servo-closed", "potentiometer", 0),
    ("servo-closed", "column_angle", 1),
    ("loader", "column_angle", 0),
    ("loader", "piston_position", 2),
    ("loader", "load_cell_force", 3),
    ("loader", "valve_current", 5),
    ("loader", "actuator_flow", 6),
]


def predictions(loader, lines_hz=LINES_HZ):
    """Responses of a loader, by python-control from its model's matrices."""
    models = {
        "servo-open": ff.linear.servo(loader, ff.linear.Linkage.COMPLIANT, closed=False),
        "servo-closed": ff.linear.servo(loader, ff.linear.Linkage.COMPLIANT, closed=True),
        "loader": ff.compliant_model(loader),
    }
    values = {name: model(2j * np.pi * lines_hz) for name, model in models.items()}
    return {(name, output): values[name][row, 0] for name, output, row in ENDS}


def off_by(rng, share):
    changes = {key: ELEVATOR[key] * rng.uniform(1 - share, 1 + share) for key in KEYS}
    return ELEVATOR.replace(
        {key: float(np.clip(value, *limits_si(TABLE[key]))) for key, value in changes.items()}, si=True
    )


def as_response(key, value, lines_hz=LINES_HZ):
    experiment = Experiment.read(key[0])
    return Response("mine", experiment, str(experiment.drive), key[1], lines_hz, value)


@pytest.mark.slow
def test_parameter_deviation_is_not_reported_as_misreading():
    expected, rng = predictions(ELEVATOR), np.random.default_rng(0)
    for _ in range(200):
        for key, value in predictions(off_by(rng, 0.4)).items():
            assert misreading(as_response(key, value), expected[key]) is None


def polar(gain, phase):
    return gain * np.exp(1j * phase)


# What comes of a file that is read in a wrong way: gain and phase as the file has them, the sentence.
MISREADINGS = {
    "radians": (lambda r, phase: polar(r, np.radians(phase)), "in radians, read as degrees"),
    "degrees": (lambda r, phase: polar(r, np.degrees(np.unwrap(phase))), "in degrees, read as radians"),
    "polarity": (lambda r, phase: polar(r, phase + np.pi), "polarity seems reversed"),
    "inverse": (lambda r, phase: polar(1 / r, -phase), "exchange from and to"),
    "ratio": (lambda r, phase: polar(10 ** (r / 20), phase), "a ratio, read as dB"),
}
UNITS = {
    "column_angle": "deg",
    "piston_position": "in",
    "load_cell_force": "lb",
    "valve_current": "mA",
    "actuator_flow": "in^3/s",
}
SI = {
    "column_angle": "rad",
    "piston_position": "m",
    "load_cell_force": "N",
    "valve_current": "A",
    "actuator_flow": "m^3/s",
}


def unit_of(key):
    """SI value of one of the file's units."""
    start = 1.0 if key[0] != "loader" else factor("lb", "N")
    return (factor(UNITS[key[1]], SI[key[1]]) if key[1] in UNITS else 1.0) / start


@pytest.fixture(scope="module")
def others():
    """Responses of machines within 20 % of the file's."""
    rng = np.random.default_rng(1)
    return [predictions(off_by(rng, 0.2)) for _ in range(40)]


@pytest.mark.parametrize("fault", mostly_slow(MISREADINGS))
def test_misread_file_is_detected(others, fault):
    misread, sentence = MISREADINGS[fault]
    expected, found = predictions(ELEVATOR), []
    for machine in others:
        for key, value in machine.items():
            ratio = np.abs(value) / unit_of(key)
            if np.ptp(np.log(np.abs(expected[key]))) < np.log(10) and fault in {"inverse", "ratio"}:
                continue  # flat: what was read is as near as what was meant
            said = misreading(as_response(key, misread(ratio, np.angle(value)) * unit_of(key)), expected[key])
            assert said is None or sentence in said, (key, said)
            found.append(said is not None)
    assert len(found) >= 200
    # Of one in ten at most the machine itself is so far off that nothing stands out; never is another thing named.
    assert np.mean(found) > 0.9


def test_decibels_read_as_ratio_are_detected():
    key = ("servo-closed", "potentiometer")
    value = predictions(ELEVATOR)[key]
    lines = np.abs(value) * 1000 > 1.5  # mV/V: dB above zero, which can be read as ratios
    decibels = 20 * np.log10(1000 * np.abs(value[lines]))
    response = as_response(key, polar(decibels / 1000, np.angle(value[lines])), LINES_HZ[lines])
    assert "in dB, read as a ratio" in misreading(response, value[lines])


@pytest.mark.parametrize(
    ("scale", "sentence"), mostly_slow([(2 * np.pi, "in rad/s, read as Hz"), (1 / (2 * np.pi), "in Hz, read as rad/s")])
)
def test_frequencies_in_the_wrong_unit_are_detected(scale, sentence):
    read_hz, rng, found = LINES_HZ * scale, np.random.default_rng(2), []
    expected = predictions(ELEVATOR, read_hz)
    for _ in range(20):
        for key, value in predictions(off_by(rng, 0.2)).items():
            if np.ptp(np.log(np.abs(expected[key]))) < np.log(10):
                continue
            said = misreading(as_response(key, value, read_hz), expected[key])
            assert said is None or sentence in said, (key, said)
            found.append(said is not None)
    assert len(found) >= 100
    assert np.mean(found) > 0.95  # as above


def test_distance_is_between_complex_logarithms():
    value = np.array([1.0, 2.0j, -3.0])
    assert distance(value, value) == 0
    assert distance(np.e * value, value) == pytest.approx(1, rel=1e-12)  # a few roundings
    assert distance(-value, value) == pytest.approx(np.pi, rel=1e-12)  # as above


@pytest.mark.parametrize(
    "predicted", [np.ones(3, dtype=complex), np.zeros(60, dtype=complex), np.full(60, np.nan + 0j)]
)
def test_invalid_predictions_raise_input_error(predicted):
    with pytest.raises(InputError, match="predicted: expected"):
        misreading(GOOD, predicted)


@pytest.mark.parametrize(
    "force", [ff.simulation.Chirp(60.0, 0.3, 4.0, 5.0), ff.simulation.Doublet(80.0, 0.5, 0.7), ff.Step(100.0, 0.5)]
)
def test_column_stopped_by_friction_is_not_reported_as_clipped(force):
    loader = ELEVATOR.replace({"column.coulomb_friction": "5 lb", "column.static_friction": "6 lb"})
    history = ff.simulate(loader, ff.Scenario(force, duration_s=6.0)).history
    time, pushed = history.time_s.values, history.pilot_force_n.values
    channels = {"pilot_force": pushed, "column_angle": history.column_angle_rad.values}
    stuck = np.diff(channels["column_angle"]) == 0
    assert np.count_nonzero(stuck) > 100  # it does stick
    check_record(record(channels, time, Experiment.read("loader")))


MACHINES = {
    "linear": ELEVATOR,
    "friction": ff.digital_elevator().replace({"column.coulomb_friction": "3 lb"}),
    "coarse sensors": ff.digital_elevator().replace(
        {"column_sensor.resolution": "0.05 deg", "potentiometer.resolution": "0.01 in"}
    ),
}


@pytest.mark.parametrize("kind", ["multisine", "square"])
@pytest.mark.parametrize("loader", MACHINES.values(), ids=MACHINES)
def test_records_of_the_simulated_machine_pass(loader, kind):
    drive = ff.simulation.Schedule(tuple(T.tolist()), tuple((0.5 * DRIVES[kind]).tolist()))
    law = ff.laws.GainLaw.position_loop(loader.si_values)
    scenario = ff.Scenario(ff.simulation.HandsOff(), duration_s=T[-1], step_s=H, test_signal_v=drive)
    history = ff.simulate(loader, scenario, law).history
    channels = {
        "column_angle": "column_angle_rad",
        "load_cell_force": "load_cell_force_n",
        "valve_current": "valve_current_a",
    }
    measured = {name: history[column].values for name, column in channels.items()}
    check_record(record({"test_signal": 0.5 * DRIVES[kind], **measured}))
