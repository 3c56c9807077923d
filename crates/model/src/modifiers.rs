//! What a person sets around a feel while it runs, and how evenly it comes: trim, the factor on the spring, the stick shaker.
//!
//! `T` period · `x+ = x + sat(w - x)` within `r T`: what goes from `x` to the request `w` at the rate `r`
//!
//! The real-time loop and a target board lead these alike. What is no number changes nothing.

use crate::Logic;

/// Fastest change of the commanded neutral, in rad/s, where the feel itself sets no limit; full travel in some seconds.
const TRIM_RATE: f64 = 0.1;
/// Fastest change of the factor on the spring, in 1/s.
const STIFFNESS_FACTOR_RATE: f64 = 1.0;
/// Fastest change of the shaker's share, in 1/s.
const SHAKER_RATE: f64 = 5.0;

/// What the feel is told from outside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FeelModifiers<S = f64> {
    /// Commanded neutral in rad.
    pub trim_rad: S,
    /// Factor on the feel's spring.
    pub stiffness_factor: S,
    /// How far the stick shaker is on, 0 to 1.
    pub shaker: S,
}

impl FeelModifiers {
    /// Nothing: the spring as it is.
    pub const NONE: Self = Self { trim_rad: 0.0, stiffness_factor: 1.0, shaker: 0.0 };
}

/// What a feel says of how it is led.
#[derive(Debug, Clone, Copy)]
pub struct ModifierRates<S> {
    /// Its own limit of the trim's rate, in rad/s.
    pub trim_rate: S,
    /// Of its shaker, in rad/s.
    pub shaker_frequency: S,
    /// `T` in s.
    pub period: S,
}

/// What is led to where it is wanted.
#[derive(Debug, Clone, Copy)]
pub struct ModifierRamp<S> {
    now: FeelModifiers<S>,
    /// Turns of the shaker since the last whole one.
    turns: S,
}

crate::logic::memory! { FeelModifiers { number trim_rad, stiffness_factor, shaker; } }
crate::logic::memory! { ModifierRamp { part now; number turns; } }

impl<S: Logic> ModifierRamp<S> {
    /// From the spring as it is, its neutral at an angle.
    #[inline(always)]
    pub fn at(trim_rad: S) -> Self {
        let zero = trim_rad.zero();
        let now = FeelModifiers { trim_rad, stiffness_factor: zero.constant(1.0), shaker: zero };
        Self { now, turns: zero }
    }

    /// A period nearer to what is wanted.
    #[inline(always)]
    pub fn step(&mut self, wanted: &FeelModifiers<S>, pace: &ModifierRates<S>) -> FeelModifiers<S> {
        let towards = |now: S, wanted: S, rate: S| {
            S::select(wanted.is_number(), now + (wanted - now).within(rate * pace.period), now)
        };
        let (now, like) = (self.now, pace.period);
        let trim_rate = pace.trim_rate.min(like.constant(TRIM_RATE));
        self.now = FeelModifiers {
            trim_rad: towards(now.trim_rad, wanted.trim_rad, trim_rate),
            stiffness_factor: towards(
                now.stiffness_factor,
                wanted.stiffness_factor,
                like.constant(STIFFNESS_FACTOR_RATE),
            ),
            shaker: towards(now.shaker, wanted.shaker, like.constant(SHAKER_RATE)),
        };
        self.now
    }

    /// The swing of a shaker that is on so far, -1 to 1, in this period; once in each.
    #[inline(always)]
    pub fn swing(&mut self, shaker: S, pace: &ModifierRates<S>) -> S {
        let (turns, one) = (self.turns, shaker.constant(1.0));
        let next = turns + pace.shaker_frequency.times(1.0 / core::f64::consts::TAU) * pace.period;
        self.turns = S::select(next.less(one), next, next - one);
        let on = shaker.zero().less(shaker.abs());
        if S::any(on) {
            S::select(on, shaker * turns.times(core::f64::consts::TAU).sin(), shaker.zero())
        } else {
            shaker.zero()
        }
    }
}
