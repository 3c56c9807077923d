"""The models against the printed matrices and against the equations written out by hand."""

import control
import numpy as np
import pytest

import forcefeel as ff
from forcefeel import _core
from forcefeel.linear.models import DESIGN_STATES, INPUTS, OUTPUTS
from forcefeel.loader.parameters import INDEX
from forcefeel.reproduction import printed_matrices as printed
from tests import witness

ROUNDING = 1e-13
RICCATI = 1e-7  # relative; states in SI units differ by ten powers of ten, and SciPy does not balance them
SOLVED = 1e-11  # relative; two linear solves of as many as eight equations
"""Entries are the same formula in another order of multiplication, some after a conversion of units."""


@pytest.fixture(scope="module")
def loader():
    return ff.elevator()


@pytest.fixture(scope="module")
def as_printed(loader):
    """Values with the printed sign of the load cell: a negative K_1."""
    values = loader.si_values.copy()
    values[INDEX["load_cell.gain"]] *= -1
    return values


def assert_entries(actual, expected):
    np.testing.assert_array_equal(actual == 0, expected == 0)
    np.testing.assert_allclose(actual, expected, rtol=ROUNDING)


def test_rigid_model_is_eq_15(loader, as_printed):
    a, b, _, _ = _core.rigid(as_printed, ff.laws.GainLaw.original(as_printed))
    expected_a, expected_b = printed.rigid(printed.letters(loader))
    assert_entries(a, expected_a)
    assert_entries(b[:, 0], expected_b)


def test_compliant_model_is_eq_17(loader, as_printed):
    a, b, _, _ = _core.compliant(as_printed, ff.laws.GainLaw.original(as_printed))
    expected_a, expected_b = printed.compliant(printed.letters(loader))
    assert_entries(a, expected_a)
    assert_entries(b[:, 0], expected_b)


def test_design_plant_is_eq_19(loader):
    a, b, _, _ = _core.design_plant(loader.si_values, loader["feel.maximum_stiffness"])
    expected_a, expected_b = printed.design_plant(printed.letters(loader))
    assert_entries(a, expected_a)
    assert_entries(b[:, 0], expected_b)


def test_load_cell_sign_is_only_difference_from_printed_models(loader):
    for model, expected, entry in (
        (ff.linear.rigid_model(loader), printed.rigid(printed.letters(loader))[0], (6, 2)),
        (ff.compliant_model(loader), printed.compliant(printed.letters(loader))[0], (5, 1)),
    ):
        flipped = expected.copy()
        flipped[entry] *= -1
        assert_entries(model.A, flipped)


COMPLIANT_UNITS = np.array(
    [witness.INCH, witness.LBF / witness.INCH**2, witness.INCH**3, witness.INCH**3, 1, 1, witness.INCH, witness.INCH]
)
RIGID_UNITS = COMPLIANT_UNITS[[0, 0, 1, 2, 3, 4, 5]]


def test_state_matrices_match_explicit_equations_in_us_units(loader):
    compliant = witness.jacobian(witness.compliant, 8) * COMPLIANT_UNITS[:, None] / COMPLIANT_UNITS
    rigid = witness.jacobian(witness.rigid, 7) * RIGID_UNITS[:, None] / RIGID_UNITS
    np.testing.assert_allclose(ff.compliant_model(loader).A, compliant, rtol=ROUNDING)
    np.testing.assert_allclose(ff.linear.rigid_model(loader).A, rigid, rtol=ROUNDING)


def test_compensated_model_matches_explicit_equations(loader):
    gains = np.array([-4.93, -0.000026, 22.02, 0.669, 0.506, -0.018])
    us_units = COMPLIANT_UNITS[[0, 1, 4, 5, 6, 7]]
    model = ff.compliant_model(loader, ff.linear.state_feedback(loader, gains / us_units))
    expected = witness.jacobian(witness.compliant, 8, gains=gains) * COMPLIANT_UNITS[:, None] / COMPLIANT_UNITS
    np.testing.assert_allclose(model.A, expected, rtol=ROUNDING)


