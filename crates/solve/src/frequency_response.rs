//! The frequency response of a state-space model with one input and one output, at many points.
//!
//! `c (p - A)^-1 b = c Q (p - H)^-1 Q^T b` with `A = Q H Q^T`, `H` a Hessenberg matrix, which is found once: at each point one entry below
//! the diagonal is left to eliminate in each column, `n^2` products in place of `n^3 / 3`.
//!
//! Source: A. J. Laub, Efficient multivariable frequency response computations, IEEE Trans. Automatic Control 26(2) (1981) 407-408.

use nalgebra::linalg::Hessenberg;
use nalgebra::{Complex, DMatrix, DVector};

/// `c (p - a)^-1 b` at each point `p`; no number at an eigenvalue of `a`.
///
/// # Panics
/// If `a` is not square, or `b` and `c` are not of its size.
pub fn frequency_response(
    a: DMatrix<f64>,
    b: &DVector<f64>,
    c: &DVector<f64>,
    points: impl Iterator<Item = Complex<f64>>,
) -> Vec<Complex<f64>> {
    let (q, h) = Hessenberg::new(a).unpack();
    let (b, c) = (q.tr_mul(b), q.tr_mul(c));
    let mut rows = vec![vec![Complex::ZERO; b.len()]; b.len()];
    let mut x = vec![Complex::ZERO; b.len()];
    points
        .map(|p| {
            for (i, row) in rows.iter_mut().enumerate() {
                for j in i.saturating_sub(1)..row.len() {
                    row[j] = Complex::from(-h[(i, j)]);
                }
                row[i] += p;
                x[i] = Complex::from(b[i]);
            }
            solve(&mut rows, &mut x);
            x.iter().zip(&c).map(|(x, c)| x * c).sum()
        })
        .collect()
}

/// Puts the solution of `rows x = right` into `right`; `rows` is a Hessenberg matrix. The larger of two entries is the pivot.
fn solve(rows: &mut [Vec<Complex<f64>>], right: &mut [Complex<f64>]) {
    let n = right.len();
    for k in 1..n {
        let (above, below) = rows.split_at_mut(k);
        let (pivot, row) = (&mut above[k - 1], &mut below[0]);
        if row[k - 1].norm_sqr() > pivot[k - 1].norm_sqr() {
            core::mem::swap(pivot, row);
            right.swap(k - 1, k);
        }
        let factor = row[k - 1] / pivot[k - 1];
        for j in k..n {
            row[j] -= factor * pivot[j];
        }
        let above = right[k - 1];
        right[k] -= factor * above;
    }
    for k in (0..n).rev() {
        for j in k + 1..n {
            let known = right[j];
            right[k] -= rows[k][j] * known;
        }
        right[k] /= rows[k][k];
    }
}
