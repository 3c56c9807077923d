//! Dry friction of the column that the controller knows: part of a law with an observer, as data.
//!
//! To every sensor the friction between hand and load cell looks like a hand that pulls. What is known of it is given back:
//!
//! `v = r [xi; y; delta; delta']` rate of the column as the observer estimates it · `F` friction, a torque on the column · `M` margin ·
//! `v_s` slow · `l` leak · `T_o` torque that the observer estimates · `T` torque that the feel computer hears
//!
//! | | |
//! |---|---|
//! | `f = F v / sqrt(v^2 + v_s^2)` | friction that the observer's plant is told: `xi+ = A xi + B [y; e] + b f` |
//! | `F [s-, s+]`, `s-+ = sat(2 (v -+ v_s) / v_s)` | torques of the friction that the rate allows: all at rest, one in motion |
//! | `T' = T + l (T_o - f - T)` | what is heard drifts to what is measured |
//! | `T+ = T'`, as near as `T_o - f + (F + M rest) [s-, s+]` lets it | a play: at rest the hand has done nothing until it must have |
//!
//! `rest = (s+ - s-) / 2`, so that the margin, which keeps the sensors' noise from pushing at the edges of the play, is nothing in
//! motion. A column that came to rest is let go of within `1 / l` samples: else whoever pushes at it would have to overcome the
//! friction twice.
//!
//! The set of torques of dry friction: B. Armstrong-Helouvry, P. Dupont, C. Canudas de Wit, A survey of models, analysis tools and
//! compensation methods for the control of machines with friction, Automatica 30 (1994) 1083-1138. The play operator: M. A.
//! Krasnosel'skii, A. V. Pokrovskii, Systems with Hysteresis, Springer 1989.

use crate::Scalar;
use crate::observer::{Estimate, KNOWN, MOST_STATES, SAMPLED, said};

/// Numbers of it, in the order of [`KnownFriction::take`]: `r`, `b`, then `F`, `M` in N m, `v_s` in rad/s, `l`.
pub const FRICTION_NUMBERS: usize = KNOWN + MOST_STATES + 4;

/// Place of `F` among them, from the end.
pub const LEVEL_FROM_END: usize = 4;

/// Least `v_s` in rad/s, so that nothing is divided by zero.
const SLOWEST: f64 = 1e-9;

/// The friction that a law knows.
#[derive(Debug, Clone, Copy)]
pub struct KnownFriction<S> {
    rate: [S; KNOWN],
    enters: [S; MOST_STATES],
    level: S,
    margin: S,
    slow: S,
    leak: S,
}

impl<S: Scalar> KnownFriction<S> {
    /// The numbers one after the other.
    #[inline(always)]
    pub fn take(mut next: impl FnMut() -> S) -> Self {
        let rate = core::array::from_fn(|_| next());
        let enters = core::array::from_fn(|_| next());
        Self { rate, enters, level: next(), margin: next(), slow: next(), leak: next() }
    }

    /// No friction.
    #[inline(always)]
    pub fn none(like: S) -> Self {
        let zero = like.zero();
        Self { rate: [zero; KNOWN], enters: [zero; MOST_STATES], level: zero, margin: zero, slow: zero, leak: zero }
    }

    /// What is heard of an estimated torque where `heard` was heard last, and the friction that the observer's plant is told.
    #[inline(always)]
    pub fn given_back(&self, estimated: S, (xi, y, feel): (&Estimate<S>, &[S; SAMPLED], [S; 2]), heard: S) -> (S, S) {
        let v = said(&self.rate, xi, y, feel);
        let one = v.constant(1.0);
        // A law without friction, beside one with it in a batch, has no slow rate either.
        let slow = self.slow.max(v.constant(SLOWEST));
        let friction = self.level * v / (v * v + slow * slow).sqrt();
        let total = estimated - friction;
        let (low, high) = ((v - slow).times(2.0) / slow, (v + slow).times(2.0) / slow);
        let (low, high) = (low.within(one), high.within(one));
        let band = self.level + self.margin * (high - low).times(0.5);
        let drifted = heard + (total - heard) * self.leak;
        let played = drifted.clamp(total + low * band, total + high * band);
        (S::select(v.zero().less(self.level), played, total), friction)
    }

    /// How a state of the observer moves by the friction.
    #[inline(always)]
    pub fn moves(&self, state: usize, friction: S) -> S {
        self.enters[state] * friction
    }
}
