//! Matrices of the models against the models themselves: they are linear, so the matrices must reproduce them.

use forcefeel_model::Scalar;
use forcefeel_model::compensator::Compensator;
use forcefeel_model::dual::Dual;
use forcefeel_model::loader::{Compliant, System};
use forcefeel_model::parameters::Parameters;
use forcefeel_solve::{StateSpace, linearize};
use nalgebra::{DVector, SVector};

/// Some roundings beside the largest term of a sum.
const ROUNDING: f64 = 1e-14;

fn compliant<S: Scalar>(one: S) -> Compliant<S> {
    let parameters = Parameters::elevator().map(|value| one.constant(value));
    Compliant { parameters, compensator: Compensator::original(&parameters) }
}

/// Asserts `found = m [x; u]` beside the magnitudes of the terms, with the columns of `m` split over `a` and `b`.
fn assert_product(found: &[f64], (a, b): (&nalgebra::DMatrix<f64>, &nalgebra::DMatrix<f64>), x: &[f64], u: &[f64]) {
    let (x, u) = (DVector::from_column_slice(x), DVector::from_column_slice(u));
    let product = a * &x + b * &u;
    let scale = a.abs() * x.abs() + b.abs() * u.abs();
    for ((found, product), scale) in found.iter().zip(&product).zip(&scale) {
        assert!((found - product).abs() <= ROUNDING * scale, "expected {product:e}, got {found:e}");
    }
}

#[test]
fn matrices_reproduce_the_model() {
    let StateSpace { a, b, c, d } = linearize(&compliant(Dual::constant(1.0)), &[0.0; 8], &[0.0; 2]);
    let x = [0.02, -2e6, 3e-4, 0.07, 1.3, -4.0, 0.05, 0.6];
    let u = [300.0, -1.5];
    assert_product(&compliant(1.0).derivative(&x, &u), (&a, &b), &x, &u);
    assert_product(&compliant(1.0).outputs(&x, &u), (&c, &d), &x, &u);
}

#[test]
fn matrices_are_the_same_at_every_point_of_a_linear_model() {
    let at_rest = linearize(&compliant(Dual::constant(1.0)), &[0.0; 8], &[0.0; 2]);
    let away = linearize(&compliant(Dual::constant(1.0)), &SVector::<f64, 8>::from_element(3.0).into(), &[7.0, -2.0]);
    assert_eq!(at_rest, away);
}
