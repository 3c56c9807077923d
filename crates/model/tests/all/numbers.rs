//! The number types of the model: single precision follows double, and dual numbers differentiate it.

use crate::near::{ROUNDING, assert_within};
use core::array;
use forcefeel_model::Scalar;
use forcefeel_model::compensator::Compensator;
use forcefeel_model::dual::Dual;
use forcefeel_model::loader::{Compliant, DesignPlant, Rigid, System};
use forcefeel_model::parameters::Parameters;

/// Some tens of roundings of single precision (6e-8 each), as a share of the terms of a sum.
const SINGLE: f64 = 2e-6;
/// What a step of a millionth leaves of sixteen digits in a central difference, with a digit to spare.
const DIFFERENCE: f64 = 1e-9;

/// Gains of the size that the design gives, none of them zero.
const GAINS: [f64; 7] = [-250.0, -5e-9, 23.0, 1.1, 23.0, -0.7, 0.01];

/// Sizes of states and inputs in SI units: displacement, velocity, pressure, flow and its rate, feel angle and rate,
/// pilot force, voltage.
const RIGID_SIZES: [f64; 9] = [0.05, 0.4, 3e6, 5e-4, 0.1, 0.3, 3.0, 400.0, 5.0];
const COMPLIANT_SIZES: [f64; 10] = [0.05, 3e6, 5e-4, 0.1, 0.3, 3.0, 0.08, 0.7, 400.0, 5.0];
const PLANT_SIZES: [f64; 8] = [0.05, 3e6, 0.3, 3.0, 0.08, 0.7, 400.0, 5.0];

/// The nearest number of single precision.
fn narrow(value: f64) -> f32 {
    1.0_f32.constant(value)
}

fn rigid<S: Scalar>(one: S) -> impl Fn(&[S]) -> Vec<S> {
    let parameters = Parameters::elevator().map(|value| one.constant(value));
    let compensator = Compensator::state_feedback(&parameters, GAINS.map(|value| one.constant(value)));
    move |z| evaluate(&Rigid { parameters, compensator }, z)
}

fn compliant<S: Scalar>(one: S) -> impl Fn(&[S]) -> Vec<S> {
    let parameters = Parameters::elevator().map(|value| one.constant(value));
    let compensator = Compensator::state_feedback(&parameters, GAINS.map(|value| one.constant(value)));
    move |z| evaluate(&Compliant { parameters, compensator }, z)
}

fn plant<S: Scalar>(one: S) -> impl Fn(&[S]) -> Vec<S> {
    let plant = DesignPlant {
        parameters: Parameters::elevator().map(|value| one.constant(value)),
        pilot_arm: one.constant(0.8),
    };
    move |z| evaluate(&plant, z)
}

/// Rates and outputs in one list, from states and inputs in one list.
fn evaluate<S: Scalar, const X: usize, const U: usize, const Y: usize>(
    system: &impl System<S, X, U, Y>,
    z: &[S],
) -> Vec<S> {
    let (x, u) = (array::from_fn(|k| z[k]), array::from_fn(|k| z[X + k]));
    [system.derivative(&x, &u).as_slice(), &system.outputs(&x, &u)].concat()
}

/// The point number `sample` of a fixed scatter within the sizes.
fn point(sizes: &[f64], sample: u8) -> Vec<f64> {
    let mut angle = f64::from(sample);
    let next = |size: &f64| {
        angle += 0.7;
        size * (angle * angle).sin()
    };
    sizes.iter().map(next).collect()
}

/// Magnitudes of what each state and input of its size adds to each result, summed: the yardstick for sums that cancel.
fn scales(model: &impl Fn(&[f64]) -> Vec<f64>, sizes: &[f64]) -> Vec<f64> {
    let mut total = vec![0.0; model(sizes).len()];
    for k in 0..sizes.len() {
        let mut alone = vec![0.0; sizes.len()];
        alone[k] = sizes[k];
        for (sum, part) in total.iter_mut().zip(model(&alone)) {
            *sum += part.abs();
        }
    }
    total
}

