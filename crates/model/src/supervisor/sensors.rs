//! Sensors: silent, late, not a number, out of range, stuck, or in disagreement.
//!
//! `F` load cell · `x` drive position · `theta` column angle · `s = x - alpha R_b theta` stretch of the link · `k`, `c` its spring and
//! damping, `b` half its play
//!
//! Three sensors measure one link: `F = k (s -+ b) + c s'`, eq. (9). What is left over,
//! `r = s + (c / k) s' - F / k`, within the play, needs no observer and no law, so it judges them too. It is as sharp as the link is soft:
//! an error of the load cell shows once `F / k` comes to the allowed angle.

use super::debounce::Debounce;
use super::function::{Function, Functions};
use super::input::SupervisorInput;
use super::limits::Limits;
use super::numbers::{below, finite};
use crate::Scalar;
use crate::transducers::SENSORS;

/// Those that measure the link: load cell (N), position of the drive (m), column (rad).
pub(super) const OF_LINK: usize = 3;

/// What is remembered of the sensors.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sensors<S> {
    /// Stretch of the link at the last sample that could be used; nothing before the first.
    stretch: Option<S>,
    /// Periods up to samples since `last` that could not be used.
    unused: S,
    /// Cycles in a row without a sample that could be used for its delay.
    lost: u32,
    still: [Still<S>; OF_LINK],
    disagree: Debounce,
}

/// A sensor that shows the same number.
#[derive(Debug, Clone, Copy)]
pub(super) struct Still<S> {
    last: Option<S>,
    /// What the others made of it when it changed last; nothing before they are read.
    expected: Option<S>,
    samples: u32,
    /// Samples in a row in which the others show motion since then.
    apart: u32,
}

impl<S: Scalar> Still<S> {
    pub(super) const NEW: Self = Self { last: None, expected: None, samples: 0, apart: 0 };

    /// Whether it is stuck: its reading is as it was, and what the others make of it has changed by more than `most`; `read`: none of
    /// them is a prediction.
    #[inline(always)]
    pub(super) fn is_stuck(&mut self, limits: &Limits<S>, reading: S, (expected, read): (S, bool), most: S) -> bool {
        let change = self.last.map(|last| (reading - last).abs());
        self.last = Some(reading);
        if change.is_none_or(|change| below(change.zero(), change)) {
            (self.expected, self.samples, self.apart) = (read.then_some(expected), 0, 0);
            return false;
        }
        self.samples = self.samples.saturating_add(1);
        self.expected = self.expected.or(read.then_some(expected));
        // A column that a hand holds still is no fault.
        let apart = self.expected.is_some_and(|before| below(most, (expected - before).abs()));
        self.apart = if apart && read { self.apart.saturating_add(1) } else { 0 };
        self.samples >= limits.stuck && self.apart > limits.bridge
    }
}

/// A sample that can be used, and how many periods it is younger than the one before that could be.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fresh<S> {
    pub(super) sensed: [S; OF_LINK],
    pub(super) periods: S,
}

impl<S: Scalar> Sensors<S> {
    #[inline(always)]
    pub(super) fn new(like: S) -> Self {
        let zero = like.zero();
        Self { stretch: None, unused: zero, lost: 0, still: [Still::NEW; OF_LINK], disagree: Debounce::default() }
    }

    /// What is wrong with a sample, and the readings that are used for it, if it can be used at all.
    #[inline(always)]
    pub(super) fn watch(
        &mut self,
        limits: &Limits<S>,
        input: &SupervisorInput<S>,
        used: Option<[S; SENSORS]>,
        functions: &mut Functions,
    ) -> Option<Fresh<S>> {
        let late = input.missed == 0 && input.delay > limits.late;
        self.lost = if late || input.missed > 0 { self.lost.saturating_add(1).max(input.missed) } else { 0 };
        if self.lost > 0 {
            let over = self.lost >= limits.silence;
            *functions = functions.with(Function::Late, late && over).with(Function::Silence, !late && over);
            self.unused = if late { self.unused + input.periods } else { self.unused };
            return None;
        }
        // The sensor at the grip measures a hand, which may do anything; it must be a number.
        let numbers = input.sensed.iter().all(|&value| finite(value));
        let (true, Some(used)) = (numbers, used) else {
            *functions = functions.with(Function::NotANumber, true);
            self.unused = self.unused + input.periods;
            return None;
        };
        let in_rad = |[force, position, base, _]: [S; SENSORS]| [force, position, base / limits.base_arm];
        let (raw, y) = (in_rad(input.sensed), in_rad(used));
        let beyond = |k: usize| below(limits.range[k], raw[k].abs());
        *functions = functions.with(Function::OutOfRange, beyond(0) || beyond(1) || beyond(2));
        let periods = self.unused + input.periods;
        self.unused = periods.zero();
        let same = |k: usize| !below(y[k].zero(), (raw[k] - y[k]).abs());
        self.agree(limits, (&y, same(0) && same(1) && same(2)), periods, functions);
        Some(Fresh { sensed: y, periods })
    }

    /// Eq. (9) against the three sensors, and each against what the other two make of it; `read`: none of them is a prediction.
    #[inline(always)]
    fn agree(&mut self, limits: &Limits<S>, (y, read): (&[S; OF_LINK], bool), periods: S, functions: &mut Functions) {
        let [per_stiffness, half_play, damping_time] = limits.link;
        let [force, position, angle] = *y;
        let (pulled, base) = (force * per_stiffness, angle * limits.lever);
        let stretch = position - base;
        let per_time = force.constant(1.0) / (limits.period * periods);
        let damped = self.stretch.map_or(force.zero(), |last| (stretch - last) * per_time * damping_time);
        self.stretch = Some(stretch);
        // |r| <= b + d_theta alpha R_b
        let left = (stretch + damped - pulled).abs();
        let wrong = below(half_play + limits.agreement_m, left);
        let disagree = self.disagree.holds(wrong, limits.agreement);
        // k (x - alpha R_b theta), alpha R_b theta + F / k, x - F / k: all as travel of the drive
        let expected = [stretch, base + pulled, position - pulled];
        let most = half_play.times(2.0) + limits.agreement_m;
        let mut stuck = false;
        for k in 0..OF_LINK {
            stuck |= self.still[k].is_stuck(limits, y[k], (expected[k], read), most);
        }
        *functions = functions.with(Function::Disagreement, disagree).with(Function::Stuck, stuck);
    }
}
