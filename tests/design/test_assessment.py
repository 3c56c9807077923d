"""How a loop is judged: each figure by a second route, and what the studies rest on."""

import pickle

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.design.studies import CHANGES, best_of_each_count, droppable, worst
from forcefeel.loader.parameters import HYDRAULIC, PLANT_PARAMETERS, required

US_STIFFNESS = 4.4482216152605 * 0.0254  # N m/rad in a lb in/rad
FREE = 3e-4
"""Of the tracking error, 0.19: what the path of the pressure changes of it. Measured: 3e-5."""
WHOLE = 0.5
"""lb in/rad: the independent figures are whole numbers."""
TRAPEZOIDS = 1e-8
"""Relative: trapezoids of 0.1 ms. Measured: 8e-11."""


@pytest.fixture(scope="module")
def loader():
    return ff.elevator()


@pytest.fixture(scope="module")
def gains(loader):
    return ff.design_gains(loader, ff.laws.published_settings(loader)).gains


@pytest.fixture(scope="module")
def dropped(loader, gains):
    return ff.design.drop_paths(loader, gains)


@pytest.fixture(scope="module")
def deviations(loader, gains):
    return ff.design.sensitivity(loader, gains)


def test_tracking_error_and_cost_are_integrals_of_the_response(loader, gains):
    law = ff.linear.state_feedback(loader, gains[:6])
    found = ff.design.assess(loader, law)
    force = loader["pilot.force"]
    column = ff.step_response(ff.compliant_model(loader, law), force, samples=20001)
    ideal = ff.step_response(ff.linear.ideal_feel(loader), force, samples=20001)
    deviation = column.column_angle_rad - ideal.column_angle_rad
    wanted = 31.375 * 96 / 9600
    assert found.tracking_error == pytest.approx(
        np.sqrt(float((deviation**2).integrate("time_s")) / 2) / wanted, rel=TRAPEZOIDS
    )
    e = column.valve_current_a / loader["amplifier.admittance"]
    integrand = 100 * (column.feel_position_rad - column.column_angle_rad) ** 2 + 0.1 * e**2
    assert found.cost == pytest.approx(float(integrand.integrate("time_s")), rel=TRAPEZOIDS)


def test_static_angle_is_the_final_value_of_the_response(loader, gains):
    law = ff.linear.state_feedback(loader, gains[:6])
    response = ff.step_response(ff.compliant_model(loader, law), loader["pilot.force"], duration_s=10.0)
    found = ff.design.assess(loader, law)
    assert float(response.column_angle_rad[-1]) == pytest.approx(found.static_angle_rad, rel=1e-8)  # exp(-24) is left
    assert found.static_error == pytest.approx(found.static_angle_rad / (31.375 * 96 / 9600) - 1)


def test_peaks_are_compared_with_the_ratings(loader, gains):
    law = ff.linear.state_feedback(loader, gains[:6])
    halved = ff.design.peaks(loader.replace({"valve.rated_current": "7.5 mA", "valve.rated_flow": "50 in^3/s"}), law)
    found = ff.design.peaks(loader, law)
    assert (halved.current_share, halved.flow_share) == pytest.approx((2 * found.current_share, 2 * found.flow_share))
    assert found.current_share == pytest.approx(found.current_a / 0.015)
    assert found.flow_share == pytest.approx(found.flow_m3_per_s / (100 * 0.0254**3))
    assert 0.2 < found.current_share < 0.5


def test_unstable_loop_is_reported(loader):
    found = ff.design.assess(loader, ff.linear.state_feedback(loader, np.array([500.0, 0, 0, 0, 0, 0])))
    assert not found.stable
    assert found.abscissa_per_s > 0
    assert np.isnan(found.tracking_error)


def test_integrator_is_not_stable(loader, gains):
    """Without x_p, delta and x_b nothing holds the piston: a pole at zero, which rounding may put on either side."""
    left = gains[:6].copy()
    left[[0, 2, 4]] = 0
    assert not ff.design.assess(loader, ff.linear.state_feedback(loader, left)).stable


def test_every_set_of_paths_is_evaluated_once(dropped):
    assert len(dropped) == 2**6 - 2  # all and none of the six are left out
    assert len({row.paths for row in dropped}) == len(dropped)


def test_removing_the_position_path_is_fatal_and_pressure_is_not_needed(dropped, loader, gains):
    by_path = {row.paths: row for row in dropped}
    full = ff.design.assess(loader, ff.linear.state_feedback(loader, gains[:6]))
    assert not by_path["c_1",].assessment.stable
    assert by_path["c_2",].assessment.tracking_error == pytest.approx(full.tracking_error, abs=FREE)
    assert by_path["c_4",].cost_increase > 0.3


def test_best_set_of_each_size_is_the_best(dropped):
    for best in best_of_each_count(dropped):
        rivals = [r for r in dropped if len(r.paths) == len(best.paths) and r.assessment.stable]
        assert best.assessment.tracking_error == min(r.assessment.tracking_error for r in rivals)


