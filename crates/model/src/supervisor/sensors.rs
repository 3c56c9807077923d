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
    last: Option<[S; OF_LINK]>,
    stretch: S,
    /// Periods up to samples since `last` that could not be used.
    unused: S,
    /// Cycles in a row without a sample that could be used for its delay.
    lost: u32,
    still: [Still<S>; OF_LINK],
    disagree: Debounce,
}

/// A sensor that shows the same number.
#[derive(Debug, Clone, Copy)]
struct Still<S> {
    /// What the others made of it when it changed last, as drive travel in m; nothing before they are read.
    expected: Option<S>,
    samples: u32,
    /// Samples in a row in which the others show motion since then.
    apart: u32,
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
        let still = Still { expected: None, samples: 0, apart: 0 };
        Self {
            last: None,
            stretch: zero,
            unused: zero,
            lost: 0,
            still: [still; OF_LINK],
            disagree: Debounce::default(),
        }
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
        self.last = Some(y);
        Some(Fresh { sensed: y, periods })
    }

    /// Eq. (9) against the three sensors, and each against what the other two make of it; `read`: none of them is a prediction.
    #[inline(always)]
    fn agree(&mut self, limits: &Limits<S>, (y, read): (&[S; OF_LINK], bool), periods: S, functions: &mut Functions) {
        let [per_stiffness, half_play, damping_time] = limits.link;
        let [force, position, angle] = *y;
        let (pulled, base) = (force * per_stiffness, angle * limits.lever);
        let stretch = position - base;
        let first = self.last.is_none();
        let rate = (stretch - self.stretch) * (force.constant(1.0) / (limits.period * periods));
        let damped = if first { rate.zero() } else { rate * damping_time };
        self.stretch = stretch;
        // |r| <= b + d_theta alpha R_b
        let left = (stretch + damped - pulled).abs();
        let wrong = below(half_play + limits.agreement_m, left);
        let disagree = self.disagree.holds(wrong, limits.agreement);
        // k (x - alpha R_b theta), alpha R_b theta + F / k, x - F / k: all as travel of the drive
        let expected = [stretch, base + pulled, position - pulled];
        let most = half_play.times(2.0) + limits.agreement_m;
        let mut stuck = false;
        for k in 0..OF_LINK {
            let same = self.last.is_some_and(|last| !below((y[k] - last[k]).abs().zero(), (y[k] - last[k]).abs()));
            if same {
                let still = &mut self.still[k];
                still.samples = still.samples.saturating_add(1);
                still.expected = still.expected.or(read.then_some(expected[k]));
                // A column that a hand holds still is no fault.
                let apart = still.expected.is_some_and(|before| below(most, (expected[k] - before).abs()));
                still.apart = if apart && read { still.apart.saturating_add(1) } else { 0 };
                stuck |= still.samples >= limits.stuck && still.apart > limits.bridge;
            } else {
                self.still[k] = Still { expected: read.then_some(expected[k]), samples: 0, apart: 0 };
            }
        }
        *functions = functions.with(Function::Disagreement, disagree).with(Function::Stuck, stuck);
    }
}
