//! Sensors: silent, late, not a number, out of range, stuck, or in disagreement.
//!
//! `F` load cell · `x` drive position · `theta` column angle · `s = x - alpha R_b theta` stretch of the link · `k`, `c` its spring and
//! damping, `b` half its play
//!
//! Three sensors measure one link: `F = k (s -+ b) + c s'`, eq. (9). What is left over,
//! `r = s + (c / k) s' - F / k`, within the play, needs no observer and no law, so it judges them too. It is as sharp as the link is soft:
//! an error of the load cell shows once `F / k` comes to the allowed angle.

use super::debounce::Debounce;
use super::function::Function;
use super::input::SupervisorInput;
use super::limits::Limits;
use super::numbers::below;
use crate::Logic;
use crate::logic::{Count, FunctionSet};
use crate::transducers::SENSORS;

/// Those that measure the link: load cell (N), position of the drive (m), column (rad).
pub(super) const OF_LINK: usize = 3;

/// What is remembered of the sensors.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sensors<S: Logic> {
    /// Whether a sample could be used, and the stretch of the link at the last.
    begun: S::Mask,
    stretch: S,
    /// Periods up to samples since `last` that could not be used.
    unused: S,
    /// Cycles in a row without a sample that could be used for its delay.
    lost: S::Count,
    still: [Still<S>; OF_LINK],
    disagree: Debounce<S>,
    /// Whether this sample can be used, and what is used of it.
    pub(super) usable: S::Mask,
    pub(super) fresh: Fresh<S>,
    agreement: Agreement<S>,
}

/// A sensor that shows the same number.
#[derive(Debug, Clone, Copy)]
pub(super) struct Still<S: Logic> {
    begun: S::Mask,
    last: S,
    /// What the others made of it when it changed last, once they are read.
    is_expected: S::Mask,
    expected: S,
    samples: S::Count,
    /// Samples in a row in which the others show motion since then.
    apart: S::Count,
}

/// A sample that can be used, and how many periods it is younger than the one before that could be.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fresh<S> {
    pub(super) sensed: [S; OF_LINK],
    pub(super) periods: S,
}

crate::logic::memory! {
    Sensors { flag begun; number stretch, unused; count lost; parts still; part disagree; flag usable; part fresh, agreement; }
}
crate::logic::memory! { Still { flag begun; number last; flag is_expected; number expected; count samples, apart; } }
crate::logic::memory! { Fresh { numbers sensed; number periods; } }

impl<S: Logic> Still<S> {
    pub(super) fn new(like: S) -> Self {
        let (no, zero, none) = (S::mask(false), like.zero(), S::Count::none());
        Self { begun: no, last: zero, is_expected: no, expected: zero, samples: none, apart: none }
    }

    /// Whether it is stuck: its reading is as it was, and what the others make of it has changed by more than `most`; `read`: none of
    /// them is a prediction.
    #[inline(always)]
    pub(super) fn is_stuck(
        &mut self,
        limits: &Limits<S>,
        reading: S,
        (expected, read): (S, S::Mask),
        most: S,
    ) -> S::Mask {
        let same = self.begun & !below(reading.zero(), (reading - self.last).abs());
        (self.begun, self.last) = (S::mask(true), reading);
        S::paths(self, |this| {
            if S::holds(!same) {
                (this.expected, this.is_expected) = (expected, read);
                (this.samples, this.apart) = (S::Count::none(), S::Count::none());
                return;
            }
            this.samples = this.samples.next();
            // A column that a hand holds still is no fault.
            let apart = this.is_expected & read & below(most, (expected - this.expected).abs());
            this.expected = S::select(this.is_expected, this.expected, expected);
            this.is_expected = this.is_expected | read;
            this.apart = this.apart.in_a_row(apart);
        });
        self.samples.at_least(limits.stuck) & self.apart.above(limits.bridge)
    }
}

