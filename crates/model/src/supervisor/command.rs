//! The command: held to its limits, or led to zero.
//!
//! `e` command of the law · `e_max` the largest · `s` share of the feel, `s_0` share with which it begins
//!
//! While the feel comes, the command has `s_0 + (1 - s_0) s` of its limit: a valve that much of its speed, a motor that much of its torque.

use super::function::Function;
use super::limits::Limits;
use super::numbers::below;
use crate::Logic;
use crate::logic::FunctionSet;

/// Share of the limit at which a command is at it.
const AT_LIMIT: f64 = 0.99;

/// What was commanded last.
#[derive(Debug, Clone, Copy)]
pub(super) struct Command<S: Logic> {
    pub(super) last: S,
    /// Samples at its limit less samples that were not, so that a command to and fro between both limits counts too.
    saturated: S,
    /// Whether the last step towards zero came there.
    pub(super) is_zero: S::Mask,
}

crate::logic::memory! { Command { number last, saturated; flag is_zero; } }

impl<S: Logic> Command<S> {
    #[inline(always)]
    pub(super) fn new(like: S) -> Self {
        Self { last: like.zero(), saturated: like.zero(), is_zero: S::mask(true) }
    }

    /// Whether commands have been at their limit for too long, the last one included; while the feel comes they may be.
    #[inline(always)]
    pub(super) fn saturated(&mut self, limits: &Limits<S>, active: S::Mask) -> S::Mask {
        let at = limits.command.times(AT_LIMIT);
        let one = at.constant(1.0);
        let more = S::select(active & !below(self.last.abs(), at), one, -one);
        self.saturated = (self.saturated + more).max(one.zero());
        !below(self.saturated, one.times(f64::from(limits.saturation)))
    }

    /// The law's command as far as it is allowed.
    #[inline(always)]
    pub(super) fn follow(&mut self, limits: &Limits<S>, e: S, share: S, functions: &mut S::Set) {
        let most = Self::largest(limits, share);
        let e = S::select(e.is_number(), e, self.last);
        let held = e.within(most);
        let slowed = self.last + (held - self.last).within(limits.command_step);
        let differs = |a: S, b: S| below(a.zero(), (a - b).abs());
        *functions =
            functions.with(Function::CommandLimit, differs(held, e)).with(Function::CommandRate, differs(slowed, held));
        // The limit comes first: it may shrink faster than the command may change.
        self.last = slowed.within(most);
    }

    /// A sample nearer to zero.
    #[inline(always)]
    pub(super) fn stop(&mut self, limits: &Limits<S>) {
        let step = limits.stop_step;
        // What rounding leaves of the last step goes with it.
        self.is_zero = below(self.last.abs(), step.times(1.0 + STEP_ROUNDING));
        self.last = S::select(self.is_zero, step.zero(), self.last - self.last.within(step));
    }

    /// Zero now.
    #[inline(always)]
    pub(super) fn cut(&mut self) {
        self.last = self.last.zero();
    }

    #[inline(always)]
    fn largest(limits: &Limits<S>, share: S) -> S {
        let one = share.constant(1.0);
        (one * limits.start_share + share * (one - limits.start_share)).within(one) * limits.command
    }
}

/// Relative, of a sum of some hundred steps in single precision.
const STEP_ROUNDING: f64 = 1e-4;
