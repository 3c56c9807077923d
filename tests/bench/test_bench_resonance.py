"""Frequency and damping ratio read off a response: exact on single modes, honest where there is nothing to read."""

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.bench.circle import fit_mode
from forcefeel.bench.experiments import Experiment
from forcefeel.bench.resonance import FEWEST_LINES, link_from_resonance, read_resonance
from forcefeel.bench.responses import Response
from forcefeel.errors import InputError

POUND_PER_INCH = 4.4482216152605 / 0.0254  # N/m, exact
FINE = np.arange(0.5, 40.0, 0.05)
LINES = {"fine": FINE, "half hertz": np.arange(2.0, 30.0, 0.5), "few": np.geomspace(2.0, 40.0, 24)}
EXACT = 1e-6  # relative; the circle's fit stops at rounding, and angles near the top of a sharp peak lose half of the digits
AVERAGED, AVERAGED_DAMPING = 1e-3, 0.02
"""Relative: 50 lines of 2 % leave about 0.02 zeta / sqrt(50) of the frequency, ten times that of zeta; the circle's own bias is of
that order. Measured: 2e-4, 5e-3."""
LAST_DIGIT_K, LAST_DIGIT_C = 0.015, 0.0001
"""Of what the appendix prints: its arithmetic is that of a slide rule's successor, the last of six digits is off by one."""
TAILS, TAILS_DAMPING = 2e-3, 5e-3
"""Relative, of the circle: the other modes' tails are no constant over the peak. Measured: 6e-4, 2e-3."""
HALF_POWER, HALF_POWER_DAMPING = 0.01, 0.02
"""The same of the half-power points, which see more of them. Measured: 4e-3, 0.017."""
SPLINE = 5e-3  # relative; cubic spline of dB, four lines at least within the half-power points; fine ones are better, see below
SPLINE_OF_MANY = 1e-5  # relative; a cubic spline's error falls with the fourth power: (1/5)^4 of that and less


def mode(f, frequency_hz, zeta, *, velocity=False, amplitude=1.0, rest=0.0):
    """A mode of one degree of freedom, in the textbook's form, and a constant of others."""
    w, wn = 2 * np.pi * f, 2 * np.pi * frequency_hz
    receptance = amplitude / (wn**2 - w**2 + 2j * zeta * wn * w)
    return receptance * (1j * w if velocity else 1.0) + rest


def response(f, value, output="column_angle", drive="pilot_force"):
    return Response("bench", Experiment.read(f"loader {drive}"), drive, output, f, value)


@pytest.mark.parametrize("lines", LINES)
@pytest.mark.parametrize("zeta", [0.01, 0.05, 0.1, 0.3])
@pytest.mark.parametrize("frequency_hz", [5.3, 12.0])
@pytest.mark.parametrize("output", ["column_angle", "column_velocity"])
def test_single_mode_is_identified(lines, zeta, frequency_hz, output):
    f = LINES[lines]
    velocity = output == "column_velocity"
    found = read_resonance(response(f, mode(f, frequency_hz, zeta, velocity=velocity), output))
    assert found.kind == ("mobility" if velocity else "receptance")
    within = np.count_nonzero(np.abs(f - frequency_hz) < zeta * frequency_hz)
    if within >= 4:
        assert found.half_power.frequency_hz == pytest.approx(frequency_hz, rel=SPLINE)
        assert found.half_power.damping_ratio == pytest.approx(zeta, rel=SPLINE)
    if within >= 1:
        assert found.circle.frequency_hz == pytest.approx(frequency_hz, rel=EXACT)
        assert found.circle.damping_ratio == pytest.approx(zeta, rel=EXACT)
        assert (found.frequency_hz, found.damping_ratio) == (found.circle.frequency_hz, found.circle.damping_ratio)
    for reading in (found.half_power, found.circle):  # never a wrong number
        if reading.frequency_hz is None:
            assert reading.damping_ratio is None
            assert reading.note.startswith("not read: ")
        else:
            assert reading.frequency_hz == pytest.approx(
                frequency_hz, rel=0.01
            )  # three lines within the half-power points
            assert reading.damping_ratio == pytest.approx(zeta, rel=0.05)  # as above
    if within >= 12:
        assert found.half_power.damping_ratio == pytest.approx(zeta, rel=SPLINE_OF_MANY)


