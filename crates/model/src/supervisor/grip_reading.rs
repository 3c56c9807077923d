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
use crate::Logic;
use crate::logic::Count;

/// `delta`: the default tolerance of the column's inertia, and four lengths of 1 %.
const DEVIATION: f64 = 0.24;

/// What is remembered of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct GripReading<S: Logic> {
    /// Whether there was a reading before; `F_g`.
    begun: S::Mask,
    shown: S,
    /// `F_0`, `tau_0` and `D_0`.
    rested: [S; 3],
    /// Samples in a row in which the reading rests and the torque is known.
    rests: S::Count,
    /// Samples in a row in which the torque is apart.
    apart: S::Count,
}

crate::logic::memory! { GripReading { flag begun; number shown; numbers rested; count rests, apart; } }

impl<S: Logic> GripReading<S> {
    pub(super) fn new(zero: S) -> Self {
        let none = S::Count::none();
        Self { begun: S::mask(false), shown: zero, rested: [zero; 3], rests: none, apart: none }
    }

    /// Takes a reading in, so long after the one before it, and torques of hand and drive, and whether that of the hand is known; whether
    /// the sensor is stuck.
    #[inline(always)]
    pub(super) fn is_stuck(
        &mut self,
        limits: &Limits<S>,
        (reading, time): (S, S),
        (known, [hand, drive]): (S::Mask, [S; 2]),
    ) -> S::Mask {
        let last = S::select(self.begun, self.shown, reading);
        let share = time.times(ESTIMATE_BANDWIDTH).min(time.constant(1.0));
        let shown = last + (reading - last) * share;
        (self.begun, self.shown) = (S::mask(true), shown);
        let moves = below(limits.grip_span, (shown - self.rested[0]).abs());
        self.rests = self.rests.in_a_row(known & !moves);
        S::paths(self, |this| {
            if S::holds(this.rests.above(limits.grip_stuck)) {
                let most = limits.grip_apart + (drive - this.rested[2]).abs().times(DEVIATION);
                this.apart = this.apart.in_a_row(below(most, (hand - this.rested[1]).abs()));
            } else {
                (this.rested, this.apart) = ([shown, hand, drive], S::Count::none());
            }
        });
        self.apart.at_least(limits.grip_stuck)
    }
}
