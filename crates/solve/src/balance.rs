//! Balancing: states scaled so that the matrix is of one size in rows and columns.
//!
//! `D^-1 A D` with a diagonal `D` of powers of two: the same poles, and not one rounding. A loader's states differ by ten powers
//! of ten in SI units; without balancing, rounding in the large ones drowns the small ones. Parlett and Reinsch, 1969.
#![expect(
    clippy::needless_range_loop,
    reason = "indices as in the equations; iterators are not reliably inlined in lanes"
)]

use crate::loops::{Matrix, STATES};
use crate::wide::Fused;

/// Rounds over all states; the sizes settle within two or three.
const ROUNDS: usize = 3;

/// Balances `a` in place and returns the diagonal of `D`.
#[inline(always)]
pub fn balance<T: Fused>(a: &mut Matrix<T>) -> [T; STATES] {
    let one = a[0][0].constant(1.0);
    let mut scale = [one; STATES];
    for _ in 0..ROUNDS {
        for i in 0..STATES {
            let own = a[i][i].abs();
            let (mut row, mut column) = (-own, -own);
            for j in 0..STATES {
                row = row + a[i][j].abs();
                column = column + a[j][i].abs();
            }
            // The factor that makes both alike, to the nearest power of two; one where there is nothing to compare.
            let factor = (row / column).sqrt().times(core::f64::consts::SQRT_2).power_of_two();
            let within = one.zero().less(factor) & factor.less(one.constant(f64::INFINITY));
            let factor = T::select(within, factor, one);
            let inverse = one / factor;
            for j in 0..STATES {
                a[i][j] = a[i][j] * inverse;
                a[j][i] = a[j][i] * factor;
            }
            scale[i] = scale[i] * factor;
        }
    }
    scale
}
