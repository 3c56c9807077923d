"""Identifications made by hand, for the tests of what is said and shown of them."""

import re
from dataclasses import replace

import numpy as np

import forcefeel as ff
from forcefeel.bench.experiments import Drive, Experiment, Loop
from forcefeel.bench.identification.result import (
    Advice,
    Ended,
    Estimate,
    Fitted,
    Identification,
    Inseparable,
    RigidTest,
    Status,
)
from forcefeel.bench.identification.unknowns import parameter_keys, unknowns_of
from forcefeel.bench.records import BenchRecord
from forcefeel.bench.responses import Response
from forcefeel.loader.tolerances import Distribution, Tolerance

LINES = 60
SAMPLES = 12_000
CLOSED = Experiment(Loop.SERVO_CLOSED)
SPIKE = 7_301
"""Sample at which a record has an extreme that no drawing may lose."""

QUANTILE = 1.98
"""Of Student's t, for the intervals."""


def estimate(loader, symbol, moved=0.0, error=0.01, status=Status.DETERMINED, share=None):
    """A parameter that moved by a share of the file's value, its standard error a share of it too."""
    (unknown,) = unknowns_of(loader, parameter_keys(symbol))
    value = unknown.nominal * (1 + moved)
    deviation = abs(unknown.nominal) * error
    half = QUANTILE * deviation
    own = half / abs(value) if share is None else share
    return Estimate(unknown, value, deviation, value - half, value + half, own, status)


def resonant(frequency_hz, resonance_hz, damping, gain=0.3):
    s = 1j * np.asarray(frequency_hz) / resonance_hz
    return gain / (s**2 + 2 * damping * s + 1)


def response_fitted(name="closed", stated=0.01, left=0.01, coherent=True):
    """A response whose file's model resonates at 12 Hz, where the bench does at 11 Hz."""
    random = np.random.default_rng(11)
    frequency = np.geomspace(0.5, 50, LINES)
    modeled = resonant(frequency, 11.0, 0.1)
    error = left * (random.standard_normal(LINES) + 1j * random.standard_normal(LINES))
    measured = modeled * np.exp(error)
    deviation = None if stated is None else np.full(LINES, stated)
    coherence = 1 - 0.2 * random.random(LINES) if coherent else None
    data = Response(
        name, CLOSED, "test_signal", "column_angle", frequency, measured, coherence, deviation, data_hash="ab" * 32
    )
    rms = float(np.sqrt(np.mean(np.abs(error) ** 2) / 2))
    return Fitted(data, "column_angle", frequency, measured, modeled, resonant(frequency, 12.0, 0.1), rms, left)


def record_fitted(name="release"):
    """A release with two channels and one spike in the column's angle."""
    random = np.random.default_rng(12)
    time = np.arange(SAMPLES) / 4000
    experiment = Experiment(Loop.LOADER, Drive.RELEASE)
    angle = 0.17 * np.exp(-1.5 * time) * np.cos(9 * time)
    noise = 2e-4 * random.standard_normal(SAMPLES)
    noise[SPIKE] = 0.05
    force = -300 * angle
    channels = {"column_angle": angle + noise, "load_cell_force": force + 3 * random.standard_normal(SAMPLES)}
    data = BenchRecord(name, experiment, time, channels, data_hash="cd" * 32)
    before = 0.17 * np.exp(-1.2 * time) * np.cos(9.5 * time)
    return (
        Fitted(data, "column_angle", time, channels["column_angle"], angle, before, float(noise.std()), 2e-4),
        Fitted(data, "load_cell_force", time, channels["load_cell_force"], force, -300 * before, 3.0, 3.0),
    )


def ends(estimates, same=(True, True, True)):
    """Starts of a search; the first at the file's values. One that is not the same place leaves 1.5 times as much."""
    nominal = np.array([one.unknown.nominal for one in estimates])
    value = np.array([one.value for one in estimates])
    return tuple(
        Ended(nominal * (1 + 0.1 * k), value if it else 1.2 * value, float(np.log(0.01 if it else 0.015)), same=it)
        for k, it in enumerate(same)
    )


