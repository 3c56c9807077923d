//! The feel from one time to another: against the matrix exponential, and where a torque holds it.

use forcefeel_model::parameters::{Feel, Parameters};
use forcefeel_solve::discretize;
use forcefeel_solve::feel_transition::{feel_step, feel_transition};
use nalgebra::DMatrix;

/// Some tens of roundings of either way.
const ROUNDING: f64 = 1e-13;

/// Natural frequency in rad/s, beside one the size of a transition's numbers.
const FREQUENCY: f64 = 9.0;

fn feel(damping_ratio: f64) -> Feel<f64> {
    let stiffness = 1085.0;
    let (inertia, damping) = Feel::from_frequency(FREQUENCY, damping_ratio, stiffness);
    Feel { inertia, damping, stiffness, ..Parameters::elevator().feel }
}

/// None, little, as much as makes it critical and nearly so, a lot.
const DAMPING_RATIOS: [f64; 7] = [0.0, 0.3, 1.0 - 1e-9, 1.0, 1.0 + 1e-9, 1.5, 20.0];

#[test]
fn transition_is_the_exponential_at_any_damping() {
    for damping_ratio in DAMPING_RATIOS {
        let feel = feel(damping_ratio);
        let (back, drag) = (feel.acceleration(1.0, 0.0, 0.0), feel.acceleration(0.0, 1.0, 0.0));
        let a = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, back, drag]);
        for t in [0.0, 1e-6, 5e-4, 0.1, 2.0] {
            let expected = discretize(&a, &DMatrix::zeros(2, 1), t).0;
            let off = (DMatrix::from_iterator(2, 2, feel_transition(&feel, t).iter().copied()) - &expected).amax();
            // What has decayed keeps the roundings of what it was.
            assert!(off <= ROUNDING * FREQUENCY, "{damping_ratio} at {t}: {off:e}");
        }
    }
}

#[test]
fn heavily_damped_feel_comes_back_without_overflow() {
    // e^s cosh r: 700 and more in either exponent.
    let found = feel_transition(&feel(20.0), 100.0);
    assert!(found.iter().all(|number| number.is_finite()));
    // The slow mode alone is left: w / (2 zeta) to first order.
    assert!((found.m11.ln() / (-100.0 * FREQUENCY / 40.0) - 1.0).abs() < 1e-3, "{found}");
}

#[test]
fn feel_stays_where_a_torque_holds_it() {
    for damping_ratio in DAMPING_RATIOS {
        let feel = feel(damping_ratio);
        let step = feel_step(&feel, 5e-4);
        let (held, torque) = (0.1, 0.1 * feel.stiffness);
        for (row, expected) in [held, 0.0].into_iter().enumerate() {
            let found = step[(row, 0)] * held + step[(row, 2)] * torque;
            assert!((found - expected).abs() <= ROUNDING * held, "{damping_ratio}: {found}");
        }
    }
}