@pytest.mark.parametrize("turn", [0.0, 1.0, np.pi])
def test_circle_fit_does_not_depend_on_rotation_or_offset(turn):
    """A complex mode shape turns the circle, other modes shift it: neither matters to the fit."""
    value = mode(FINE, 12.0, 0.05, velocity=True, amplitude=3e-3 * np.exp(1j * turn), rest=2e-5 - 1e-5j)
    near = (FINE > 10) & (FINE < 14)
    found = fit_mode(FINE[near], value[near])
    assert (found.frequency_hz, found.damping_ratio) == pytest.approx((12.0, 0.05), rel=EXACT)
    assert found.off < 1e-9  # rounding


def test_half_power_points_of_mobility_match_the_textbook():
    value = mode(FINE, 12.0, 0.05, velocity=True)
    found = read_resonance(response(FINE, value, "column_velocity")).half_power
    low, high = (
        12 * (np.sqrt(1 + 0.05**2) + side * 0.05) for side in (-1, 1)
    )  # the roots of w^2 -+ 2 zeta w_n w - w_n^2
    assert found.note == f"half power at {low:.4g} Hz and {high:.4g} Hz"


def test_circle_fit_averages_noise():
    rng, read = np.random.default_rng(4), []
    for _ in range(40):
        noise = 1 + 0.02 * (rng.standard_normal(len(FINE)) + 1j * rng.standard_normal(len(FINE)))
        found = read_resonance(response(FINE, mode(FINE, 12.0, 0.1) * noise)).circle
        read.append((found.frequency_hz, found.damping_ratio))
    frequency, damping = np.mean(read, axis=0)
    assert frequency == pytest.approx(12.0, rel=AVERAGED)
    assert damping == pytest.approx(0.1, rel=AVERAGED_DAMPING)


def test_band_selects_the_mode():
    value = mode(FINE, 6.0, 0.03) + mode(FINE, 20.0, 0.03, amplitude=3.0)
    found = read_resonance(response(FINE, value), (15.0, 25.0))
    assert found.frequency_hz == pytest.approx(20.0, rel=1e-3)  # the other mode is 20^2 / 6^2 below it
    assert found.damping_ratio == pytest.approx(0.03, rel=TAILS)
    assert read_resonance(response(FINE, value), (3.0, 10.0)).frequency_hz == pytest.approx(6.0, rel=1e-3)  # as above


def test_unreadable_resonance_is_explained():
    integrator = read_resonance(response(FINE, 1 / (2j * np.pi * FINE)))
    assert integrator.half_power == integrator.circle
    assert (
        integrator.half_power.note
        == "not read: the gain is largest at the edge, 0.5 Hz: no peak in the band; measure beyond it"
    )
    near = (FINE > 11.5) & (FINE < 13.5)
    beside = read_resonance(response(FINE[near], mode(FINE[near], 12.0, 0.1)))
    assert "does not fall by 3 dB below the peak at 11.88 Hz; measure further below it" in beside.half_power.note
    assert beside.circle.frequency_hz == pytest.approx(12.0, rel=EXACT)  # the circle needs no half-power points
    assert beside.frequency_hz == beside.circle.frequency_hz
    coarse = np.arange(1.0, 40.0, 2.0)
    sharp = read_resonance(response(coarse, mode(coarse, 12.0, 0.05)))
    assert f"lie within 3 dB of the peak at 11.86 Hz; expected at least {FEWEST_LINES}" in sharp.half_power.note
    rng = np.random.default_rng(0)
    noise = rng.standard_normal(20) + 1j * rng.standard_normal(20)
    assert "of its radius off a circle: several modes, or noise; narrow the band" in fit_mode(FINE[:20], noise)
    top = FINE[(FINE > 11.9) & (FINE < 12.3)]
    assert "rad of a circle; measure at more frequencies about it" in fit_mode(top, mode(top, 12.0, 0.1, velocity=True))
    assert "3 lines are too few" in fit_mode(FINE[:3], noise[:3])