fn check_single(double: impl Fn(&[f64]) -> Vec<f64>, single: impl Fn(&[f32]) -> Vec<f32>, sizes: &[f64]) {
    let scales = scales(&double, sizes);
    for sample in 0..20 {
        let z = point(sizes, sample);
        let short: Vec<f32> = z.iter().map(|&z| narrow(z)).collect();
        for ((exact, rounded), scale) in double(&z).iter().zip(single(&short)).zip(&scales) {
            assert_within(f64::from(rounded), *exact, SINGLE * scale);
        }
    }
}

fn check_slopes(double: impl Fn(&[f64]) -> Vec<f64>, dual: impl Fn(&[Dual]) -> Vec<Dual>, sizes: &[f64]) {
    let scales = scales(&double, sizes);
    let z = point(sizes, 3);
    let moved = |k: usize, by: f64| {
        let mut moved = z.clone();
        moved[k] += by;
        double(&moved)
    };
    for (k, size) in sizes.iter().enumerate() {
        let mut along: Vec<_> = z.iter().copied().map(Dual::constant).collect();
        along[k] = Dual::variable(z[k]);
        let duals = dual(&along);
        let small = 1e-6 * size;
        let (up, down, far, here) = (moved(k, small), moved(k, -small), moved(k, *size), double(&z));
        for (row, scale) in scales.iter().enumerate() {
            let Dual { value, slope } = duals[row];
            assert_within(value, here[row], 0.0);
            assert_within((up[row] - down[row]) / 2e-6, slope * size, DIFFERENCE * scale);
            // The model is linear: a step as large as the state itself differs from the slope by rounding only.
            assert_within(far[row] - here[row], slope * size, ROUNDING * scale);
        }
    }
}

#[test]
fn single_precision_follows_double() {
    check_single(rigid(1.0), rigid(1.0_f32), &RIGID_SIZES);
    check_single(compliant(1.0), compliant(1.0_f32), &COMPLIANT_SIZES);
    check_single(plant(1.0), plant(1.0_f32), &PLANT_SIZES);
}

#[test]
fn dual_numbers_give_the_slopes_of_the_models() {
    check_slopes(rigid(1.0), rigid(Dual::constant(1.0)), &RIGID_SIZES);
    check_slopes(compliant(1.0), compliant(Dual::constant(1.0)), &COMPLIANT_SIZES);
    check_slopes(plant(1.0), plant(Dual::constant(1.0)), &PLANT_SIZES);
}

#[test]
fn dual_numbers_give_the_slopes_of_the_nonlinear_orifice() {
    let (exact, dual) = (Parameters::elevator().valve, Parameters::elevator().valve.map(Dual::constant));
    let (i, p) = (0.004, 2.5e6);
    let (di, dp) = (1e-6 * i, 1e-5 * p); // the error of a central difference, (dp/p)^2, and its rounding are below 1e-9
    let along_i = (exact.orifice_flow(i + di, p) - exact.orifice_flow(i - di, p)) / (2.0 * di);
    let along_p = (exact.orifice_flow(i, p + dp) - exact.orifice_flow(i, p - dp)) / (2.0 * dp);
    let slope_i = dual.orifice_flow(Dual::variable(i), Dual::constant(p)).slope;
    let slope_p = dual.orifice_flow(Dual::constant(i), Dual::variable(p)).slope;
    assert_within(along_i, slope_i, DIFFERENCE * slope_i.abs());
    assert_within(along_p, slope_p, DIFFERENCE * slope_p.abs());
}

#[test]
fn single_precision_follows_double_through_the_orifices_root() {
    let (double, single) = (Parameters::elevator().valve, Parameters::elevator().valve.map(narrow));
    for (i, p) in [(0.004, 2.5e6), (-0.015, 8.0e6), (0.001, -3.0e6)] {
        let exact = double.orifice_flow(i, p);
        let rounded = f64::from(single.orifice_flow(narrow(i), narrow(p)));
        assert_within(rounded, exact, SINGLE * exact.abs());
    }
}
