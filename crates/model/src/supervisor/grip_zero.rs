//! Zero of the force sensor at the grip: found while no hand is on the grip, and taken off its readings.
//!
//! `F_g` reading · `tau` torque of the hand, estimated without this sensor · `F_0` zero
//!
//! No hand is on the grip where for [`Limits::grip_zero`] samples in a row `tau` is below that of a hand, its mean no more than the dry friction
//! of the column hides, and `F_g` no wider than its noise: no hand holds so still. Then `F_0` goes to the mean of these readings, no faster
//! than a hand notices. A mean beyond [`Limits::grip_most`] is a broken sensor.

use super::limits::Limits;
use super::numbers::below;
use crate::Scalar;

/// What is remembered of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct GripZero<S> {
    /// `F_0`.
    pub(super) offset: S,
    /// Mean of the last readings without a hand.
    mean: S,
    /// Lowest and highest reading since the hand was off, the sums of reading and torque, and their number.
    range: [S; 2],
    sums: [S; 2],
    samples: u32,
}

impl<S: Scalar> GripZero<S> {
    #[inline(always)]
    pub(super) fn new(zero: S) -> Self {
        Self { offset: zero, mean: zero, range: [zero; 2], sums: [zero; 2], samples: 0 }
    }

    /// Takes a reading in; whether the sensor shows too much without a hand.
    #[inline(always)]
    pub(super) fn watch(&mut self, limits: &Limits<S>, reading: S, hand_torque: S) -> bool {
        if !limits.grip_sensor {
            return false;
        }
        let [low, high] = if self.samples == 0 { [reading; 2] } else { self.range };
        let sums = if self.samples == 0 { [reading.zero(); 2] } else { self.sums };
        self.range = [low.min(reading), high.max(reading)];
        self.sums = [sums[0] + reading, sums[1] + hand_torque];
        self.samples += 1;
        let hand = below(limits.hand_torque, hand_torque.abs());
        if hand || below(limits.grip_span, self.range[1] - self.range[0]) {
            self.samples = 0;
        } else if self.samples >= limits.grip_zero {
            let [mean, torque] = self.sums.map(|sum| sum / reading.constant(f64::from(self.samples)));
            self.mean = if below(limits.grip_quiet, torque.abs()) { self.mean } else { mean };
            self.samples = 0;
        }
        let wanted = self.mean.within(limits.grip_most);
        self.offset = self.offset + (wanted - self.offset).within(limits.grip_step);
        below(limits.grip_most, self.mean.abs())
    }
}
