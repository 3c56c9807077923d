"""Analysis by a second route each: time integration, the edge of stability itself, closed forms."""

import control
import numpy as np
import pytest
import scipy.integrate

import forcefeel as ff
from forcefeel import _core
from forcefeel.linear.modes import feel_mode, spectral_abscissa
from forcefeel.linear.step import gramian
from tests import witness

WITNESSED = {"rtol": 1e-8, "atol": 1e-10}
"""Of the implicit solver, in U.S. units."""
STEPPED_RAD = 1e-8
"""What these leave of an angle of 0.3. Measured: 9e-11."""
SOLVED_DB, SOLVED_DEG = 1e-11, 1e-10
"""One frequency response by two linear solves of six equations. Measured: 2e-14 and 5e-13."""
MARGIN = 1e-10
"""Relative: a crossing is found to rounding, and poles of eight states move by that times their condition. Measured: 2e-13."""
FOUND = 3e-6
"""Relative: the search for a peak stops within 1e-5 rad/s, of 10. Measured: 2e-10."""
ROUNDING = 1e-12
"""Relative: the sum of eight poles. Measured: 6e-16."""
STIFF = 1e-11
"""Relative: exponentials of a rate of 3e4 and their condition. Measured: 6e-13."""
LIGHT_RAD = 5e-5
"""The phase of a damping of 0.001 lb in s. Measured: 4e-6."""
LIGHT_DEG = 3e-3
"""The phase of three factors of a damping ratio of 1e-6, no farther than a factor of two from one. Measured: 3e-4."""
LOW = {"feel.inertia": "6 lb in s^2/rad", "feel.damping": "30.4 lb in s/rad", "feel.stiffness": "960 lb in/rad"}


@pytest.fixture(scope="module")
def loader():
    return ff.elevator()


@pytest.fixture(scope="module")
def low(loader):
    return loader.replace(LOW)


@pytest.mark.parametrize(
    ("model", "derivative", "states"),
    [(ff.linear.rigid_model, witness.rigid, 7), (ff.compliant_model, witness.compliant, 8)],
)
def test_step_response_matches_integrated_equations(loader, model, derivative, states):
    """Against an implicit solver on the hand-written equations in U.S. units."""
    response = ff.step_response(model(loader), loader["pilot.force"], duration_s=1.0, samples=101)
    solved = scipy.integrate.solve_ivp(
        lambda _, x: derivative(x, 96.0),
        (0, 1),
        np.zeros(states),
        "Radau",
        response.time_s.values,
        **WITNESSED,
    )
    base = solved.y[6] if states == 8 else solved.y[0] / witness.ALPHA
    np.testing.assert_allclose(response["column_angle_rad"], base / witness.RB, atol=STEPPED_RAD)


def test_frequency_response_is_the_transfer_function(loader):
    f = np.array([0.5, 2.0, 12.0, 50.0])
    response = ff.linear.frequency_response(ff.linear.servo(loader, ff.linear.Linkage.COMPLIANT, closed=False)[0, 0], f)
    a = witness.jacobian(witness.compliant, 8)
    a[3, [0, 4]] = 0.0  # loops open: no feedback, no computer
    keep = [0, 1, 2, 3, 6, 7]
    b = np.zeros(6)
    b[3] = witness.WN**2 * witness.CI * witness.K2
    for f_hz, gain, phase in zip(f, response.gain_db.values, response.phase_deg.values, strict=True):
        x = np.linalg.solve(2j * np.pi * f_hz * np.eye(6) - a[np.ix_(keep, keep)], b)
        value = witness.K3 * x[0]
        assert gain == pytest.approx(20 * np.log10(abs(value)), abs=SOLVED_DB)
        turned = phase - np.degrees(np.angle(value))
        assert (turned + 180) % 360 - 180 == pytest.approx(0, abs=SOLVED_DEG)


@pytest.mark.parametrize("linkage", list(ff.linear.Linkage))
def test_loop_gain_at_margin_is_at_stability_limit(loader, low, linkage):
    build = _core.rigid if linkage is ff.linear.Linkage.RIGID else _core.compliant
    for one in (loader, low):
        law = ff.laws.GainLaw.original(one.si_values)
        found = ff.linear.margins(ff.linear.overall_open_loop(one, linkage))
        edge = ff.laws.GainLaw(tuple(law.gains), law.load_cell_arm * found.gain_margin)
        poles = np.linalg.eigvals(build(one.si_values, edge)[0])
        top = poles[np.argmax(poles.real)]
        assert top.real == pytest.approx(0, abs=100 * MARGIN)  # 1/s; the poles near are some 100 1/s large
        assert abs(top.imag) == pytest.approx(found.phase_crossover_rad_per_s, rel=MARGIN)