def test_signals_are_named(loader):
    model = ff.compliant_model(loader)
    assert model.input_labels == list(INPUTS)
    assert model.output_labels == ["feel_position_v" if name == "feel_position" else name for name in OUTPUTS]
    assert model.state_labels[0] == "piston_position_m"
    assert model.state_labels[4] == "feel_position_v"
    feedback = ff.compliant_model(loader, ff.linear.state_feedback(loader, np.ones(6)))
    assert feedback.state_labels[4] == feedback.output_labels[1] == "feel_position_rad"
    assert ff.linear.design_plant(loader).state_labels == list(DESIGN_STATES)
    assert all(
        one.isctime()
        for one in (model, ff.linear.rigid_model(loader), ff.linear.design_plant(loader), ff.linear.ideal_feel(loader))
    )


def test_outputs_follow_from_the_states(loader):
    model = ff.compliant_model(loader)
    x = np.array([0.01, 2e5, 1e-4, 1e-2, 0.3, 0.1, 0.02, 0.1])
    out = dict(zip(OUTPUTS, model.C @ x, strict=True))
    e = x[4] - loader["potentiometer.gain"] * x[0]
    assert out["column_angle_rad"] == pytest.approx(x[6] / loader["column.base_arm"])
    assert out["feel_position"] == x[4]
    assert out["load_cell_force_n"] == pytest.approx(loader["actuator.area"] * x[1])
    assert out["potentiometer_v"] == pytest.approx(loader["potentiometer.gain"] * x[0])
    assert out["valve_current_a"] == pytest.approx(loader["amplifier.admittance"] * e)
    assert out["actuator_flow_m3_per_s"] == pytest.approx(x[2] - loader["valve.pressure_gain"] * x[1])


def test_actuator_flow_is_commanded_minus_pressure_loss(loader):
    x = np.array([0.01, 0.2, 2e5, 1e-4, 1e-2, 0.3, 0.1])
    flow = (ff.linear.rigid_model(loader).C @ x)[OUTPUTS.index("actuator_flow_m3_per_s")]
    assert flow == pytest.approx(x[3] - loader["valve.pressure_gain"] * x[2])


def test_ideal_feel_settles_at_torque_over_stiffness(loader):
    assert float(ff.linear.ideal_feel(loader).dcgain()) * loader["pilot.force"] == pytest.approx(31.375 * 96 / 9600)


def test_overall_loop_closes_to_the_loader(loader):
    """1 + L = 0 at every pole of the closed loop that the load cell moves."""
    loop = ff.linear.overall_open_loop(loader, ff.linear.Linkage.COMPLIANT)
    feel = min(ff.compliant_model(loader).poles(), key=abs)
    assert abs(1 + complex(loop(feel))) < 1e-9  # rounding of a pole times the slope of L there


def test_servo_model_excludes_only_feel_computer(loader):
    whole = ff.compliant_model(loader, ff.laws.GainLaw.position_loop(loader.si_values))
    alone = ff.linear.servo(loader, ff.linear.Linkage.COMPLIANT, closed=True)
    s = 2j * np.pi * 7.0
    assert complex(alone[0, 0](s)) == pytest.approx(complex(whole[4, 1](s)), rel=SOLVED)


def test_wrong_number_of_gains_is_refused(loader):
    with pytest.raises(ff.InputError, match="expected six or seven finite numbers, got"):
        ff.linear.state_feedback(loader, np.ones(5))


def test_lqr_uses_design_plant_without_pilot_force():
    """Riccati's equation and the poles; with the constant force as a state there is no such regulator."""
    loader = ff.elevator()
    plant = ff.linear.design_plant(loader, pilot_state=False)
    assert plant.state_labels == list(DESIGN_STATES[:-1])
    q = 1e4 * plant.C.T @ plant.C
    gains, solution, poles = control.lqr(plant, q, 1.0)
    residual = plant.A.T @ solution + solution @ plant.A - solution @ plant.B @ plant.B.T @ solution + q
    size = np.abs(plant.A.T) @ np.abs(solution)
    assert np.all(np.abs(residual) <= RICCATI * np.maximum(size + size.T, np.max(np.abs(q))))
    np.testing.assert_allclose(
        np.sort(np.linalg.eigvals(plant.A - plant.B @ gains).real), np.sort(poles.real), rtol=RICCATI
    )
    assert max(poles.real) < 0
    whole = ff.linear.design_plant(loader)
    np.testing.assert_array_equal(whole.A[:6, :6], plant.A)
    np.testing.assert_array_equal(whole.A[6], 0.0)  # nothing moves F_p
    np.testing.assert_array_equal(whole.B[6], 0.0)
