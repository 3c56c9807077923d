//! Zero of the force sensor at the grip: found while no hand is on the grip, and taken off its readings.
//!
//! `F_g` reading · `tau` torque of the hand, estimated without this sensor · `F_0` zero
//!
//! No hand is on the grip where for [`Limits::grip_zero`] samples in a row `tau` is below one and a half of that of a hand, its mean no more than
//! the dry friction of the column hides, and `F_g` no wider than its noise: no hand holds so still. Then `F_0` goes to the mean of these readings, no faster
//! than a hand notices. A mean beyond [`Limits::grip_most`] is a broken sensor.

use super::limits::Limits;
use super::numbers::below;
use crate::Logic;
use crate::logic::Count;

/// Limit of a single sample of `tau`, over the torque of a hand. In `elevator-2khz` noise exceeds the torque of a hand every twenty
/// seconds, and the count would begin anew.
const SINGLE_SAMPLE: f64 = 1.5;

/// What is remembered of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct GripZero<S: Logic> {
    /// `F_0`.
    pub(super) offset: S,
    /// Mean of the last readings without a hand.
    mean: S,
    /// Lowest and highest reading since the hand was off, the sums of reading and torque, and their number.
    range: [S; 2],
    sums: [S; 2],
    samples: S::Count,
}

crate::logic::memory! { GripZero { number offset, mean; numbers range, sums; count samples; } }

impl<S: Logic> GripZero<S> {
    #[inline(always)]
    pub(super) fn new(zero: S) -> Self {
        Self { offset: zero, mean: zero, range: [zero; 2], sums: [zero; 2], samples: S::Count::none() }
    }

    /// Takes a reading in; whether the sensor shows too much without a hand.
    #[inline(always)]
    pub(super) fn watch(&mut self, limits: &Limits<S>, reading: S, hand_torque: S) -> S::Mask {
        if !limits.grip_sensor {
            return S::mask(false);
        }
        let counted = self.samples.some();
        let since = |before: S, first: S| S::select(counted, before, first);
        let [low, high] = self.range.map(|end| since(end, reading));
        let sums = self.sums.map(|sum| since(sum, reading.zero()));
        self.range = [low.min(reading), high.max(reading)];
        self.sums = [sums[0] + reading, sums[1] + hand_torque];
        self.samples = self.samples.next();
        let hand = below(limits.hand_torque * reading.constant(SINGLE_SAMPLE), hand_torque.abs());
        let hand = hand | below(limits.grip_span, self.range[1] - self.range[0]);
        let none = !hand & self.samples.at_least(limits.grip_zero);
        if S::any(none) {
            // Of so many samples, and no more: then they begin again.
            let [mean, torque] = self.sums.map(|sum| sum / reading.constant(f64::from(limits.grip_zero)));
            self.mean = S::select(none & !below(limits.grip_quiet, torque.abs()), mean, self.mean);
        }
        self.samples = self.samples.only(!(hand | none));
        let wanted = self.mean.within(limits.grip_most);
        self.offset = self.offset + (wanted - self.offset).within(limits.grip_step);
        below(limits.grip_most, self.mean.abs())
    }
}