@pytest.mark.parametrize("linkage", list(ff.linear.Linkage))
def test_loop_with_phase_margin_lag_equals_minus_one(low, linkage):
    loop = ff.linear.overall_open_loop(low, linkage)
    found = ff.linear.margins(loop)
    turned = complex(loop(1j * found.gain_crossover_rad_per_s)) * np.exp(-1j * found.phase_margin_rad)
    assert turned == pytest.approx(-1, abs=MARGIN)


def test_margins_of_a_loop_in_closed_form():
    """L = 4 / (s (s + 1) (s + 2)): phase -180 degrees at sqrt 2, where the gain is 4/6."""
    found = ff.linear.margins(control.ss(control.tf([4], [1, 3, 2, 0])))
    assert found.gain_margin == pytest.approx(1.5)
    assert found.phase_crossover_rad_per_s == pytest.approx(np.sqrt(2))
    w = found.gain_crossover_rad_per_s
    assert found.phase_margin_rad == pytest.approx(np.pi / 2 - np.arctan(w) - np.arctan(w / 2))


@pytest.mark.parametrize("linkage", list(ff.linear.Linkage))
def test_margins_match_python_control(loader, low, linkage):
    """Which takes them from polynomials."""
    for one in (loader, low):
        loop = ff.linear.overall_open_loop(one, linkage)
        found = ff.linear.margins(loop)
        gains, _, _, w_phase, w_gain, _ = control.stability_margins(loop, returnall=True)
        nearest = min((g for g in gains if 0 < g < np.inf), key=lambda g: abs(np.log(g)))
        assert found.gain_margin == pytest.approx(nearest, rel=MARGIN)
        assert min(abs(w_phase / found.phase_crossover_rad_per_s - 1)) < MARGIN
        if np.isfinite(found.phase_margin_rad):
            assert min(abs(w_gain / found.gain_crossover_rad_per_s - 1)) < MARGIN
        assert np.isfinite(found.phase_margin_rad) == bool(len(w_gain))


def test_response_is_infinite_only_on_a_pole():
    integrator = control.ss([[0.0]], [[2.0]], [[1.0]], 0.0)
    gain = ff.linear.frequency_response(integrator, np.array([0.0, 1.0, 2.0])).gain_db.values
    assert gain[0] == np.inf
    np.testing.assert_allclose(gain[1:], 20 * np.log10([1 / np.pi, 0.5 / np.pi]), atol=SOLVED_DB)


def test_phase_margin_is_positive_rigid_and_negative_compliant(low):
    rigid, compliant = (
        np.degrees(ff.linear.margins(ff.linear.overall_open_loop(low, link)).phase_margin_rad)
        for link in ff.linear.Linkage
    )
    assert rigid > 30
    assert compliant < 0


def test_modes_count_conjugate_pair_once_and_keep_pole_sum(loader):
    model = ff.compliant_model(loader)
    found = ff.modes(model)
    total = sum(mode.real_per_s * (2 if mode.imaginary_per_s > 0 else 1) for mode in found)
    assert total == pytest.approx(np.trace(model.A), rel=ROUNDING)
    assert [m.frequency_rad_per_s for m in found] == sorted(m.frequency_rad_per_s for m in found)


def test_modes_of_an_oscillator_in_closed_form():
    w, zeta = 7.0, 0.3
    (mode,) = ff.modes(control.ss([[0, 1], [-w * w, -2 * zeta * w]], [[0], [1]], [[1, 0]], 0))
    assert (mode.frequency_rad_per_s, mode.damping_ratio) == pytest.approx((w, zeta))


@pytest.mark.parametrize("linkage", list(ff.linear.Linkage))
def test_stability_boundary_separates_stable_and_unstable(loader, linkage):
    found = ff.linear.smallest_stable_stiffness(loader, linkage)
    build = _core.rigid if linkage is ff.linear.Linkage.RIGID else _core.compliant
    law = ff.laws.GainLaw.original(loader.si_values)
    for factor, stable in ((1 + 1e-6, True), (1 - 1e-6, False)):
        scale = factor * found.stiffness_n_m_per_rad / loader["feel.stiffness"]
        assert (spectral_abscissa(build(loader.scale_feel(scale).si_values, law)[0]) < 0) is stable


