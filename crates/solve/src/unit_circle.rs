//! Whether all eigenvalues of many matrices are inside the unit circle: from powers of each, without an eigenvalue.
//!
//! `A_0` the matrix, `n` by `n` · `A_{j+1} = A_j^2` · `k = 2^j` · `rho` largest magnitude of its eigenvalues
//!
//! | the eigenvalues are | because |
//! |---|---|
//! | all inside | `rho^k <= \|A_j\| < 1/2`, the largest sum of magnitudes in a row |
//! | not all inside | `rho^k >= \|tr A_j\| / n > 2` |
//!
//! One of them holds before long, unless `rho` is near one. Where [`SQUARINGS`] do not tell, the question is left to the eigenvalues:
//! `|ln rho|` is then below some `5e-6`. What is told has one above `ln 2 / 2^22 = 1.7e-7`.
//!
//! Rounding: a squaring errs by `n 2^-53 |A_j|^2` at most, entry by entry, whatever the units of the states. An eigenvalue of condition
//! `c` in these terms moves by `n 2^-53 c / k` in its logarithm, all squarings together as if `A_0` erred by twice the first's. With
//! 30 states a verdict is right up to `c = 2e7`, beyond which computed eigenvalues near the circle are no better known.

use crate::lanes::{LANES, Lanes};
use crate::return_on_vectors;
use crate::threads::{NoThreads, each};
use crate::wide::Fused;
use fearless_simd::{Level, Simd};

/// Most squarings.
const SQUARINGS: usize = 22;

/// Matrices that a thread takes at a time.
const PIECE: usize = 64;

/// Whether all eigenvalues of each `n` by `n` matrix, row by row one after the other, are inside the unit circle, found on so many
/// threads; none where the powers do not tell, or hold what is not a number.
///
/// # Errors
/// If the system gives no threads.
pub fn inside(matrices: &[f64], n: usize, threads: usize) -> Result<Vec<Option<bool>>, NoThreads> {
    let size = n * n;
    let mut verdicts = vec![None; matrices.len() / size.max(1)];
    let level = Level::new();
    let pieces = verdicts.chunks_mut(PIECE).zip(matrices.chunks(PIECE * size.max(1)));
    each(threads, pieces, |(verdicts, matrices)| judge_piece(level, matrices, n, verdicts))?;
    Ok(verdicts)
}

fn judge_piece(level: Level, matrices: &[f64], n: usize, verdicts: &mut [Option<bool>]) {
    return_on_vectors!(level, simd => judge_vectors(simd, matrices, n, verdicts));
    judge::<f64>((), matrices, n, verdicts);
}

#[inline(always)]
fn judge_vectors<S: Simd>(simd: S, matrices: &[f64], n: usize, verdicts: &mut [Option<bool>]) {
    simd.vectorize(
        #[inline(always)]
        || judge::<Lanes<S>>(simd, matrices, n, verdicts),
    );
}

#[inline(always)]
fn judge<T: Fused>(token: T::Token, matrices: &[f64], n: usize, verdicts: &mut [Option<bool>]) {
    let side = n.next_multiple_of(LANES);
    let (mut power, mut squared) = (vec![0.0; side * side], vec![0.0; side * side]);
    for (verdict, matrix) in verdicts.iter_mut().zip(matrices.chunks(n * n)) {
        power.fill(0.0);
        for (row, given) in power.chunks_mut(side).zip(matrix.chunks(n)) {
            row[..n].copy_from_slice(given);
        }
        for _ in 0..SQUARINGS {
            square::<T>(token, &power, n, &mut squared);
            core::mem::swap(&mut power, &mut squared);
            *verdict = told(&power, n);
            if verdict.is_some() {
                break;
            }
        }
    }
}

/// What a power tells.
#[inline(always)]
fn told(power: &[f64], n: usize) -> Option<bool> {
    let side = n.next_multiple_of(LANES);
    let within = |row: &[f64]| row.iter().map(|entry| entry.abs()).sum::<f64>() < 0.5;
    if power.chunks(side).all(within) {
        return Some(true);
    }
    let trace: f64 = power.iter().step_by(side + 1).sum();
    (2.0 * number(n) < trace.abs() && trace.is_finite()).then_some(false)
}

/// `a a`: rows and columns up to a whole number of vectors, those beyond `n` zero.
#[inline(always)]
fn square<T: Fused>(token: T::Token, a: &[f64], n: usize, result: &mut [f64]) {
    let side = n.next_multiple_of(LANES);
    let zero = T::gather(token, |_| 0.0);
    // Eight rows at a time: so many sums keep the multipliers busy.
    for (rows, results) in a.chunks_exact(LANES * side).zip(result.chunks_exact_mut(LANES * side)) {
        let rows: [&[f64]; LANES] = core::array::from_fn(|row| &rows[row * side..][..n]);
        for first in (0..side).step_by(T::RUNS) {
            let mut sums = [zero; LANES];
            for k in 0..n {
                let below = &a[k * side + first..][..T::RUNS];
                let below = T::gather(token, |lane| below[lane]);
                for (sum, row) in sums.iter_mut().zip(&rows) {
                    *sum = zero.constant(row[k]).mul_add(below, *sum);
                }
            }
            for (sum, result) in sums.into_iter().zip(results.chunks_exact_mut(side)) {
                let result = &mut result[first..][..T::RUNS];
                sum.scatter(|lane, value| result[lane] = value);
            }
        }
    }
}

#[expect(clippy::cast_precision_loss, reason = "a number of states, far below 2^52")]
fn number(count: usize) -> f64 {
    count as f64
}
