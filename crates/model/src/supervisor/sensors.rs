//! Sensors: silent, not a number, out of range, jumping, stuck, or in disagreement.
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
    still: [Still<S>; OF_LINK],
    disagree: Debounce,
}

/// A sensor that shows the same number.
#[derive(Debug, Clone, Copy)]
struct Still<S> {
    /// What the others made of it when it changed last, as drive travel in m.
    expected: S,
    samples: u32,
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
        let still = Still { expected: zero, samples: 0 };
        Self { last: None, stretch: zero, unused: zero, still: [still; OF_LINK], disagree: Debounce::default() }
    }

    /// What is wrong with a sample, and the sample if it can be used.
    #[inline(always)]
    pub(super) fn watch(
        &mut self,
        limits: &Limits<S>,
        input: &SupervisorInput<S>,
        functions: &mut Functions,
    ) -> Option<Fresh<S>> {
        if input.missed > 0 {
            *functions = functions.with(Function::Silence, input.missed >= limits.silence);
            return None;
        }
        let [force, position, base, _]: [S; SENSORS] = input.sensed;
        let y = [force, position, base * (base.constant(1.0) / limits.base_arm)];
        // The sensor at the grip measures a hand, which may do anything; it must be a number.
        if !input.sensed.iter().all(|&value| finite(value)) {
            *functions = functions.with(Function::NotANumber, true);
            self.unused = self.unused + input.periods;
            return None;
        }
        let beyond = |k: usize| below(limits.range[k], y[k].abs());
        *functions = functions.with(Function::OutOfRange, beyond(0) || beyond(1) || beyond(2));
        let periods = self.unused + input.periods;
        self.unused = base.zero();
        self.jump(limits, &y, periods, functions);
        self.agree(limits, &y, periods, functions);
        self.last = Some(y);
        Some(Fresh { sensed: y, periods })
    }

    #[inline(always)]
    fn jump(&self, limits: &Limits<S>, y: &[S; OF_LINK], periods: S, functions: &mut Functions) {
        let Some(last) = &self.last else { return };
        let jumped = |k: usize| below(limits.jump[k] * periods, (y[k] - last[k]).abs());
        *functions = functions.with(Function::Jump, jumped(0) || jumped(1) || jumped(2));
    }

    /// Eq. (9) against the three sensors, and each against what the other two make of it.
    #[inline(always)]
    fn agree(&mut self, limits: &Limits<S>, y: &[S; OF_LINK], periods: S, functions: &mut Functions) {
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
                stuck |= still.samples >= limits.stuck && below(most, (expected[k] - still.expected).abs());
            } else {
                self.still[k] = Still { expected: expected[k], samples: 0 };
            }
        }
        *functions = functions.with(Function::Disagreement, disagree).with(Function::Stuck, stuck);
    }
}
