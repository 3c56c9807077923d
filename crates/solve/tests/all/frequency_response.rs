//! The frequency response, beside what elimination of the whole matrix gives and beside closed forms.

use forcefeel_solve::frequency_response::frequency_response;
use forcefeel_solve::random::RandomStream;
use nalgebra::{Complex, DMatrix, DVector};

/// Of a response, by rounding of two eliminations of matrices whose condition is some hundreds.
const ROUNDING: f64 = 1e-12;

#[test]
fn response_is_that_of_the_whole_matrix() {
    let mut random = RandomStream::new(3, 0);
    for n in [1, 2, 3, 8, 21] {
        let mut numbers = |rows, columns| DMatrix::from_fn(rows, columns, |_, _| random.normal());
        let (a, b, c) = (numbers(n, n), numbers(n, 1).column(0).into_owned(), numbers(n, 1).column(0).into_owned());
        let points: Vec<_> = (1..9).map(|k| Complex::from_polar(f64::from(k), 0.4 * f64::from(k))).collect();
        let found = frequency_response(a.clone(), &b, &c, points.iter().copied());
        for (p, found) in points.iter().zip(found) {
            let whole = DMatrix::from_diagonal_element(n, n, *p) - a.map(Complex::from);
            let expected = c.map(Complex::from).dot(&whole.lu().solve(&b.map(Complex::from)).expect("regular"));
            assert!((found - expected).norm() < ROUNDING * expected.norm().max(1.0), "{n}: {found} {expected}");
        }
    }
}

#[test]
fn response_of_a_chain_of_integrators_is_a_power() {
    // c (p - A)^-1 b = 1 / p^3; the states in an order that is no Hessenberg matrix.
    let a = DMatrix::from_row_slice(3, 3, &[0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0]);
    let (b, c) = (DVector::from_vec(vec![1.0, 0.0, 0.0]), DVector::from_vec(vec![0.0, 1.0, 0.0]));
    let p = Complex::new(0.0, 1e-3);
    let found = frequency_response(a.clone(), &b, &c, [p].into_iter())[0];
    assert!((found * p * p * p - 1.0).norm() < ROUNDING, "{found}");
    let at_pole = frequency_response(a, &b, &c, [Complex::ZERO].into_iter())[0];
    assert!(!at_pole.norm().is_finite(), "{at_pole}");
}
