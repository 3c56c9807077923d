//! Whether the force sensor at the grip follows the hand: one that is stuck shows the same force, with or without noise.
//!
//! `F_g` reading, lagged as the estimate of the hand's torque `tau` is, and the drive's torque `D` · `F_0`, `tau_0`, `D_0` as the reading came to
//! rest
//!
//! The reading rests while `|F_g - F_0|` is within the span of its noise, for [`Limits::grip_stuck`] samples in a row. From then on
//! `|tau - tau_0|` is within [`Limits::grip_apart`] and `delta |D - D_0|`; a sensor for which it is not, for as many samples in a row, is stuck.
//! Where no hand is on the column, `tau = J v' - D` is what `J` and the load cell's lever are off, a share `delta` of `D`. At an end stop the
//! stop's torque is in `tau`, and nothing is known.

use super::limits::{ESTIMATE_BANDWIDTH, Limits};
use super::numbers::below;
use crate::Scalar;

/// `delta`: the default tolerance of the column's inertia, and four lengths of 1 %.
const DEVIATION: f64 = 0.24;

/// What is remembered of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct GripReading<S> {
    /// `F_g`; nothing before the first reading.
    shown: Option<S>,
    /// `F_0`, `tau_0` and `D_0`.
    rested: [S; 3],
    /// Samples in a row in which the reading rests and the torque is known.
    rests: u32,
    /// Samples in a row in which the torque is apart.
    apart: u32,
}

impl<S: Scalar> GripReading<S> {
    #[inline(always)]
    pub(super) fn new(zero: S) -> Self {
        Self { shown: None, rested: [zero; 3], rests: 0, apart: 0 }
    }

    /// Takes a reading in, so long after the one before it, and torques of hand and drive where that of the hand is known; whether the
    /// sensor is stuck.
    #[inline(always)]
    pub(super) fn is_stuck(&mut self, limits: &Limits<S>, (reading, time): (S, S), torques: Option<[S; 2]>) -> bool {
        let last = self.shown.unwrap_or(reading);
        let share = time.times(ESTIMATE_BANDWIDTH).min(time.constant(1.0));
        let shown = last + (reading - last) * share;
        self.shown = Some(shown);
        let moves = below(limits.grip_span, (shown - self.rested[0]).abs());
        let [hand, drive] = torques.unwrap_or([shown.zero(); 2]);
        self.rests = if moves || torques.is_none() { 0 } else { self.rests.saturating_add(1) };
        if self.rests <= limits.grip_stuck {
            (self.rested, self.apart) = ([shown, hand, drive], 0);
            return false;
        }
        let most = limits.grip_apart + (drive - self.rested[2]).abs().times(DEVIATION);
        let apart = below(most, (hand - self.rested[1]).abs());
        self.apart = if apart { self.apart.saturating_add(1) } else { 0 };
        self.apart >= limits.grip_stuck
    }
}
