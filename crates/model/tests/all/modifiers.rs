//! What is set around a feel comes evenly, and the shaker swings at its frequency, whatever the number type.

use core::f64::consts::TAU;
use forcefeel_model::Scalar;
use forcefeel_model::modifiers::{FeelModifiers, ModifierRamp, ModifierRates};

const PERIOD_S: f64 = 1e-3;
const FREQUENCY: f64 = 20.0 * TAU;

fn pace<S: Scalar>(like: S, trim_rate: f64) -> ModifierRates<S> {
    let [trim_rate, shaker_frequency, period] = [trim_rate, FREQUENCY, PERIOD_S].map(|value| like.constant(value));
    ModifierRates { trim_rate, shaker_frequency, period }
}

#[test]
fn each_goes_at_its_rate_and_arrives() {
    let (wanted, pace) =
        (FeelModifiers { trim_rad: 0.05, stiffness_factor: 1.5, shaker: 1.0 }, pace(0.0, f64::INFINITY));
    let mut led = ModifierRamp::at(0.0);
    let first = led.step(&wanted, &pace);
    // 0.1 rad/s, 1 and 5 a second, in a millisecond
    assert_eq!(first, FeelModifiers { trim_rad: 1e-4, stiffness_factor: 1.001, shaker: 0.005 });
    for _ in 0..501 {
        led.step(&wanted, &pace);
    }
    assert_eq!(led.step(&wanted, &pace), wanted);
}

#[test]
fn a_feel_that_is_trimmed_slower_is_led_slower() {
    let wanted = FeelModifiers { trim_rad: -1.0, ..FeelModifiers::NONE };
    assert!((ModifierRamp::at(0.0).step(&wanted, &pace(0.0, 0.04)).trim_rad + 4e-5).abs() < 1e-18); // rounding
}

#[test]
fn what_is_no_number_changes_nothing() {
    let mut led = ModifierRamp::at(0.25);
    let nothing = FeelModifiers { trim_rad: f64::NAN, stiffness_factor: f64::INFINITY, shaker: f64::NAN };
    assert_eq!(led.step(&nothing, &pace(0.0, 1.0)), FeelModifiers { trim_rad: 0.25, ..FeelModifiers::NONE });
}

#[test]
fn the_shaker_swings_as_a_sine_of_the_time_also_after_an_hour() {
    let (pace, single) = (pace(0.0, 1.0), pace(0.0_f32, 1.0));
    let (mut led, mut led_single) = (ModifierRamp::at(0.0), ModifierRamp::at(0.0_f32));
    for k in 0..3_600_000_u32 {
        let (swing, of_single) = (led.swing(0.5, &pace), led_single.swing(0.5, &single));
        if k % 1000 < 50 {
            let turns = f64::from(k % 50) / 50.0; // 20 Hz at 1 kHz
            let expected = 0.5 * (TAU * turns).sin();
            assert!((swing - expected).abs() < 1e-6, "{k}: {swing} {expected}"); // 72,000 turns of rounding
            assert!(of_single.abs() <= 0.5, "{k}: {of_single}");
        }
    }
    assert!(led.swing(0.0, &pace).abs() == 0.0);
}
