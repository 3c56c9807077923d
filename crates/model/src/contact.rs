//! One-sided springs and dampers: stops.
//!
//! `x`, `x'` position and velocity · `d` depth of penetration, with its sign · `k`, `c` spring rate and damping · `h` step ·
//! `T` time from the touch to the end of the step
//!
//! Whether something touches is settled at the start of a step and holds through it, as dry friction does: a force that came in
//! between two stages would be weighted by the stages and not by its time. What a touch inside a step did is made good after it.

use crate::Scalar;

/// A range that is free, between two stops.
#[derive(Debug, Clone, Copy)]
pub struct Stops<S> {
    /// Lower stop.
    pub low: S,
    /// Upper stop.
    pub high: S,
    /// Spring rate of the stops.
    pub stiffness: S,
    /// Damping of the stops.
    pub damping: S,
}

/// A touch inside a step: to be added to what the step found without it.
#[derive(Debug, Clone, Copy)]
pub struct Push<S> {
    /// Change of velocity.
    pub velocity: S,
    /// Change of displacement.
    pub displacement: S,
}

impl<S: Scalar> Stops<S> {
    /// Whether `x` lies in one of the stops.
    #[inline(always)]
    pub fn touch(&self, x: S) -> S::Mask {
        x.less(self.low) | self.high.less(x)
    }

    /// Force of the stops on what is at `x` within a step that began at `start`; zero where that lay in none of them, and where the stop
    /// has been left: a stop pushes and never pulls.
    #[inline(always)]
    pub fn force(&self, start: S, (x, x_rate): (S, S)) -> S {
        // F = -(k (x - x_stop) + c x'), as long as it points out of the stop: of m the larger of it and zero is (m + |m|) / 2
        let (k, resisted) = (self.stiffness.times(-0.5), self.damping.times(-0.5) * x_rate);
        let zero = x.zero();
        let (of_high, of_low) = (k * (x - self.high) + resisted, k * (x - self.low) + resisted);
        let of_high = S::select(self.high.less(x), of_high - of_high.abs(), zero);
        let of_low = S::select(x.less(self.low), of_low + of_low.abs(), zero);
        S::select(self.touch(start), S::select(self.high.less(start), of_high, of_low), zero)
    }

    /// What a stop did from the touch to the end of a step that went from `x_0` to `x`, `x'` as if there were none. `per_force`
    /// is the acceleration per force; zero for what did not touch.
    #[inline(always)]
    pub fn push(&self, (x_0, x): (S, S), x_rate: S, h: S, per_force: S) -> Push<S> {
        let touched = self.touch(x) & !self.touch(x_0);
        if !S::any(touched) {
            return Push { velocity: x.zero(), displacement: x.zero() };
        }
        let depth = x - x.clamp(self.low, self.high);
        let (time, at_touch) = since_touch(touched, (depth, x - x_0), x_rate, h);
        let (k, c) = (self.stiffness * per_force, self.damping * per_force);
        // The force without the stop's own effect on the velocity, a straight line over T; that effect to first order.
        let (first, last) = (c * at_touch, k * depth + c * x_rate);
        let damped = time * c;
        let one = x.constant(1.0);
        let velocity = (first + last).times(0.5) * time / (one + damped.times(0.5));
        let displacement = (first.times(2.0) + last).times(1.0 / 6.0) * time * time / (one + damped.times(1.0 / 3.0));
        Push {
            velocity: S::select(touched, -velocity, x.zero()),
            displacement: S::select(touched, -displacement, x.zero()),
        }
    }
}

/// Time since a touch, and velocity at it, of what went `way` in the last step, is now `depth` beyond, a part of that way, and has the
/// velocity `x_rate`; its velocity a straight line over the step. Of what has not `met` a stop it is some number.
#[inline(always)]
pub fn since_touch<S: Scalar>(met: S::Mask, (depth, way): (S, S), x_rate: S, h: S) -> (S, S) {
    // What has not, may have gone no way.
    let share = depth / S::select(met, way, way.constant(1.0));
    // x'_0 = 2 (x - x_0) / h - x'
    let at_touch = x_rate - (x_rate - way / h).times(2.0) * share;
    let mean = (at_touch + x_rate).times(0.5);
    let straight = share * h;
    // Where the velocity turns about inside the step, the straight line is as good as any.
    let time = S::select(way.zero().less(mean * depth), (depth / mean).min(h), straight);
    (time, at_touch)
}
