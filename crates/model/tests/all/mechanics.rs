//! Linkage, column, feel computer and load cell against numbers and laws worked out by hand.

use crate::near::{ROUNDING, assert_near, assert_within};
use core::f64::consts::TAU;
use forcefeel_model::parameters::{Feel, Linkage, Parameters};
use forcefeel_model::units;

const IN: f64 = units::LENGTH.si_per_us;
const LB: f64 = units::FORCE.si_per_us;

#[test]
fn piston_velocity_fulfils_the_force_law_of_the_link() {
    let linkage = Parameters::elevator().linkage;
    let (k, c, alpha) = (6107.86, 16.2016, 0.59);
    let (f_c, x_p, x_b, x_b_rate) = (-150.0, 0.4, 0.7, 2.0); // lb, in, in/s
    let x_p_rate = linkage.piston_velocity(f_c * LB, x_p * IN, x_b * IN, x_b_rate * IN) / IN;
    // Eq. (9) with its result put back: F_c = k (x_p - alpha x_b) + c (x_p' - alpha x_b').
    assert_near(k * (x_p - alpha * x_b) + c * (x_p_rate - alpha * x_b_rate), f_c, ROUNDING);
}

#[test]
fn rigid_link_moves_the_piston_by_the_linkage_ratio() {
    let linkage = Parameters::elevator().linkage;
    assert_near(linkage.rigid_piston(2.0), 1.18, ROUNDING); // 0.59 * 2
    assert_near(linkage.rigid_base(1.18), 2.0, ROUNDING);
    assert_near(linkage.base_force(100.0), 59.0, ROUNDING); // the same lever: power in is power out
}

#[test]
fn printed_spring_and_damper_are_a_column_swinging_at_12_hz_with_a_tenth_of_critical_damping() {
    let Parameters { linkage, column, .. } = Parameters::elevator();
    let w = 75.398_16; // 24 * 3.14159: the printed k has the digits of this pi; a better one gives 6107.87
    let (k, c) = Linkage::from_resonance(linkage.ratio, &column, w, 0.1);
    assert_within(k / units::STIFFNESS.si_per_us, 6107.86, 0.005); // printed: half a unit of the last digit
    assert_within(c / units::DAMPING.si_per_us, 16.2016, 0.000_05);
    let (k, c) = Linkage::from_resonance(linkage.ratio, &column, 12.0 * TAU, 0.1);
    assert_within(k / units::STIFFNESS.si_per_us, 6107.87, 0.005); // 37.4 (24 pi)^2 / 5.9^2
    assert_within(c / units::DAMPING.si_per_us, 16.2016, 0.000_05);
}

#[test]
fn column_swings_on_the_link_as_it_was_made_to() {
    let Parameters { mut linkage, column, .. } = Parameters::elevator();
    let (w, zeta) = (31.0, 0.25);
    (linkage.stiffness, linkage.damping) = Linkage::from_resonance(linkage.ratio, &column, w, zeta);
    // The piston is held, x_p = x_p' = 0: a call at F_c = 0 gives the velocity that the force F_c = -c x_p' must undo.
    let acceleration = |x_b: f64, x_b_rate: f64| {
        let f_c = -linkage.damping * linkage.piston_velocity(0.0, 0.0, x_b, x_b_rate);
        assert_within(linkage.piston_velocity(f_c, 0.0, x_b, x_b_rate), 0.0, ROUNDING);
        column.base_acceleration(linkage.base_force(f_c), 0.0)
    };
    assert_near(acceleration(1.0, 0.0), -w * w, ROUNDING);
    assert_near(acceleration(0.0, 1.0), -2.0 * zeta * w, ROUNDING);
}

#[test]
fn column_rests_when_the_torques_balance() {
    let column = Parameters::elevator().column;
    // 96 lb at 31.375 in against 301.2 lb at 10 in
    let left = column.base_acceleration(-301.2 * LB, 96.0 * LB);
    let one_sided = column.base_acceleration(0.0, 96.0 * LB);
    assert_within(left / one_sided, 0.0, ROUNDING);
}

#[test]
fn column_accelerates_with_torque_over_inertia() {
    let column = Parameters::elevator().column;
    // theta'' = 31.375 * 10 / 37.4 rad/s^2; the base is 10 in out.
    assert_near(column.base_acceleration(0.0, 10.0 * LB), 313.75 / 37.4 * 10.0 * IN, ROUNDING);
    assert_near(column.base_acceleration(10.0 * LB, 0.0), 100.0 / 37.4 * 10.0 * IN, ROUNDING);
    assert_near(column.angle(2.5 * IN), 0.25, ROUNDING);
    assert_near(column.pilot_torque(96.0 * LB), 3012.0 * LB * IN, ROUNDING);
}

#[test]
fn feel_rests_where_the_spring_carries_the_torque() {
    let feel = Parameters::elevator().feel;
    let torque = 3012.0 * LB * IN;
    // delta = 3012 / 9600
    assert_within(feel.acceleration(0.313_75, 0.0, torque) / feel.acceleration(0.0, 0.0, torque), 0.0, ROUNDING);
}

#[test]
fn feel_accelerates_with_what_torque_spring_and_damper_leave() {
    let feel = Parameters::elevator().feel;
    // (3012 - 304 * 2 - 9600 * 0.1) / 60
    assert_near(feel.acceleration(0.1, 2.0, 3012.0 * LB * IN), 1444.0 / 60.0, ROUNDING);
}

#[test]
fn feel_frequency_and_damping_ratio_are_those_of_its_equation() {
    let (w, zeta) = Parameters::elevator().feel.frequency();
    assert_near(w, f64::sqrt(160.0), ROUNDING); // 9600 / 60
    assert_near(zeta, 304.0 / (2.0 * f64::sqrt(9600.0 * 60.0)), ROUNDING);
    // "2.0 Hz, 0.2 damped": I and B are printed to two and three digits.
    assert_within(w / TAU, 2.0, 0.05);
    assert_within(zeta, 0.2, 0.005);
}

#[test]
fn feel_from_frequency_goes_there_and_back() {
    for (w, zeta, g) in [(2.0 * TAU, 0.2, 1084.7), (0.3, 0.0, 12.0), (40.0, 1.0, 7.0e5), (5.0, 3.0, 0.01)] {
        let (inertia, damping) = Feel::from_frequency(w, zeta, g);
        let (w_back, zeta_back) =
            Feel { inertia, damping, stiffness: g, maximum_stiffness: g, ..Parameters::elevator().feel }.frequency();
        assert_near(w_back, w, ROUNDING);
        assert_near(zeta_back, zeta, ROUNDING);
    }
}

#[test]
fn load_cell_is_positive_when_the_pilot_pushes() {
    let Parameters { linkage, column, load_cell, feel, .. } = Parameters::elevator();
    // At rest, eq. (6): a push of 96 lb loads the cell with -R_p F_p / (alpha R_b).
    let f_c = -column.pilot_torque(96.0 * LB) / linkage.base_force(column.base_arm);
    let e_f = load_cell.signal(f_c);
    assert_near(e_f, 0.005 * 3012.0 / 5.9, ROUNDING); // 5.9 in = 0.59 * 10 in
    assert_near(feel.analog_torque(e_f), 28_800.0 * LB * IN * e_f, ROUNDING);
}