NEEDED = RigidTest(True, 0.34, 0.0101, 6.6e4, 0.0, (2, 116), 812.0, 0.001)
"""A rigid link is out of the question."""

_PAIR = np.array([[1, 0.97], [0.97, 1]])


def correlation(count, size=0.3):
    """The first two at 0.97, the others at ``size``."""
    found = np.full((count, count), size) + (1 - size) * np.eye(count)
    found[:2, :2] = _PAIR[:count, :count]
    return found


def loader():
    """The elevator: k uniform within 20 %, C_i normal, B_c without a tolerance, J at 20 %."""
    given = ff.elevator().replace({"column.viscous_friction": "8 lb in s/rad"})
    nominal = given["valve.current_gain"]
    normal = Tolerance(
        Distribution.NORMAL, 0.7 * nominal, 1.3 * nominal, peak=nominal, deviation=0.05 * nominal, nominal=nominal
    )
    return given.with_tolerances({"valve.current_gain": normal})


def determined():
    """Five parameters, all determined; k and c hang together."""
    given = loader()
    found = (
        estimate(given, "k", -0.12, 0.004),
        estimate(given, "c", 0.155, 0.02),
        estimate(given, "C_i", 0.11, 0.011, share=0.06),
        estimate(given, "B_c", 0.001, 0.09),
        estimate(given, "J", 0.2, 0.013),
    )
    values = {one.unknown.key: one.value for one in found}
    after = given.with_tolerances(dict.fromkeys(set(values) & set(given.tolerances))).replace(values, si=True)
    return Identification(
        before=given,
        estimates=found,
        correlation=correlation(len(found)),
        fitted=(response_fitted(), *record_fitted()),
        ends=ends(found),
        inseparable=(),
        advice=(),
        rigid=NEEDED,
        notes=(),
        loader=after,
    )


def bounded():
    """The same, but J ended at its bound: there is no loader file."""
    found = determined()
    *others, inertia = found.estimates
    return replace(found, estimates=(*others, replace(inertia, status=Status.AT_BOUND)), loader=None)


SECRET = 0.137
"""How far the undetermined values lie from the file's; no number of them may be said."""

_SECRETS = re.compile(r"(?<![\d.])(6\.19[67]|6\.20|1\.346|1\.35 |101\.5|102 )")
"""C_i and K_2 off 5.45 in^3/(s mA), 89.31 cm^3/(s mA) and 1.56 mA/V."""


def secrets_in(text):
    """Numbers of the undetermined values that a text holds."""
    return _SECRETS.findall(text)


def undetermined():
    """C_i and K_2, of which the data see the product alone; k is determined. A model error, and a start that went astray."""
    given = ff.elevator()
    found = (
        estimate(given, "C_i", SECRET, 3.0, Status.UNDETERMINED, share=np.inf),
        estimate(given, "K_2", -SECRET, 3.0, Status.UNDETERMINED, share=np.inf),
        estimate(given, "k", 0.05, 0.02),
    )
    keys = [one.unknown.key for one in found]
    advice = Advice(
        "Measure the response from test_signal to valve_current (servo-closed): with 1 % of noise a line it would give C_i "
        "to ±1.2 %, K_2 to ±0.9 %, k to ±1.5 %.",
        dict(zip(keys, (0.012, 0.009, 0.015), strict=True)),
    )
    return Identification(
        before=given,
        estimates=found,
        correlation=np.array([[1, np.nan, 0.1], [np.nan, 1, 0.2], [0.1, 0.2, 1]]),
        fitted=(response_fitted(stated=0.01, left=0.05, coherent=False),),
        ends=ends(found, (True, True, False)),
        inseparable=(
            Inseparable(
                tuple(keys[:2]),
                (1.0, -1.0),
                "The data cannot tell C_i from K_2: only their product C_i K_2 is determined.",
            ),
        ),
        advice=(advice,),
        rigid=None,
        notes=(
            "Whether the link is compliant was not judged: there is no rigid model of a loader under a digital controller.",
        ),
    )
