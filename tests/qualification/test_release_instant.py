"""The instant of a release, on every built-in loader under every law, and the curve that is drawn from it.

The reference here is the closed form of ``I theta'' + B theta' + G theta = 0`` from rest at the held angle, written out below.
"""

import math
from functools import cache

import numpy as np
import pytest

from forcefeel.laws.law import names_for
from forcefeel.loader.built_in import open_loader
from forcefeel.qualification import Outcome, Record, judge_release, load_rules, measure_release
from forcefeel.qualification.plan.law_names import named_laws
from forcefeel.qualification.plan.motions import Motions, SimulatedLoader
from forcefeel.qualification.verdicts import overall
from tests.parametrization import mostly_slow

ANGLE = math.radians(5.0)
HELD_S = 0.1
RULES = load_rules("part60-a-2014")
TEST = RULES.of("release", "pitch")
SENSORS = ("load_cell.noise", "potentiometer.noise", "column_sensor.noise")
BAND = RULES.release.residual_band
OVERDAMPED = {"feel.damping": "2400 lb in s/rad"}
"""A damping ratio of 1.58."""

ELEVATORS = ("elevator-1974", "elevator-2khz")

LAWS = [
    (name, law, noisy)
    for name in ELEVATORS
    for law in names_for(open_loader(name))
    for noisy in (False, True)
    if not noisy or any(open_loader(name)[key] for key in SENSORS)
]


def programmed(loader, t):
    """The free response from ``ANGLE``, let go at t = 0."""
    inertia, damping, stiffness = (loader[f"feel.{row}"] for row in ("inertia", "damping", "stiffness"))
    roots = np.roots([inertia, damping, stiffness]).astype(complex)
    t = np.maximum(t, 0.0)[:, np.newaxis]
    return ANGLE * np.real(np.exp(roots * t) @ (roots[::-1] / (roots[::-1] - roots)))


@cache
def released(name, law, noisy, damping=None):
    loader = open_loader(name).replace({} if noisy else dict.fromkeys(SENSORS), si=True)
    loader = loader.replace({"feel.damping": damping} if damping else {}, si=True)
    moved = SimulatedLoader(loader, named_laws(loader, (law,))[law])
    return loader, Motions.of(loader, None).release(moved, ANGLE, 5.0, law)


def within(measured, reference, step, time_share, size):
    """Whether a curve stays within the tolerances of another at every instant: so much off in time, or in size."""
    shifts = range(-round(time_share / step), round(time_share / step) + 1)
    around = np.stack([np.roll(np.pad(reference, len(measured), mode="edge"), shift) for shift in shifts])
    around = around[:, len(measured) : 2 * len(measured)]
    return bool(np.all((measured >= around.min(0) - size) & (measured <= around.max(0) + size)))


@pytest.mark.parametrize(("name", "law", "noisy"), LAWS)
def test_simulated_release_is_detected_at_its_instant(name, law, noisy):
    _, record = released(name, law, noisy)
    found = measure_release(record, settle_check=False)
    assert found.release_s.value == HELD_S
    assert found.displacement.value == pytest.approx(ANGLE, rel=0.01)  # a grip held by a noisy loader, within 1 %


@pytest.mark.parametrize("rate", [1000, 100, 60])
@pytest.mark.parametrize(("name", "law", "noisy"), LAWS)
def test_recorded_release_is_detected_within_one_sample(name, law, noisy, rate):
    """Of a record alone, at other instants than the loader's own."""
    loader, record = released(name, law, noisy)
    for phase in (0.0, 0.3, 0.7):
        time = np.arange(phase / rate, record.time_s[-1], 1 / rate)
        found = measure_release(
            Record(time, np.interp(time, record.time_s, record.position), name=law), settle_check=False
        )
        # A held grip that wanders over w hides a control that starts as w_n^2 t^2 / 2 for sqrt(2 w / Ad) / w_n; where it happens to
        # wander the control's way when it is let go, it shows a start that is earlier by as much and more.
        wander = float(np.ptp(record.position[record.time_s <= HELD_S]))
        hidden = math.sqrt(2 * wander / ANGLE * loader["feel.inertia"] / loader["feel.stiffness"])
        within = 1 / rate + (3 * hidden if wander > 1e-3 * ANGLE else 0.0)
        assert found.release_s.value == pytest.approx(HELD_S, abs=within)


@pytest.mark.parametrize("damping", mostly_slow([None, OVERDAMPED["feel.damping"]]))
@pytest.mark.parametrize(("name", "law", "noisy"), LAWS)
def test_passing_release_overlays_reference(name, law, noisy, damping):
    loader, record = released(name, law, noisy, damping)
    time = record.time_s
    exact = programmed(loader, time - HELD_S)
    reference = measure_release(Record(time, exact, name="closed form", noise=0.0, resolution=0.0))
    overdamped = "rise time" if damping else "fall time"
    measured = measure_release(record, settle_check=False)
    outcome = overall(judge_release(measured, reference, TEST, overdamped=overdamped))
    late = 0.1 * (reference.rise_time.value if damping else reference.cycles[0].value)
    size = BAND * ANGLE if damping else max(BAND * ANGLE, 0.1 * reference.overshoots[0].value)
    overlays = within(record.position, exact, time[1], late, size)
    aligned, share = measured.aligned(record)
    drawn = np.interp(time, aligned + HELD_S, share * measured.displacement.value + measured.steady.value)
    assert within(drawn, exact, time[1], late, size) is overlays  # the page draws what was measured
    if outcome is Outcome.PASSED:
        assert overlays
    if law == "robust":
        assert outcome is Outcome.PASSED
