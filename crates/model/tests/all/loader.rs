//! The parts put together: states of rest worked out by hand, and the control laws.

use crate::near::{ROUNDING, assert_near, assert_within};
use forcefeel_model::compensator::Compensator;
use forcefeel_model::loader::{Compliant, DesignPlant, IdealFeel, Rigid, System};
use forcefeel_model::parameters::Parameters;
use forcefeel_model::units;

const IN: f64 = units::LENGTH.si_per_us;
const LB: f64 = units::FORCE.si_per_us;
const PSI: f64 = units::PRESSURE.si_per_us;
const FLOW: f64 = units::FLOW.si_per_us;

/// A state of rest in U.S. units: the oil carries the pilot's push of 96 lb, and the valve makes up for what it leaks.
struct Rest {
    force: f64,
    pressure: f64,
    flow: f64,
    test_signal: f64,
    stretch: f64,
}

fn rest() -> Rest {
    let force = -3012.0 / 5.9; // -R_p F_p / (alpha R_b)
    let pressure = force / 2.36; // F_c / A
    let flow = 0.0102 * pressure; // q = q_i - C_p p = 0
    Rest { force, pressure, flow, test_signal: flow / (5.45 * 1.56), stretch: force / 6107.86 }
}

/// Asserts that each rate is rounding beside `scale`, what one of its terms alone would give.
fn assert_rest(rates: &[f64], scale: &[f64]) {
    for (rate, scale) in rates.iter().zip(scale) {
        assert_within(*rate, 0.0, 10.0 * ROUNDING * scale);
    }
}

#[test]
fn compliant_loader_rests_on_a_stretched_link() {
    let model =
        Compliant { parameters: Parameters::elevator(), compensator: Compensator::none(&Parameters::elevator()) };
    let Rest { force, pressure, flow, test_signal, stretch } = rest();
    let x_p = 0.3;
    let x_b = (x_p - stretch) / 0.59;
    let x = [x_p * IN, pressure * PSI, flow * FLOW, 0.0, 0.0, 0.0, x_b * IN, 0.0];
    let u = [96.0 * LB, test_signal];
    assert_rest(
        &model.derivative(&x, &u),
        // F_c / c, then the rates that flow, current, nothing and the pilot alone would cause
        &[
            force.abs() * LB,
            4.0e6 / 11.7 * PSI,
            1.0,
            377.0 * 377.0 * flow.abs() * FLOW,
            0.0,
            0.0,
            1.0,
            3012.0 / 37.4 * 10.0 * IN,
        ],
    );
    let [theta, delta, piston, f_c, e_p, i, q] = model.outputs(&x, &u);
    assert_near(theta, x_b / 10.0, ROUNDING);
    assert_near(delta, 0.0, 0.0);
    assert_near(piston, x_p * IN, ROUNDING);
    assert_near(f_c, force * LB, ROUNDING);
    assert_near(e_p, 7.632 * x_p, ROUNDING);
    assert_near(i, 1.56e-3 * test_signal, ROUNDING);
    assert_within(q, 0.0, ROUNDING * flow.abs() * FLOW);
}

#[test]
fn rigid_loader_rests_under_the_same_forces() {
    let model = Rigid { parameters: Parameters::elevator(), compensator: Compensator::none(&Parameters::elevator()) };
    let Rest { pressure, flow, test_signal, .. } = rest();
    let x = [0.3 * IN, 0.0, pressure * PSI, flow * FLOW, 0.0, 0.0, 0.0];
    let u = [96.0 * LB, test_signal];
    let scale = [
        0.0,
        3012.0 / 37.4 * 5.9 * IN,
        4.0e6 / 11.7 * PSI * flow.abs(),
        1.0,
        377.0 * 377.0 * flow.abs() * FLOW,
        0.0,
        0.0,
    ];
    assert_rest(&model.derivative(&x, &u), &scale);
    assert_near(model.outputs(&x, &u)[0], 0.03 / 0.59, ROUNDING); // theta = x_p / (alpha R_b)
}

#[test]
fn rigid_piston_carries_the_column_over_the_linkage_ratio() {
    let model = Rigid { parameters: Parameters::elevator(), compensator: Compensator::none(&Parameters::elevator()) };
    let rates = model.derivative(&[0.0; 7], &[10.0 * LB, 0.0]);
    assert_near(rates[1], 0.59 * 10.0 * 313.75 / 37.4 * IN, ROUNDING); // alpha R_b theta''
}

#[test]
fn design_plant_follows_the_current_without_valve_dynamics_and_holds_the_pilots_force() {
    let plant = DesignPlant { parameters: Parameters::elevator(), pilot_arm: 31.375 * IN };
    let Rest { pressure, test_signal, stretch, .. } = rest();
    let x_b = (0.3 - stretch) / 0.59;
    // The feel rests at 3012 / 9600 rad under the torque of the pilot's 96 lb.
    let x = [0.3 * IN, pressure * PSI, 0.313_75, 0.0, x_b * IN, 0.0, 96.0 * LB];
    let rates = plant.derivative(&x, &[test_signal]);
    let scale =
        [pressure.abs() * LB, 4.0e6 / 11.7 * PSI * pressure.abs(), 0.0, 160.0, 0.0, 3012.0 / 37.4 * 10.0 * IN, 0.0];
    assert_rest(&rates, &scale);
    assert_near(plant.outputs(&x, &[0.0])[0], 0.313_75 - x_b / 10.0, ROUNDING);
}

#[test]
fn ideal_feel_deflects_by_torque_over_stiffness() {
    let feel = IdealFeel { parameters: Parameters::elevator() };
    let x = [0.313_75, 0.0]; // 96 lb * 31.375 in / 9600 lb in/rad
    assert_rest(&feel.derivative(&x, &[96.0 * LB]), &[0.0, 160.0]);
    assert_near(feel.outputs(&x, &[0.0])[0], 0.313_75, 0.0);
}

#[test]
fn original_law_is_the_position_loop_of_the_report() {
    let law = Compensator::original(&Parameters::elevator());
    let x = [0.2 * IN, 1e6, 1.5, 7.0, 3.0, 4.0, 5.0];
    assert_near(law.command(&x), 1.5 - 7.632 * 0.2, ROUNDING); // e = delta - K_3 x_p
    // T = -G_max K_1 F_c, in N m V/rad
    assert_near(law.feel_torque(10.0 * LB), -28_800.0 * LB * IN * 0.05, ROUNDING);
    let alone = Compensator::position_loop(&Parameters::elevator());
    assert_near(alone.command(&x), -7.632 * 0.2, ROUNDING);
    assert_near(alone.feel_torque(10.0 * LB), 0.0, 0.0);
}

#[test]
fn state_feedback_weighs_every_state_and_shows_the_computer_the_pilots_torque() {
    let gains = [1.0, -2.0, 3.0, -4.0, 5.0, -6.0, 7.0];
    let law = Compensator::state_feedback(&Parameters::elevator(), gains);
    assert_near(law.command(&[7.0, 6.0, 5.0, 4.0, 3.0, 2.0, 1.0]), 4.0, 0.0); // 7 - 12 + 15 - 16 + 15 - 12 + 7
    assert_near(law.feel_torque(rest().force * LB), 3012.0 * LB * IN, ROUNDING);
}

#[test]
fn open_amplifier_receives_nothing() {
    let law = Compensator::<f64>::none(&Parameters::elevator());
    assert_near(law.command(&[1.0; 7]), 0.0, 0.0);
    assert_near(law.feel_torque(1.0), 0.0, 0.0);
}
