//! The exact step of a linear system in every lane: the matrix exponential, and what an input adds.
//!
//! `x' = A x + b u`, `u` running straight from `u_0` to `u_1` within the step `h`:
//!
//! `x(h) = Phi x(0) + Gamma u_0 + R (u_1 - u_0)`, `Phi = exp(A h)`, `Gamma = h phi_1(A h) b`, `R = h phi_2(A h) b`
//!
//! with `phi_1(z) = (e^z - 1) / z` and `phi_2(z) = (e^z - 1 - z) / z^2`, none of which asks for `A^-1`. All three are summed as
//! series over a step `h / 2^s` that makes `A h` small, then doubled `s` times:
//!
//! `Phi <- Phi^2`, `Gamma <- Phi Gamma + Gamma`, `R <- (Phi R + R + Gamma) / 2`
//!
//! Moler and Van Loan, "Nineteen dubious ways to compute the exponential of a matrix", 2003, method 3.
#![expect(
    clippy::needless_range_loop,
    reason = "indices as in the equations; iterators are not reliably inlined in lanes"
)]

use crate::loops::{Matrix, STATES};
use crate::wide::Fused;

/// A number for each state.
pub type Vector<T> = [T; STATES];

/// What a step makes of state and input.
#[derive(Debug, Clone, Copy)]
pub struct Transition<T> {
    /// `Phi`, on the state.
    pub phi: Matrix<T>,
    /// `Gamma`, on the input at the start of the step.
    pub level: Vector<T>,
    /// `R`, on the change of the input within the step.
    pub ramp: Vector<T>,
}

/// Size of `A h / 2^s` up to which the series to `z^15` is exact: what it leaves out is below `1e-18`.
const SMALL: f64 = 0.5;
/// Terms of the series for the input.
const TERMS: u32 = 16;
/// Most doublings: more than double precision has powers of two.
const MOST_DOUBLINGS: i32 = 1100;

impl<T: Fused> Transition<T> {
    /// The step `h` in s of `x' = a x + b u`.
    #[inline(always)]
    pub fn new(a: &Matrix<T>, b: &Vector<T>, h: f64) -> Self {
        let zero = a[0][0].zero();
        // The largest sum over a row of |A h|, doubled to the next power of two: how often the step is halved, lane by lane.
        let mut size = zero;
        for row in a {
            let mut sum = zero;
            for &entry in row {
                sum = sum + entry.abs();
            }
            size = size.max(sum);
        }
        let factor = (size.times(2.0 * h / SMALL).power_of_two()).max(zero.constant(1.0));
        let step = zero.constant(h) / factor;
        let mut z = *a;
        for row in &mut z {
            for entry in row {
                *entry = *entry * step;
            }
        }
        let scaled_b = b.map(
            #[inline(always)]
            |entry| entry * step,
        );
        let (level, ramp) = forced(&z, &scaled_b);
        let mut result = Self { phi: exponential(&z), level, ramp };
        let mut left = factor;
        for _ in 0..MOST_DOUBLINGS {
            let more = zero.constant(1.0).less(left);
            if !T::any(more) {
                break;
            }
            result = Self::chosen(more, &result.doubled(), &result);
            left = left.times(0.5);
        }
        result
    }

    /// Two steps in one; of the input, its straight line over both.
    #[inline(always)]
    pub fn doubled(&self) -> Self {
        let carried = times_vector(&self.phi, &self.level, &self.level);
        let mut ramp = times_vector(&self.phi, &self.ramp, &self.ramp);
        for j in 0..STATES {
            ramp[j] = (ramp[j] + self.level[j]).times(0.5);
        }
        Self { phi: product(&self.phi, &self.phi), level: carried, ramp }
    }

    /// `yes` in the lanes where the mask holds, else `no`.
    #[inline(always)]
    fn chosen(mask: T::Mask, yes: &Self, no: &Self) -> Self {
        let mut result = *no;
        for i in 0..STATES {
            for j in 0..STATES {
                result.phi[i][j] = T::select(mask, yes.phi[i][j], no.phi[i][j]);
            }
            result.level[i] = T::select(mask, yes.level[i], no.level[i]);
            result.ramp[i] = T::select(mask, yes.ramp[i], no.ramp[i]);
        }
        result
    }
}

/// `phi_1(z) b` and `phi_2(z) b` of a small `z`.
#[inline(always)]
fn forced<T: Fused>(z: &Matrix<T>, b: &Vector<T>) -> (Vector<T>, Vector<T>) {
    // phi_2(z) b = 1/2! (b + 1/3 z (b + 1/4 z (b + ...))), phi_1(z) b = b + z phi_2(z) b
    let mut sum = *b;
    for k in (3..=TERMS).rev() {
        for entry in &mut sum {
            *entry = entry.times(1.0 / f64::from(k));
        }
        sum = times_vector(z, &sum, b);
    }
    for entry in &mut sum {
        *entry = entry.times(0.5);
    }
    (times_vector(z, &sum, b), sum)
}

/// `exp(z)` of a small `z`: four cubics in `z` with powers of `z^4` (Paterson and Stockmeyer).
#[inline(always)]
fn exponential<T: Fused>(z: &Matrix<T>) -> Matrix<T> {
    let z2 = product(z, z);
    let z3 = product(&z2, z);
    let z4 = product(&z2, &z2);
    let mut sum = cubic(z, &z2, &z3, 12);
    for first in [8, 4, 0] {
        let carried = product(&z4, &sum);
        sum = cubic(z, &z2, &z3, first);
        for i in 0..STATES {
            for j in 0..STATES {
                sum[i][j] = sum[i][j] + carried[i][j];
            }
        }
    }
    sum
}