def test_boundary_agrees_with_the_gain_margin(loader):
    """Scaling I, B, G down by a factor is raising the loop's gain by it."""
    found = ff.linear.smallest_stable_stiffness(loader)
    gain_margin = ff.linear.margins(ff.linear.overall_open_loop(loader, ff.linear.Linkage.COMPLIANT)).gain_margin
    assert found.stiffness_n_m_per_rad == pytest.approx(loader["feel.stiffness"] / gain_margin, rel=MARGIN)


def test_boundary_of_a_loader_that_is_never_stable_or_always(loader):
    runaway = ff.linear.state_feedback(loader, np.array([500.0, 0, 0, 0, 0, 0]))
    assert (
        ff.linear.smallest_stable_stiffness(loader, ff.linear.Linkage.COMPLIANT, runaway).stiffness_n_m_per_rad
        == np.inf
    )
    deaf = ff.laws.GainLaw(tuple(ff.laws.GainLaw.original(loader.si_values).gains), 0.0)
    found = ff.linear.smallest_stable_stiffness(loader, ff.linear.Linkage.COMPLIANT, deaf)
    assert found.stiffness_n_m_per_rad == 0
    assert "stable from G_max down" in found.note


def test_resonance_of_an_oscillator_in_closed_form():
    w, zeta = 10.0, 0.1
    system = control.ss(control.tf([w * w], [1, 2 * zeta * w, w * w]))
    found = ff.linear.resonance(system, 1.0, 100.0)
    assert found.frequency_rad_per_s == pytest.approx(w * np.sqrt(1 - 2 * zeta**2), rel=FOUND)
    assert found.gain == pytest.approx(1 / (2 * zeta * np.sqrt(1 - zeta**2)), rel=1e-9)  # flat there: FOUND squared
    assert ff.linear.resonance(system, 20.0, 100.0) is None


def test_gramian_in_closed_form_and_when_stiff():
    """x_k' = -a_k x_k: the integral of x_j x_k is (1 - exp(-(a_j + a_k) T)) / (a_j + a_k), also when stiff."""
    rates = np.array([2.0, 3e4])
    start = np.array([1.0, 1.0])
    found = gramian(np.diag(-rates), start, 2.0)
    sums = rates[:, None] + rates
    np.testing.assert_allclose(found, (1 - np.exp(-2 * sums)) / sums, rtol=STIFF)


@pytest.mark.parametrize(("w", "zeta"), [(12.0, 0.2), (12.0, 0.999), (12.0, 1.0), (12.0, 3.0)])
def test_feel_mode_of_ideal_loader_equals_programmed_feel(w, zeta):
    """Beside a fast servo pole and a fast oscillation, which are not the feel."""
    feel = np.array([[0, 1], [-w * w, -2 * zeta * w]])
    others = np.diag([-300.0, -400.0])
    others[0, 1], others[1, 0] = 500.0, -500.0
    a = np.block([[feel, np.zeros((2, 2))], [np.zeros((2, 2)), others]])
    found = feel_mode(ff.modes(control.ss(a, np.ones((4, 1)), np.ones((1, 4)), 0)), w, zeta)
    assert (found.frequency_rad_per_s, found.damping_ratio) == pytest.approx((w, zeta), rel=1e-6)  # a double root's


@pytest.mark.parametrize("linkage", list(ff.linear.Linkage))
def test_phase_margin_of_undamped_feel_is_limit_of_light_damping(loader, linkage):
    """A pole on the axis turns the phase by half a turn at once, and downwards."""
    found = [
        ff.linear.margins(ff.linear.overall_open_loop(loader.replace({"feel.damping": f"{b} lb in s"}), linkage))
        for b in (0, 0.001)
    ]
    assert found[0].phase_margin_rad == pytest.approx(found[1].phase_margin_rad, abs=LIGHT_RAD)


def test_phase_is_continuous_through_light_poles_and_zeros():
    w = np.array([0.5, 2.0, 4.0, 8.0])
    zeros, poles = np.poly1d([1, 2e-6 * 3, 9]), np.poly1d([1, 2e-6, 1]) * np.poly1d([1, 2e-6 * 6, 36])
    model = control.ss(control.tf(zeros.coeffs, poles.coeffs))
    phase = ff.linear.frequency_response(model, w / (2 * np.pi)).phase_deg.values
    np.testing.assert_allclose(phase, [0, -180, 0, -180], atol=LIGHT_DEG)
