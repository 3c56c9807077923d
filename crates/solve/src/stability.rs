//! Stability of many loops: proved by the signs of Routh's array, for most of them without a single pole.
//!
//! | step | by |
//! |---|---|
//! | matrix `A` of the loop | the model at unit vectors, [`loops`](crate::loops) |
//! | `D^-1 A D` of one size in rows and columns | powers of two, [`balance`](mod@crate::balance) |
//! | Hessenberg form | eliminations with the largest pivot, each a similarity (Wilkinson 1965, 6.8) |
//! | `det(s - A)` | recursion over the leading blocks of the Hessenberg form |
//! | signs | Routh's array: all poles are left of the axis where its first column is positive |
//!
//! All numbers are [`Bounded`]: a sign counts only where the error's bound leaves no other. Where the elimination broke down,
//! because a part of the loop moves by itself, it begins again from other states. What remains in doubt, where twice the
//! digits do not tell the pole from the axis, is settled by the poles themselves ([`poles`](mod@crate::poles)) and marked.
//!
//! Proved is what holds of the matrix as double precision has it.
//!
//! A loop's verdict depends on its own numbers alone.
#![expect(
    clippy::needless_range_loop,
    reason = "indices as in the equations; iterators are not reliably inlined in lanes"
)]

use crate::balance::balance;
use crate::bounded::Bounded;
use crate::lanes::{LANES, Lanes};
use crate::loops::{Loops, Matrix, STATES, state_matrix};
use crate::poles::poles;
use crate::return_on_vectors;
use crate::threads::{NoThreads, each};
use crate::wide::Fused;
use fearless_simd::{Level, Simd};

/// What is known of a loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Verdict {
    /// A pole on the axis or right of it, proved.
    Unstable = 0,
    /// All poles left of the axis, proved.
    Stable = 1,
    /// So close to the axis that rounding decides: a computed pole is on the axis or right of it.
    UnstableByPoles = 2,
    /// So close to the axis that rounding decides: the computed poles are left of it.
    StableByPoles = 3,
    /// The loop's matrix is not made of numbers.
    Unknown = 4,
}

/// Loops that a thread takes at a time.
const PIECE: usize = 64 * LANES;

impl Loops<'_> {
    /// The verdict of each loop, computed on so many threads.
    ///
    /// # Errors
    /// If the system gives no threads.
    pub fn stability(&self, threads: usize) -> Result<Vec<Verdict>, NoThreads> {
        let mut verdicts = vec![Verdict::Unknown; self.count];
        let level = Level::new();
        let pieces = verdicts.chunks_mut(PIECE).enumerate();
        each(threads, pieces, |(piece, verdicts)| self.judge_piece(level, piece * PIECE, verdicts))?;
        Ok(verdicts)
    }

    fn judge_piece(&self, level: Level, first: usize, verdicts: &mut [Verdict]) {
        return_on_vectors!(level, simd => self.judge_vectors(simd, first, verdicts));
        self.judge::<f64>((), first, verdicts);
    }

    #[inline(always)]
    fn judge_vectors<S: Simd>(&self, simd: S, first: usize, verdicts: &mut [Verdict]) {
        simd.vectorize(
            #[inline(always)]
            || self.judge::<Lanes<S>>(simd, first, verdicts),
        );
    }

    #[inline(always)]
    fn judge<T: Fused>(&self, token: T::Token, first: usize, verdicts: &mut [Verdict]) {
        for (group, verdicts) in verdicts.chunks_mut(T::RUNS).enumerate() {
            let group = first + group * T::RUNS;
            let mut a = state_matrix(&self.models::<T>(token, group));
            balance(&mut a);
            let (stable, unstable) = hurwitz(&a);
            let one = a[0][0].constant(1.0);
            let code = T::select(stable, one, T::select(unstable, one.zero(), one.constant(f64::NAN)));
            code.scatter(|lane, code| {
                if let Some(verdict) = verdicts.get_mut(lane) {
                    *verdict = self.settled(group + lane, code);
                }
            });
        }
    }

    /// The verdict of one loop from its code: one, zero, or neither.
    fn settled(&self, run: usize, code: f64) -> Verdict {
        if code.is_nan() {
            return in_doubt(&state_matrix(&self.models::<f64>((), run)));
        }
        if code > 0.5 { Verdict::Stable } else { Verdict::Unstable }
    }
}

/// The verdict on one matrix.
pub fn verdict(a: &Matrix<f64>) -> Verdict {
    let mut balanced = *a;
    balance(&mut balanced);
    proved(hurwitz(&balanced)).unwrap_or_else(|| in_doubt(a))
}

fn proved((stable, unstable): (bool, bool)) -> Option<Verdict> {
    if unstable { Some(Verdict::Unstable) } else { stable.then_some(Verdict::Stable) }
}

/// The verdict where the first signs left doubt: by the signs of a similar matrix that no part falls off, then by the poles.
#[cold]
fn in_doubt(a: &Matrix<f64>) -> Verdict {
    let mut balanced = *a;
    balance(&mut balanced);
    let mut h = bounded(&balanced);
    mix(&mut h);
    proved(judged(h)).unwrap_or_else(|| match poles(a) {
        None => Verdict::Unknown,
        Some(poles) if poles.iter().all(|pole| pole.re < 0.0) => Verdict::StableByPoles,
        Some(_) => Verdict::UnstableByPoles,
    })
}