/// `1/n! + z/(n+1)! + z^2/(n+2)! + z^3/(n+3)!`.
#[inline(always)]
fn cubic<T: Fused>(z: &Matrix<T>, z2: &Matrix<T>, z3: &Matrix<T>, n: usize) -> Matrix<T> {
    let mut sum = *z;
    for i in 0..STATES {
        for j in 0..STATES {
            let low = z[i][j].times(INVERSE_FACTORIALS[n + 1]);
            let high = z2[i][j].mul_add(low.constant(INVERSE_FACTORIALS[n + 2]), low);
            sum[i][j] = z3[i][j].mul_add(low.constant(INVERSE_FACTORIALS[n + 3]), high);
        }
        sum[i][i] = sum[i][i] + sum[i][i].constant(INVERSE_FACTORIALS[n]);
    }
    sum
}

/// `1 / n!`.
const INVERSE_FACTORIALS: [f64; 16] = {
    let mut terms = [1.0; 16];
    let (mut k, mut n) = (1, 1.0);
    while k < 16 {
        terms[k] = terms[k - 1] / n;
        (k, n) = (k + 1, n + 1.0);
    }
    terms
};

/// `sum + factor row`; spelled out, so that the sums stay in registers.
#[inline(always)]
pub fn plus_times<T: Fused>([a, b, c, d, e, f, g, h]: Vector<T>, factor: T, row: &Vector<T>) -> Vector<T> {
    [
        factor.mul_add(row[0], a),
        factor.mul_add(row[1], b),
        factor.mul_add(row[2], c),
        factor.mul_add(row[3], d),
        factor.mul_add(row[4], e),
        factor.mul_add(row[5], f),
        factor.mul_add(row[6], g),
        factor.mul_add(row[7], h),
    ]
}

/// `x rows + sum`: the rows added up, each times its entry of `x`.
#[inline(always)]
pub fn combined<T: Fused>(x: &Vector<T>, rows: &Matrix<T>, sum: Vector<T>) -> Vector<T> {
    let sum = plus_times(sum, x[0], &rows[0]);
    let sum = plus_times(sum, x[1], &rows[1]);
    let sum = plus_times(sum, x[2], &rows[2]);
    let sum = plus_times(sum, x[3], &rows[3]);
    let sum = plus_times(sum, x[4], &rows[4]);
    let sum = plus_times(sum, x[5], &rows[5]);
    let sum = plus_times(sum, x[6], &rows[6]);
    plus_times(sum, x[7], &rows[7])
}

/// `a b`.
#[inline(always)]
pub fn product<T: Fused>(a: &Matrix<T>, b: &Matrix<T>) -> Matrix<T> {
    let mut result = *a;
    for i in 0..STATES {
        result[i] = combined(&a[i], b, [a[i][0].zero(); STATES]);
    }
    result
}

/// `a x + added`.
#[inline(always)]
pub fn times_vector<T: Fused>(a: &Matrix<T>, x: &Vector<T>, added: &Vector<T>) -> Vector<T> {
    let mut result = *added;
    for i in 0..STATES {
        result[i] = dot(&a[i], x) + added[i];
    }
    result
}

/// The matrix with rows and columns exchanged.
#[inline(always)]
pub fn transposed<T: Copy>(a: &Matrix<T>) -> Matrix<T> {
    let mut result = *a;
    for i in 0..STATES {
        for j in 0..STATES {
            result[i][j] = a[j][i];
        }
    }
    result
}

/// `row x`.
#[inline(always)]
pub fn dot<T: Fused>(row: &Vector<T>, x: &Vector<T>) -> T {
    let even = row[6].mul_add(x[6], row[4].mul_add(x[4], row[2].mul_add(x[2], row[0] * x[0])));
    row[7].mul_add(x[7], row[5].mul_add(x[5], row[3].mul_add(x[3], row[1].mul_add(x[1], even))))
}

/// `x` of `a x = b`, by elimination with the largest pivot in each lane.
#[inline(always)]
pub fn solve<T: Fused>(a: &Matrix<T>, b: &Vector<T>) -> Vector<T> {
    let (mut a, mut x) = (*a, *b);
    for k in 0..STATES {
        for i in k + 1..STATES {
            let larger = a[k][k].abs().less(a[i][k].abs());
            for j in k..STATES {
                (a[k][j], a[i][j]) = (T::select(larger, a[i][j], a[k][j]), T::select(larger, a[k][j], a[i][j]));
            }
            (x[k], x[i]) = (T::select(larger, x[i], x[k]), T::select(larger, x[k], x[i]));
        }
        for i in k + 1..STATES {
            let m = -(a[i][k] / a[k][k]);
            for j in k..STATES {
                a[i][j] = m.mul_add(a[k][j], a[i][j]);
            }
            x[i] = m.mul_add(x[k], x[i]);
        }
    }
    for k in (0..STATES).rev() {
        for j in k + 1..STATES {
            x[k] = (-a[k][j]).mul_add(x[j], x[k]);
        }
        x[k] = x[k] / a[k][k];
    }
    x
}
