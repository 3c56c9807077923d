//! State transition over one step with the input held.
//!
//! `[Phi] = exp(A h)`, `[H] = ([Phi] - [I]) A^-1 B` (symbols of the report). `A` is singular where a state is constant, so both
//! are read off one exponential: `exp([A B; 0 0] h) = [Phi H; 0 I]`.

use nalgebra::linalg::balancing::balance_parlett_reinsch;
use nalgebra::{DMatrix, DVector};

/// Largest number of `A h`: halving it until its series converges leaves slow states a millionth of their digits, and nalgebra judges
/// the series by the 27th power of the matrix, which is still a number.
const LARGEST: f64 = 1e10;

fn within_range(z: &DMatrix<f64>) -> bool {
    z.iter().all(|entry| entry.abs() <= LARGEST)
}

/// Size up to which so many terms of the series are exact to rounding: `0.5^17 / 17! = 2e-20`.
const SMALL: f64 = 0.5;
const TERMS: u32 = 17;

/// More than a matrix of 100 rows of the largest numbers takes.
const MOST_HALVINGS: i32 = 48;

/// `([Phi], [H])` of `x' = a x + b u` over the step `h` in s; not numbers where `A h` or `B h` has one beyond `1e10`.
///
/// # Panics
/// If `a` is not square or `b` has another number of rows.
pub fn discretize(a: &DMatrix<f64>, b: &DMatrix<f64>, h: f64) -> (DMatrix<f64>, DMatrix<f64>) {
    let (n, m) = b.shape();
    assert_eq!(a.shape(), (n, n), "state matrix must be square with a row per row of the input matrix");
    let mut augmented = DMatrix::zeros(n + m, n + m);
    augmented.view_mut((0, 0), (n, n)).copy_from(a);
    augmented.view_mut((0, n), (n, m)).copy_from(b);
    let grown = augmented * h;
    // Exact enough for the plant of a law, whose digits it sets. A run over thousands of steps takes `exponential`.
    let transition = if within_range(&grown) { grown.exp() } else { grown.map(|_| f64::NAN) };
    (transition.view((0, 0), (n, n)).into_owned(), transition.view((0, n), (n, m)).into_owned())
}

/// `exp(z)`; not numbers where `z` is larger than `1e10` or not made of numbers.
///
/// By scaling and squaring of `E = exp(z / 2^s) - 1`, `E <- 2 E + E^2`: beside a fast state a slow one moves by a millionth and less of its
/// size in the first of the halved steps, and would lose as many of its digits to the one.
///
/// # Panics
/// If `z` is not square.
pub fn exponential(z: &DMatrix<f64>) -> DMatrix<f64> {
    if !within_range(z) {
        return z.map(|_| f64::NAN);
    }
    let size = z.column_iter().map(|column| column.lp_norm(1)).fold(0.0, f64::max);
    let halvings = (0..MOST_HALVINGS).find(|&s| size * 0.5f64.powi(s) <= SMALL).unwrap_or(MOST_HALVINGS);
    let part = z * 0.5f64.powi(halvings);
    let one = DMatrix::identity(z.nrows(), z.ncols());
    let series = (2..=TERMS).rev().fold(one.clone(), |sum, term| &one + &part * sum / f64::from(term));
    let mut grown = part * series;
    for _ in 0..halvings {
        grown = &grown * 2.0 + &grown * &grown;
    }
    grown + one
}

/// The states of `x_{k+1} = phi x_k + v_k` from a first one on: `inputs` has `v_k` row by row, and so have the states that come.
///
/// # Panics
/// If `phi` is not square or `inputs` has no whole number of rows.
pub fn propagated(phi: &DMatrix<f64>, start: &[f64], inputs: &[f64]) -> Vec<f64> {
    let n = start.len();
    assert_eq!(phi.shape(), (n, n), "state matrix must be square with a row for each state");
    assert!(n > 0 && inputs.len().is_multiple_of(n), "inputs must have a number for each state and step");
    let mut states = Vec::with_capacity(n + inputs.len());
    states.extend_from_slice(start);
    let mut next = vec![0.0; n];
    for input in inputs.chunks_exact(n) {
        next.copy_from_slice(input);
        let now = &states[states.len() - n..];
        for (column, state) in phi.as_slice().chunks_exact(n).zip(now) {
            next.iter_mut().zip(column).for_each(|(next, entry)| *next += entry * state);
        }
        states.extend_from_slice(&next);
    }
    states
}

/// `D^-1 a D` with a diagonal `D` of powers of two, for which rows and columns are of one size, and that diagonal; `a` itself where
/// it is not made of numbers. For a matrix of any size; `balance` is for vector lanes.
///
/// # Panics
/// If `a` is not square.
pub fn balanced(mut a: DMatrix<f64>) -> (DMatrix<f64>, DVector<f64>) {
    if !a.iter().all(|entry| entry.is_finite()) {
        let alike = DVector::from_element(a.nrows(), 1.0);
        return (a, alike);
    }
    let diagonal = balance_parlett_reinsch(&mut a);
    (a, diagonal)
}
