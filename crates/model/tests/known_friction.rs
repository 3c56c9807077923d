//! Dry friction that a law knows: given back in motion, a play at rest that lets go.

mod near;

use forcefeel_model::known_friction::FRICTION_NUMBERS;
use forcefeel_model::observer::{MOST_STATES, NUMBERS, Observer, SAMPLED, Says};
use near::assert_within;

/// `F`, `M` in N m, `v_s` in rad/s.
const LEVEL: f64 = 3.5;
const MARGIN: f64 = 0.7;
const SLOW: f64 = 1e-3;
/// Length of `[xi; y; delta; delta']`.
const KNOWN: usize = MOST_STATES + SAMPLED + 2;
const TORQUE: usize = NUMBERS - FRICTION_NUMBERS - MOST_STATES * (SAMPLED + 1) - KNOWN;
const RATE: usize = NUMBERS - FRICTION_NUMBERS;

/// A law whose first state is the torque on the column, its second the column's rate, and which moves the first by the friction.
fn law(level: f64, leak: f64) -> Observer<f64> {
    let mut numbers = [0.0; NUMBERS];
    numbers[TORQUE] = 1.0;
    numbers[RATE + 1] = 1.0;
    numbers[RATE + KNOWN] = -0.25;
    numbers[NUMBERS - 4..].copy_from_slice(&[level, MARGIN, SLOW, leak]);
    Observer::from_numbers(&numbers)
}

fn says(law: &Observer<f64>, torque: f64, rate: f64, heard: f64) -> Says<f64> {
    let mut xi = [0.0; MOST_STATES];
    (xi[0], xi[1]) = (torque, rate);
    law.says(&xi, &[0.0; SAMPLED], [0.0; 2], Some(heard))
}

#[test]
fn in_motion_the_friction_is_told_to_the_plant_and_the_hand_is_heard_whatever_was_heard_before() {
    let law = law(LEVEL, 0.01);
    for rate in [0.1, 1.0, -0.1, -1.0] {
        for heard in [-20.0, 0.0, 20.0] {
            let found = says(&law, 2.0, rate, heard);
            // f is within (v_s / v)^2 / 2 of F.
            assert_within(found.friction, LEVEL * rate.signum(), LEVEL * SLOW * SLOW / rate / rate);
            assert_within(found.torque, 2.0, LEVEL * SLOW * SLOW / rate / rate);
            let next = law.next(&[0.0; MOST_STATES], &[0.0; SAMPLED], 0.0, Some(found.friction));
            assert_within(next[0], -0.25 * found.friction, 1e-15);
        }
    }
}

#[test]
fn at_rest_what_is_heard_stays_until_the_friction_cannot_hold_it() {
    let (law, play) = (law(LEVEL, 0.0), LEVEL + MARGIN);
    let mut heard = 0.0;
    for (torque, expected) in
        [(play, 0.0), (-play, 0.0), (play + 1.0, 1.0), (1.0, 1.0), (1.0 - play, 1.0), (-play - 2.0, -2.0)]
    {
        heard = says(&law, torque, 0.0, heard).torque;
        assert_within(heard, expected, 1e-14);
    }
}

#[test]
fn at_rest_what_is_heard_drifts_to_what_is_measured() {
    let (leak, torque) = (0.025, 2.0);
    let law = law(LEVEL, leak);
    let mut heard = 0.0;
    for n in 1..=200 {
        heard = says(&law, torque, 0.0, heard).torque;
        assert_within(heard, torque * (1.0 - (1.0 - leak).powi(n)), 1e-13);
    }
}

#[test]
fn law_without_friction_beside_one_with_it_hears_all() {
    let law = law(0.0, 0.0);
    for rate in [0.0, 1e-3, -2.0] {
        let found = says(&law, 1.7, rate, -5.0);
        assert!(found.friction.abs() < f64::MIN_POSITIVE);
        assert_within(found.torque, 1.7, 0.0);
    }
}