def test_every_parameter_is_varied_or_listed_as_excluded():
    not_of_the_compensated_plant = {
        "valve.rated_flow", "valve.rated_current", "valve.supply_pressure", "load_cell.gain", "potentiometer.gain",
        "feel.inertia", "feel.damping", "feel.stiffness", "feel.maximum_stiffness", "pilot.force",
    }  # fmt: skip
    assert set(required(HYDRAULIC)) - set(PLANT_PARAMETERS) == not_of_the_compensated_plant


def test_every_gain_and_parameter_is_varied(deviations):
    assert len(deviations) == (6 + len(PLANT_PARAMETERS)) * len(CHANGES)
    assert all(row.assessment is not None for row in deviations)


def test_small_deviations_match_the_derivative(loader, gains, deviations):
    """+-5 % of c_3 on the static angle against the slope by a much smaller step."""
    at = {row.change: row.assessment.static_error for row in deviations if row.quantity == "c_3"}
    nudged = gains[:6].copy()
    nudged[2] *= 1 + 1e-5
    here, there = (
        ff.design.assess(loader, ff.linear.state_feedback(loader, g)).static_error for g in (gains[:6], nudged)
    )
    assert (at[0.05] - at[-0.05]) / 0.1 == pytest.approx((there - here) / 1e-5, rel=0.02)  # third-order terms


def test_worst_deviation_is_unstable_or_has_largest_tracking_error(loader, deviations):
    named = worst(deviations)
    assert named.assessment.tracking_error == max(row.assessment.tracking_error for row in deviations)
    runaway = ff.design.assess(loader, ff.linear.state_feedback(loader, np.array([500.0, 0, 0, 0, 0, 0])))
    unstable = ff.design.Deviation("c_1", 0.05, runaway)
    assert worst((*deviations, unstable)) is unstable


def test_removing_a_path_can_cost_stability_but_keep_the_feel(dropped):
    edge = {row.paths: row.boundary.stiffness_n_m_per_rad / US_STIFFNESS for row in dropped}
    # Independent figures, in lb in/rad.
    assert edge["c_2", "c_6"] == pytest.approx(1682, abs=WHOLE)
    assert edge["c_4",] == pytest.approx(2720, abs=WHOLE)
    assert edge["c_4", "c_6"] == pytest.approx(3028, abs=WHOLE)


def test_removable_paths_keep_fidelity_and_stability(loader, gains, dropped):
    law = ff.linear.state_feedback(loader, gains[:6])
    edge = ff.linear.smallest_stable_stiffness(loader, law=law)
    assert droppable(dropped, ff.design.assess(loader, law), edge).paths == ("c_2", "c_6")
    strict = ff.linear.StabilityBoundary(edge.stiffness_n_m_per_rad / 2, 0.0, "")
    assert droppable(dropped, ff.design.assess(loader, law), strict) is None


def test_deviation_out_of_range_is_not_evaluated(loader, gains):
    straight = loader.replace({"linkage.ratio": "0.95"})
    rows = ff.design.sensitivity(straight, gains)
    missing = [row for row in rows if row.assessment is None]
    assert {row.quantity for row in missing} == {"linkage.ratio"}
    assert worst(rows).assessment is not None


@pytest.mark.slow
def test_design_uses_a_single_cost_index(loader):
    found = ff.design_loader(loader, ff.laws.DesignSettings(horizon_s=0.05, r2=10.0))
    law = found.compensation.law(loader)
    full = ff.design.assess(loader, law, found.compensation.settings)
    assert found.configuration("compensated").programmed.assessment.cost == full.cost
    first = found.dropped[0].assessment, found.dropped[0].cost_increase
    assert np.isnan(first[1]) or first[0].cost / full.cost - 1 == pytest.approx(first[1])


def test_original_law_by_name_matches_the_default(loader):
    named = ff.design.assess(loader, ff.laws.GainLaw.original(loader.si_values))
    assert np.isnan(named.cost)
    assert named.tracking_error == ff.design.assess(loader, None).tracking_error


def test_state_feedback_on_a_rigid_link_has_no_cost(loader, gains):
    found = ff.design.assess(loader, ff.linear.state_feedback(loader, gains[:6]), linkage=ff.linear.Linkage.RIGID)
    assert found.stable
    assert np.isnan(found.cost)


def test_gains_that_are_not_finite_raise_input_error(loader):
    with pytest.raises(ff.InputError, match="six or seven finite numbers"):
        ff.linear.state_feedback(loader, np.full(6, np.nan))


@pytest.mark.slow
def test_design_can_be_pickled(loader):
    law = ff.laws.GainLaw.original(loader.si_values)
    assert pickle.loads(pickle.dumps(law)) == law
    found = ff.design_loader(loader)
    again = pickle.loads(pickle.dumps(found))
    np.testing.assert_array_equal(again.compensation.gains, found.compensation.gains)
    assert [one.law for one in again.configurations] == [one.law for one in found.configurations]
    with pytest.raises(ValueError, match="read-only"):
        found.compensation.gains[0] = 0.0
