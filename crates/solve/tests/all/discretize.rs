//! State transition over one step against systems whose solution is known in closed form.

use crate::rows::rows;
use forcefeel_solve::{discretize, propagated};
use nalgebra::DMatrix;

/// The exponential scales and squares, which costs a few more roundings than a sum.
const EXPONENTIAL: f64 = 1e-13;

fn assert_close(found: &DMatrix<f64>, expected: &DMatrix<f64>) {
    let error = (found - expected).amax();
    assert!(error <= EXPONENTIAL * expected.amax(), "expected {expected} got {found}, error {error:e}");
}

#[test]
fn double_integrator_moves_by_half_the_square_of_the_step() {
    let h = 0.03;
    let (phi, input) = discretize(&rows([[0.0, 1.0], [0.0, 0.0]]), &rows([[0.0], [1.0]]), h);
    assert_close(&phi, &rows([[1.0, h], [0.0, 1.0]]));
    assert_close(&input, &rows([[h * h / 2.0], [h]]));
}

#[test]
fn scalar_lag_decays_by_the_exponential_of_the_step() {
    let tau = 0.2_f64;
    for h in [1e-5, 0.01, 0.2, 3.0] {
        let decay = (-h / tau).exp();
        let (phi, input) = discretize(&rows([[-1.0 / tau]]), &rows([[1.0 / tau]]), h);
        assert_close(&phi, &rows([[decay]]));
        assert_close(&input, &rows([[-(-h / tau).exp_m1()]]));
    }
}

#[test]
fn constant_state_stays_and_drives_the_rest() {
    // x' = a x + g f + b u, f' = 0: like the pilot force of the design plant, and it makes the state matrix singular.
    let (a, g, b, h) = (-4.0_f64, 7.0, 3.0, 0.1);
    let (phi, input) = discretize(&rows([[a, g], [0.0, 0.0]]), &rows([[b], [0.0]]), h);
    let reach = (a * h).exp_m1() / a;
    assert_close(&phi, &rows([[(a * h).exp(), g * reach], [0.0, 1.0]]));
    assert_close(&input, &rows([[b * reach], [0.0]]));
}

#[test]
fn oscillator_turns_by_its_angle() {
    let (w, h) = (5.0_f64, 0.7);
    let (sin, cos) = (w * h).sin_cos();
    let (phi, input) = discretize(&rows([[0.0, w], [-w, 0.0]]), &rows([[0.0, 1.0], [w, 0.0]]), h);
    assert_close(&phi, &rows([[cos, sin], [-sin, cos]]));
    // Two inputs: a force w u_1 and a drift u_2.
    assert_close(&input, &rows([[1.0 - cos, sin / w], [sin, (cos - 1.0) / w]]));
}

#[test]
fn stiff_and_slow_states_live_in_one_step() {
    // The pole of the link's damper and a feel pole; they are coupled one way, so the closed form stays simple.
    let (fast, slow, gain, h) = (-3e4_f64, -2.0_f64, 1e3, 1e-3);
    let (phi, _) = discretize(&rows([[slow, gain], [0.0, fast]]), &rows([[0.0], [0.0]]), h);
    let (slow_decay, fast_decay) = ((slow * h).exp(), (fast * h).exp());
    assert_close(&phi, &rows([[slow_decay, gain * (fast_decay - slow_decay) / (fast - slow)], [0.0, fast_decay]]));
}

#[test]
#[should_panic(expected = "state matrix must be square")]
fn state_matrix_must_fit_the_input_matrix() {
    let _ = discretize(&DMatrix::zeros(2, 2), &DMatrix::zeros(3, 1), 0.1);
}

#[test]
fn a_matrix_too_large_for_its_digits_has_no_transition() {
    let of = |number: f64| discretize(&rows([[-1.0, number], [0.0, -1.0]]), &rows([[0.0], [0.0]]), 1.0).0;
    let (large, decayed) = (1e10, (-1.0_f64).exp());
    let expected = rows([[decayed, large * decayed], [0.0, decayed]]);
    let error = (of(large) - &expected).component_div(&expected.map(|entry| entry.max(1.0))).amax();
    assert!(error <= EXPONENTIAL, "{error:e}");
    for beyond in [1e11, 1e200, f64::MAX, f64::INFINITY, f64::NAN] {
        assert!(of(beyond).iter().all(|entry| entry.is_nan()));
    }
}

#[test]
fn states_that_double_and_turn_are_those_of_powers() {
    // x doubles and takes in one, y turns with z: 2^k - 1, and a turn of a quarter each step.
    let phi = rows([[2.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]);
    let states = propagated(&phi, &[0.0, 1.0, 0.0], &[1.0, 0.0, 0.0].repeat(5));
    let turned = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0], [1.0, 0.0], [0.0, 1.0]];
    for (k, (state, [y, z])) in (0..).zip(states.chunks(3).zip(turned)) {
        assert_eq!(state, [f64::powi(2.0, k) - 1.0, y, z]);
    }
    assert_eq!(states.len(), 18);
}
