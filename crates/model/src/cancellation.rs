//! What the controller adds to its command so that a known disturbance of the drive is not felt, as data of a law.
//!
//! `x` position of the drive's end as sampled, `v` its last period's difference · `r` travel per radian of the motor · `T_k, N_k, phi_k`
//! harmonics of cogging · `K_t` torque constant · `t` lead · `T_c` dry friction of the motor · `delta'` programmed rate, `w_s` slow
//!
//! `e_c = T_c / K_t delta' / sqrt(delta'^2 + w_s^2) - sum of T_k / K_t sin(N_k (x + v t) / r + phi_k)`
//!
//! The lead is the time from the sample to the middle of the current that it makes: delay, half a period, lags of the current loop and
//! of the sensor. The friction goes with the rate that is programmed, which the drive follows: it is free of the encoder's steps, so
//! nothing chatters at rest, and what holds the drive there is left to its loop. The law itself is not told: to its observer the drive
//! is one without.

use crate::Scalar;
use crate::drive::electric::motor::Harmonic;

/// Numbers of a [`Cancellation`].
pub const CANCELLATION_NUMBERS: usize = 2 + 3 * HARMONICS + 2;

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
    /// `T_c / K_t` in A.
    friction: f64,
    /// `w_s` in the unit of `delta'`.
    slow: f64,
}

impl Cancellation {
    /// From radians of the motor per meter, lead in s, amplitude in A, periods per turn and phase in rad of each harmonic, then current
    /// of the friction in A and slow rate in rad/s.
    pub fn from_numbers(numbers: &[f64; CANCELLATION_NUMBERS]) -> Self {
        let &[per_travel, lead, ..] = numbers;
        let harmonic = |k: usize| Harmonic {
            amplitude: numbers[2 + 3 * k],
            periods: numbers[3 + 3 * k],
            phase: numbers[4 + 3 * k],
        };
        let friction = 2 + 3 * HARMONICS;
        Self {
            per_travel,
            lead,
            cogging: core::array::from_fn(harmonic),
            friction: numbers[friction],
            slow: numbers[friction + 1],
        }
    }

    /// What is added to the command where the drive's end is at `x` and moves at `v`, and the feel at `rate`.
    #[inline(always)]
    pub fn command<S: Scalar>(&self, x: S, v: S, rate: S) -> S {
        let phi = (x + v.times(self.lead)).times(self.per_travel);
        let [first, second] = self.cogging.map(|harmonic| harmonic.map(|number| phi.constant(number)).at(phi));
        let along = rate / (rate * rate + rate.constant(self.slow * self.slow)).sqrt();
        first + second + along.times(self.friction)
    }
}