impl<S: Logic> Sensors<S> {
    #[inline(always)]
    pub(super) fn new(like: S) -> Self {
        let (zero, no) = (like.zero(), S::mask(false));
        Self {
            begun: no,
            stretch: zero,
            unused: zero,
            lost: S::Count::none(),
            still: [Still::new(like); OF_LINK],
            disagree: Debounce::new(),
            usable: no,
            fresh: Fresh { sensed: [zero; OF_LINK], periods: zero },
            agreement: Agreement { disagree: no, stuck: no },
        }
    }

    /// What is wrong with a sample, and whether it can be used; `used`: the readings that are used for it, if there are any.
    #[inline(always)]
    pub(super) fn watch(
        &mut self,
        limits: &Limits<S>,
        input: &SupervisorInput<S>,
        (known, used): (S::Mask, [S; SENSORS]),
        functions: &mut S::Set,
    ) {
        S::section("sensors");
        let missed = input.missed.some();
        let late = !missed & input.delay.above(limits.late);
        self.lost = self.lost.next().larger(input.missed).only(late | missed);
        let over = self.lost.at_least(limits.silence);
        // The sensor at the grip measures a hand, which may do anything; it must be a number.
        let numbers = input.sensed.iter().fold(known, |numbers, value| numbers & value.is_number());
        self.usable = !(late | missed) & numbers;
        *functions = functions
            .with(Function::Late, late & over)
            .with(Function::Silence, missed & over)
            .with(Function::NotANumber, !(late | missed | numbers));
        let periods = self.unused + input.periods;
        self.unused = S::select(self.usable, periods.zero(), S::select(missed, self.unused, periods));
        let in_rad = |[force, position, base, _]: [S; SENSORS]| [force, position, base / limits.base_arm];
        let (raw, y) = (in_rad(input.sensed), in_rad(used));
        let beyond = |k: usize| below(limits.range[k], raw[k].abs());
        let beyond = beyond(0) | beyond(1) | beyond(2);
        let same = |k: usize| !below(y[k].zero(), (raw[k] - y[k]).abs());
        let read = same(0) & same(1) & same(2);
        self.agreement = Agreement { disagree: S::mask(false), stuck: S::mask(false) };
        S::paths(self, |this| {
            if S::holds(this.usable) {
                this.fresh = Fresh { sensed: y, periods };
                this.agreement = this.agree(limits, (&y, read), periods);
            }
        });
        *functions = functions
            .with(Function::OutOfRange, self.usable & beyond)
            .with(Function::Disagreement, self.agreement.disagree)
            .with(Function::Stuck, self.agreement.stuck);
    }

    /// Eq. (9) against the three sensors, and each against what the other two make of it; `read`: none of them is a prediction.
    #[inline(always)]
    fn agree(&mut self, limits: &Limits<S>, (y, read): (&[S; OF_LINK], S::Mask), periods: S) -> Agreement<S> {
        let [per_stiffness, half_play, damping_time] = limits.link;
        let [force, position, angle] = *y;
        let (pulled, base) = (force * per_stiffness, angle * limits.lever);
        let stretch = position - base;
        let per_time = force.constant(1.0) / (limits.period * periods);
        let damped = (stretch - self.stretch) * per_time * damping_time;
        let damped = S::select(self.begun, damped, force.zero());
        (self.begun, self.stretch) = (S::mask(true), stretch);
        // |r| <= b + d_theta alpha R_b
        let left = (stretch + damped - pulled).abs();
        let wrong = below(half_play + limits.agreement_m, left);
        let disagree = self.disagree.holds(wrong, limits.agreement);
        // k (x - alpha R_b theta), alpha R_b theta + F / k, x - F / k: all as travel of the drive
        let expected = [stretch, base + pulled, position - pulled];
        let most = half_play.times(2.0) + limits.agreement_m;
        let mut stuck = S::mask(false);
        for k in 0..OF_LINK {
            stuck = stuck | self.still[k].is_stuck(limits, y[k], (expected[k], read), most);
        }
        Agreement { disagree, stuck }
    }
}

/// Whether the sensors contradict one another, whether one is stuck.
#[derive(Debug, Clone, Copy)]
struct Agreement<S: Logic> {
    disagree: S::Mask,
    stuck: S::Mask,
}

crate::logic::memory! { Agreement { flag disagree, stuck; } }