def test_note_states_when_the_result_applies():
    value = mode(FINE, 12.0, 0.1)
    assert read_resonance(response(FINE, value)).note == (
        "column_angle is read as a displacement or a force: the receptance of one mode by itself, driven by a force"
    )
    by_signal = read_resonance(response(FINE, value, drive="test_signal")).note
    assert by_signal.endswith(
        "test_signal is no force, so half power is off by the order of the damping ratio; the circle by less"
    )
    assert "velocity or a flow: the mobility" in read_resonance(response(FINE, value, "actuator_flow")).note


@pytest.mark.parametrize(
    ("band", "message"),
    [
        ((5.0, 5.0), "band_hz: expected two rising"),
        ((-1.0, 5.0), "band_hz: expected two"),
        ((5.0, 5.1), "5 lines at least, got"),
    ],
)
def test_invalid_band_raises_input_error(band, message):
    with pytest.raises(InputError, match=message):
        read_resonance(response(FINE, mode(FINE, 12.0, 0.1)), band)


def test_link_of_the_report_is_reproduced():
    k, c = link_from_resonance(ff.elevator(), 12.0, 0.1)
    assert k / POUND_PER_INCH == pytest.approx(6107.86, abs=LAST_DIGIT_K)
    assert c / POUND_PER_INCH == pytest.approx(16.2016, abs=LAST_DIGIT_C)


def test_computed_link_has_the_specified_resonance():
    """The second route: the column on the link of a piston that stands still, from the matrices of the compliant model."""
    k, c = link_from_resonance(ff.elevator(), 9.0, 0.07)
    loader = ff.elevator().replace({"linkage.stiffness": k, "linkage.damping": c}, si=True)
    model = ff.compliant_model(loader)
    base = [model.state_labels.index(name) for name in ("base_position_m", "base_velocity_m_per_s")]
    # Where the piston stands still, 0 = x_p' = a_p p + a_x x_b + a_v x_b' gives the pressure that holds it, which drives x_b''.
    held, pushed = model.A[0], model.A[base[1], 1]
    stiffness, damping = (pushed * held[state] / held[1] for state in base)
    assert np.sqrt(stiffness) / (2 * np.pi) == pytest.approx(9.0, rel=1e-9)  # rounding
    assert damping / (2 * np.sqrt(stiffness)) == pytest.approx(0.07, rel=1e-9)  # rounding


@pytest.mark.parametrize(("closed", "reported"), [(False, (11.8, 0.169)), (True, (11.4, 0.164))])
def test_loader_mode_matches_its_eigenvalue(closed, reported):
    elevator = ff.elevator()
    law = ff.laws.GainLaw.position_loop(elevator.si_values) if closed else ff.laws.GainLaw.none(elevator.si_values)
    model = ff.compliant_model(elevator, law)
    f = np.arange(2.0, 40.0, 0.1)
    found = read_resonance(response(f, model(2j * np.pi * f)[0, 0]), (6.0, 25.0))
    # The second route: the eigenvalue.
    (mode_there,) = (it for it in ff.modes(model) if 60 < it.frequency_rad_per_s < 90)
    assert found.circle.frequency_hz == pytest.approx(mode_there.frequency_rad_per_s / (2 * np.pi), rel=TAILS)
    assert found.circle.damping_ratio == pytest.approx(mode_there.damping_ratio, rel=TAILS_DAMPING)
    assert found.half_power.frequency_hz == pytest.approx(found.circle.frequency_hz, rel=HALF_POWER)
    assert found.half_power.damping_ratio == pytest.approx(found.circle.damping_ratio, rel=HALF_POWER_DAMPING)
    frequency_hz = mode_there.frequency_rad_per_s / (2 * np.pi)
    assert (round(frequency_hz, 1), round(mode_there.damping_ratio, 3)) == reported  # as the documentation has them
    _, c = link_from_resonance(elevator, found.frequency_hz, found.damping_ratio)
    assert 1.5 < c / elevator["linkage.damping"] < 1.7


@pytest.mark.parametrize(("frequency", "zeta"), [(0.0, 0.1), (12.0, -0.1), (np.nan, 0.1), (12.0, np.inf)])
def test_invalid_resonance_raises_input_error(frequency, zeta):
    with pytest.raises(InputError, match="expected a number above 0"):
        link_from_resonance(ff.elevator(), frequency, zeta)
