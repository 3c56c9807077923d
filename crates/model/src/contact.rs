//! One-sided springs and dampers: stops.
//!
//! `x`, `x'` position and velocity · `d` depth of penetration, with its sign · `k`, `c` spring rate and damping

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

impl<S: Scalar> Stops<S> {
    /// Force of the stops on what moves; zero between them. A stop pushes and never pulls.
    #[inline(always)]
    pub fn force(&self, x: S, x_rate: S) -> S {
        let depth = x - x.clamp(self.low, self.high);
        // F = -(k d + c x'), as long as it points out of the stop
        let push = self.stiffness * depth + self.damping * x_rate;
        S::select(x.zero().less(push * depth), -push, x.zero())
    }
}
