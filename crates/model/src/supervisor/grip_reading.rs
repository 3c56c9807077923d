//! Whether the force sensor at the grip follows the hand: one that is stuck shows the same force, with or without noise.
//!
//! `F_g` reading, with the lag of the estimated hand torque `tau`; drive torque `D` · `F_0`, `D_0` both once the reading had come to rest
//!
//! The reading rests while `|F_g - F_0|` is within the span of its noise, for [`Limits::grip_stuck`] samples. From then on `tau` is within
//! [`Limits::grip_apart`] and `delta |D - D_0|` of its range in the last [`Limits::stuck`] of them: a single sample may be a spike. If it
//! leaves that band for [`Limits::grip_stuck`] samples in a row, the sensor is stuck. Where no hand is on the column,
//! `tau = J v' - D` is what `J` and the load cell's lever are off, a share `delta` of `D`. At an end stop `tau` includes the torque of
//! the stop: those samples do not count, and do not end the rest of a reading.

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
    /// `F_0` and `D_0`.
    rested: [S; 2],
    /// Least and greatest torque of the hand as the reading came to rest.
    hands: [S; 2],
    /// Samples in which the reading has rested and the torque was known.
    rests: S::Count,
    /// Samples in a row in which the torque is apart.
    apart: S::Count,
}

crate::logic::memory! { GripReading { flag begun; number shown; numbers rested, hands; count rests, apart; } }

impl<S: Logic> GripReading<S> {
    pub(super) fn new(zero: S) -> Self {
        let none = S::Count::none();
        Self { begun: S::mask(false), shown: zero, rested: [zero; 2], hands: [zero; 2], rests: none, apart: none }
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
        let [at_rest, drive_at_rest] = self.rested;
        let moves = below(limits.grip_span, (shown - at_rest).abs());
        let most = limits.grip_apart + (drive - drive_at_rest).abs().times(DEVIATION);
        let [least, greatest] = self.hands;
        let apart = below(hand, least - most) | below(greatest + most, hand);
        let settling = limits.grip_stuck.saturating_sub(limits.stuck);
        S::paths(self, |this| {
            if S::holds(moves) {
                (this.rested, this.rests, this.apart) = ([shown, drive], S::Count::none(), S::Count::none());
            } else if S::holds(!known) {
                this.apart = S::Count::none();
            } else if S::holds(this.rests.above(limits.grip_stuck)) {
                this.apart = this.apart.in_a_row(apart);
            } else {
                let settled = this.rests.at_least(settling);
                this.hands = [S::select(settled, hand.min(least), hand), S::select(settled, hand.max(greatest), hand)];
                (this.rested, this.rests) = ([shown, drive], this.rests.next());
            }
        });
        self.apart.at_least(limits.grip_stuck)
    }
}
