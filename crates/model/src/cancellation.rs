//! What the controller adds to its command so that a known disturbance of the drive is not felt, as data of a law.
//!
//! `x` position of the drive's end as sampled, `v` its last period's difference · `r` travel per radian of the motor · `T_k, N_k, phi_k`
//! harmonics of cogging · `K_t` torque constant · `t` lead
//!
//! `e_c = -sum of T_k / K_t sin(N_k (x + v t) / r + phi_k)`
//!
//! The lead is the time from the sample to the middle of the current that it makes: delay, half a period, lags of the current loop and
//! of the sensor. What else of a drive is known and does not depend on the law, its dry friction among it, belongs here. The law
//! itself is not told: to its observer the drive is one without.

use crate::Scalar;
use crate::drive::electric::motor::Harmonic;

/// Numbers of a [`Cancellation`].
pub const CANCELLATION_NUMBERS: usize = 2 + 3 * HARMONICS;

const HARMONICS: usize = 2;

/// A drive's known disturbance, the same for all runs of a batch: that of the loader which the law was made for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cancellation {
    /// `1 / r` in rad/m.
    per_travel: f64,
    /// `t` in s.
    lead: f64,
    /// Amplitudes in A, of what is added.
    cogging: [Harmonic<f64>; HARMONICS],
}

impl Cancellation {
    /// From radians of the motor per metre, lead in s, and amplitude in A, periods per turn and phase in rad of each harmonic.
    pub fn from_numbers(numbers: &[f64; CANCELLATION_NUMBERS]) -> Self {
        let &[per_travel, lead, ..] = numbers;
        let harmonic = |k: usize| Harmonic {
            amplitude: numbers[2 + 3 * k],
            periods: numbers[3 + 3 * k],
            phase: numbers[4 + 3 * k],
        };
        Self { per_travel, lead, cogging: core::array::from_fn(harmonic) }
    }

    /// What is added to the command where the drive's end is at `x` and moves at `v`.
    #[inline(always)]
    pub fn command<S: Scalar>(&self, x: S, v: S) -> S {
        let phi = (x + v.times(self.lead)).times(self.per_travel);
        let [first, second] = self.cogging.map(|harmonic| harmonic.map(|number| phi.constant(number)).at(phi));
        first + second
    }
}
