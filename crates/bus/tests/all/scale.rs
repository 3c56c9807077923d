//! Units: what a drive shows of a loader's sensors, and reads back, is the same.

use forcefeel_bus::drive::State;
use forcefeel_bus::scale::{Scale, Wiring};
use forcefeel_model::parameters::{COUNT, DriveKind, Parameters, TABLE};

/// The defaults of an electric loader.
fn parameters() -> Parameters<f64> {
    let values: [f64; COUNT] = core::array::from_fn(|k| {
        let of_valve = TABLE[k].drive() == Some(DriveKind::Hydraulic);
        let off = TABLE[k].off_si();
        if of_valve { off.unwrap_or(0.0) } else { off.unwrap_or_else(|| TABLE[k].default_si()) }
    });
    Parameters::from_values(&values)
}

fn read_back(wiring: Wiring, sensors: [f64; 4], current: f64) -> [f64; 4] {
    let scale = Scale::new(&parameters(), wiring);
    let shown = scale.shown(sensors, current, 0.0);
    let state = State { position: shown.position, torque: shown.torque, sensors: shown.sensors, ..State::NONE };
    scale.sensors(&state)
}

fn near(a: [f64; 4], b: [f64; 4]) {
    for (a, b) in a.into_iter().zip(b) {
        // Of numbers of about 1 to 100, a few roundings.
        assert!((a - b).abs() < 1e-12, "{a} {b}");
    }
}

#[test]
fn sensors_come_back_through_a_reversed_gear() {
    let wiring = Wiring { gear: -3.0, zero: 0.2, load_cell: Some(400.0), column: Some([-0.5, 0.1]), grip: Some(100.0) };
    near(read_back(wiring, [12.0, 0.01, -0.008, 5.0], 0.3), [12.0, 0.01, -0.008, 5.0]);
}

#[test]
fn a_turn_of_the_column_encoder_begins_anew_within_its_travel() {
    let wiring = Wiring { gear: 1.0, zero: 0.0, load_cell: Some(1.0), column: Some([1.0, 0.9]), grip: None };
    let scale = Scale::new(&parameters(), wiring);
    let state = State { position: 0.0, torque: 0.0, sensors: [0.5, 0.05, f64::NAN], ..State::NONE };
    let base = scale.sensors(&state)[2];
    let expected = core::f64::consts::TAU * parameters().column.base_arm * 0.15;
    assert!((base - expected).abs() < 1e-12, "{base} {expected}");
}

#[test]
fn without_sensors_force_and_column_follow_from_torque_and_link() {
    let of = parameters();
    let wiring = Wiring { gear: 2.0, zero: 0.0, load_cell: None, column: None, grip: None };
    let current = 1.5;
    let force = current * of.motor.torque_constant / of.transmission.travel;
    let base = 0.01;
    let position = of.linkage.ratio * base + force / of.linkage.stiffness;
    near(read_back(wiring, [0.0, position, 0.0, 0.0], current), [force, position, base, 0.0]);
    assert!((Scale::new(&of, wiring).torque(current) - 2.0 * current * of.motor.torque_constant).abs() < 1e-12);
}
