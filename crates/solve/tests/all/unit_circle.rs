//! Poles inside the unit circle, told by powers: of matrices whose poles are known.

use forcefeel_solve::unit_circle::inside;
use nalgebra::{DMatrix, SMatrix};

/// A matrix with a pair of poles of this magnitude and angle beside `0.9`, `-0.3` and `0`, in coordinates that are far from square
/// and whose units are `10^4` apart.
fn matrix(magnitude: f64, turn: f64) -> Vec<f64> {
    let (re, im) = (magnitude * turn.cos(), magnitude * turn.sin());
    let mut a = SMatrix::<f64, 5, 5>::from_diagonal(&[re, re, 0.9, -0.3, 0.0].into());
    (a[(0, 1)], a[(1, 0)]) = (im, -im);
    let place = [0.0, 1.0, 2.0, 3.0, 4.0_f64];
    let skewed = DMatrix::from_fn(5, 5, |i, j| 10.0_f64.powf(place[i]) / (1.0 + (place[i] - 0.5 * place[j]).powi(2)));
    let inverse = skewed.clone().try_inverse().expect("a regular matrix");
    (skewed * a * inverse).transpose().as_slice().to_vec()
}

#[test]
fn poles_on_both_sides_of_the_circle_are_told_apart() {
    for turn in [0.0, 1e-3, 0.7, core::f64::consts::FRAC_PI_2, 3.1] {
        for off in [0.3, 1e-2, 1e-4, 1e-5] {
            for magnitude in [1.0 - off, 1.0 + off] {
                let verdict = inside(&matrix(magnitude, turn), 5, 1).expect("threads");
                assert_eq!(verdict, [Some(magnitude < 1.0)], "{magnitude} at {turn}");
            }
        }
    }
}

#[test]
fn poles_on_the_circle_and_what_is_no_number_are_not_told() {
    let mut matrices = matrix(1.0, 0.7);
    matrices.extend([f64::NAN; 25]);
    assert_eq!(inside(&matrices, 5, 2).expect("threads"), [None, None]);
}
