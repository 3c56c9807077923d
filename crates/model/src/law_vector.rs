//! The numbers of a sampled law's state and of its samples, and a row times them.
//!
//! `xi` state of the law · `y = [F_c, x_p, theta, F_g]` samples · `delta`, `delta'` displacement and rate of the feel

use crate::Scalar;

/// Most states; a law with fewer leaves the others at zero.
pub const MOST_STATES: usize = 9;

/// Names of the states.
pub const STATE_NAMES: [&str; MOST_STATES] = ["xi_0", "xi_1", "xi_2", "xi_3", "xi_4", "xi_5", "xi_6", "xi_7", "xi_8"];

/// What is sampled: load cell force (N), piston displacement (m), column angle (rad), force at the grip (N).
pub const SAMPLED: usize = 4;

/// What command and torque are made of: `[xi; y; delta; delta']`.
pub(crate) const KNOWN: usize = MOST_STATES + SAMPLED + 2;

/// State of the law.
pub type Estimate<S> = [S; MOST_STATES];

/// `a / b`; zero where there is nothing to divide by, as of a state that keeps what it has.
#[inline(always)]
#[track_caller]
pub(crate) fn quotient<S: Scalar>(a: S, b: S) -> S {
    S::select(b.zero().less(b.abs()), a / b, b.zero())
}

/// What a row of numbers makes of `[xi; y; delta; delta']`.
#[inline(always)]
#[track_caller]
pub(crate) fn product<S: Scalar>(row: &[S; KNOWN], xi: &Estimate<S>, y: &[S; SAMPLED], feel: [S; 2]) -> S {
    let mut sum = row[MOST_STATES + SAMPLED] * feel[0] + row[MOST_STATES + SAMPLED + 1] * feel[1];
    for k in 0..MOST_STATES {
        sum = sum + row[k] * xi[k];
    }
    for k in 0..SAMPLED {
        sum = sum + row[MOST_STATES + k] * y[k];
    }
    sum
}