/// How much of each other state goes into the first: no pattern that a machine could share.
const MIXTURE: [f64; STATES] = [0.0, 0.618, -0.382, 0.236, -0.854, 0.472, -0.708, 0.146];

/// Makes the first state one that all parts of the loop move, so that the elimination does not end with a part of them.
fn mix(h: &mut Matrix<Bounded<f64>>) {
    for i in 1..STATES {
        let m = Bounded::exact(MIXTURE[i]);
        for j in 0..STATES {
            h[i][j] = h[i][j].minus_product(m, h[0][j]);
        }
        for row in h.iter_mut() {
            row[0] = row[0].minus_product(m.negative(), row[i]);
        }
    }
}

/// Whether all eigenvalues are certainly left of the axis, and whether one certainly is not.
#[inline(always)]
pub fn hurwitz<T: Fused>(a: &Matrix<T>) -> (T::Mask, T::Mask) {
    judged(bounded(a))
}

#[inline(always)]
fn bounded<T: Fused>(a: &Matrix<T>) -> Matrix<Bounded<T>> {
    let mut h = [[Bounded::exact(a[0][0].zero()); STATES]; STATES];
    for i in 0..STATES {
        for j in 0..STATES {
            h[i][j] = Bounded::exact(a[i][j]);
        }
    }
    h
}

#[inline(always)]
fn judged<T: Fused>(mut h: Matrix<Bounded<T>>) -> (T::Mask, T::Mask) {
    reduce(&mut h);
    routh(&characteristic(&h))
}

/// Brings `h` to Hessenberg form; what stands below the first subdiagonal afterwards is to be read as zero.
#[inline(always)]
fn reduce<T: Fused>(h: &mut Matrix<Bounded<T>>) {
    for k in 1..STATES - 1 {
        for i in k + 1..STATES {
            let larger = h[k][k - 1].is_smaller(h[i][k - 1]);
            if !T::any(larger) {
                continue;
            }
            for j in k - 1..STATES {
                (h[k][j], h[i][j]) = Bounded::exchanged(larger, h[k][j], h[i][j]);
            }
            for row in h.iter_mut() {
                (row[k], row[i]) = Bounded::exchanged(larger, row[k], row[i]);
            }
        }
        for i in k + 1..STATES {
            let m = h[i][k - 1].over(h[k][k - 1]);
            for j in k..STATES {
                h[i][j] = h[i][j].minus_product(m, h[k][j]);
            }
            let back = m.negative();
            for row in h.iter_mut() {
                row[k] = row[k].minus_product(back, row[i]);
            }
        }
    }
}

/// Coefficients of `det(s - h)`, that of `s^j` at place `j`, of a Hessenberg matrix.
#[inline(always)]
fn characteristic<T: Fused>(h: &Matrix<Bounded<T>>) -> [Bounded<T>; STATES + 1] {
    let zero = Bounded::exact(h[0][0].parts().0.zero());
    let mut blocks = [[zero; STATES + 1]; STATES + 1];
    blocks[0][0] = Bounded::exact(h[0][0].parts().0.constant(1.0));
    for k in 1..=STATES {
        // p_k = s p_{k-1} - sum over i of h_{k-i,k} (h_{k-i+1,k-i} ... h_{k,k-1}) p_{k-i-1}
        for j in 1..=k {
            blocks[k][j] = blocks[k - 1][j - 1];
        }
        let mut below = blocks[0][0];
        for i in (0..k).rev() {
            let factor = if i + 1 == k { h[i][k - 1] } else { below.times(h[i][k - 1]) };
            for j in 0..=i {
                blocks[k][j] = blocks[k][j].minus_product(factor, blocks[i][j]);
            }
            if i > 0 {
                below = if i + 1 == k { h[i][i - 1] } else { below.times(h[i][i - 1]) };
            }
        }
    }
    blocks[STATES]
}

/// Routh's array of the polynomial with leading coefficient one: whether its first column is certainly positive, and
/// whether a number of it certainly is negative after certainly positive ones.
#[inline(always)]
fn routh<T: Fused>(polynomial: &[Bounded<T>; STATES + 1]) -> (T::Mask, T::Mask) {
    const WIDTH: usize = STATES / 2 + 1;
    let one = polynomial[STATES];
    let zero = Bounded::exact(one.parts().0.zero());
    let (mut above, mut row) = ([zero; WIDTH], [zero; WIDTH]);
    for j in 0..WIDTH {
        above[j] = polynomial[STATES - 2 * j];
    }
    for j in 0..WIDTH - 1 {
        row[j] = polynomial[STATES - 1 - 2 * j];
    }
    let mut positive = one.is_positive();
    let mut negative = !positive & positive;
    for _ in 1..STATES {
        negative = negative | (positive & row[0].negative().is_positive());
        positive = positive & row[0].is_positive();
        let m = above[0].over(row[0]);
        let mut next = [zero; WIDTH];
        for j in 0..WIDTH - 1 {
            next[j] = above[j + 1].minus_product(m, row[j + 1]);
        }
        (above, row) = (row, next);
    }
    negative = negative | (positive & row[0].negative().is_positive());
    (positive & row[0].is_positive(), negative)
}
