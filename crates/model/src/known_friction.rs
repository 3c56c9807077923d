//! Dry friction of the column that the controller knows, and learns: part of a law with an observer, as data.
//!
//! To every sensor the friction between hand and load cell looks like a hand that pulls. What is known of it is given back:
//!
//! `v = r [xi; y; delta; delta']` rate of the column as the observer estimates it · `F_-`, `F_+` friction as stated, of motion towards
//! negative and positive angles, a torque on the column · `beta` share by which breakaway is above it, `omega_s` Stribeck velocity ·
//! `g` share that was learnt beyond it in the direction of `w`, `g'` in the other, `g_-`, `g_+` their bounds, `h` what is trusted of either · `U` what
//! both may be off by · `v_s` slow · `l` leak ·
//! `T_o` torque that the observer estimates · `T` torque that the feel computer receives · `a` gain · `q` torque of a hand · `c` blur · `d` trust
//!
//! | | |
//! |---|---|
//! | `C = F (1 + beta exp(-(v / omega_s)^2)) (1 + g)` | friction at this rate, `F` and `g` of a direction |
//! | `w = v / sqrt(v^2 + v_s^2)`, `f = C w` | friction that the observer's plant is told: `xi+ = A xi + B [y; e] + b f` |
//! | `C s-` to `C s+`, `s- = min(w, sat(2 (v - v_s) / v_s))`, `s+ = max(w, sat(2 (v + v_s) / v_s))`, `C` of either sign's direction | torques of the friction that the rate allows: all at rest, one in motion |
//! | `T' = T + l (T_m - T)`, `T_m = T_o - f` where `|T_b| >= q`, else 0 | under a hand what is received drifts to what is measured, with the hand off to nothing |
//! | `T+ = T'`, as near as `T_o - f + C [s-, s+] + U [-1, 1]` lets it | a play: at rest the hand has done nothing until it must have |
//! | `g+ = sat(g - a w T_o)` where `w w_b > 4/5`, `|T_b| < T_g` | with the hand off `T_o = (C - C_true) sgn v` |
//! | `g'+ = sat(g' - a w T_o / 2)` there | as warm oil changes both directions, so does half of it the other |
//! | `h+ = h + d (g - h)` there if `|v| > v_t`, of both | trusted once it has held for a while, of a column as fast as no slow hand |
//! | `g+ = g + c (h - g)`, of both, where `|T_b| >= T_g` if `w w_b > 4/5`, else `>= q` | the hand was there all along: what was learnt of late was its own |
//! | `T_g = max(|f|, q - |f|)` | in motion more is a hand |
//! | `T_b+ = T_b + c (T_o - T_b)`, `w_b+ = w_b + c (w - w_b)` | torque and way of late |
//!
//! The exponential is `1 / (1 + u + u^2 / 2 + u^3 / 6)`, `u = (v / omega_s)^2`: within 0.025 of it, and four products.
//!
//! `s-` to `s+` includes `w`, so that `T = T_o` is always allowed. `T_o` does not follow the noise of `v`: where only noise changed `w`, the play
//! would push a slow column on past its neutral, at about three times `v_s`.
//!
//! `v_s` is at least what friction changes of the estimated rate in a sample, `C |r b|`. From half of that down the observer of a column at rest
//! would change the sign of its rate with each sample.
//!
//! A column that friction holds looks like a hand that pushes with all of it, so that `q` is the most that friction may be. With less, the feel
//! would be driven each time that the column turns round.
//!
//! `U` keeps noise and the level's own error from driving the feel with the hand off. A column that came to rest under a hand is let go
//! of within `1 / l` samples: else whoever pushes at it would have to overcome the friction twice.
//!
//! A column that friction holds is a stiff contact, and the loop would shake it loose again and again. Where it rests and the feel's
//! spring has less than `U`, which no compensation can render, the law of [`crate::contact_law`] holds it: `|theta'| < v_r`, smoothed
//! as there, `|G (delta - n)| < U`, and `s > 1/2`. Its `T_c` is `q + |T_b|` at most: friction and hand hold no more, and what the load cell shows
//! beyond that turns the drive round between two swings.
//!
//! `s` distinguishes a column at rest from a feel at a turning point, whose rate is below `v_r` for `2 v_r I / U` if its spring torque is `U`.
//! `s+ = s + (h / t) (1 - s)` if the spring torque is below `U`, else `s - (h / t) s`. At rest `t` is ten times that interval, at most 60 ms: a light
//! feel shakes the column loose sooner. Otherwise `t` is 2 s, so that a persistent swing within `U` is held at a turning point.
//!
//! Nothing is learnt at rest, nor as the column turns round, where friction and estimate turn at different times, nor under a hand that
//! pushes with more than the friction, or than it may be more. A hand that moves the column to and fro passes through zero torque on its way, and
//! teaches there: up, then down again, so that the last stays. Its push takes that back to `h`, which follows too slowly to see either. A hand
//! that pushes with less all along, or drives the column at the feel's own frequency, where its torque goes with the rate, looks like friction:
//! what it can teach is bounded by `g_-`, `g_+`.
//!
//! The set of torques of dry friction: B. Armstrong-Helouvry, P. Dupont, C. Canudas de Wit, A survey of models, analysis tools and
//! compensation methods for the control of machines with friction, Automatica 30(7) (1994) 1083-1138. The play operator: M. A.
//! Krasnosel'skii, A. V. Pokrovskii, Systems with Hysteresis, Springer 1989. A level learnt from what is left over, along the sign of
//! the rate, goes back to B. Friedland and Y.-J. Park (1991, as later papers cite them).

use crate::Scalar;
use crate::law_vector::{Estimate, KNOWN, MOST_STATES, SAMPLED, product};
use crate::memory::MemoryVisitor;

/// Numbers of it, in the order of [`KnownFriction::take`]: `r`, `b`, then `F_-`, `F_+` in N m, `beta`, `1 / omega_s` in s/rad, `U` in N m,
/// `v_s` in rad/s, `l`, `g_-`, `g_+`, `a` in 1/(N m), `q` in N m, `c`, `d`, `v_r` in rad/s.
pub const FRICTION_NUMBERS: usize = KNOWN + MOST_STATES + LEVEL_FROM_END;

/// Place of `F_-` among them, from the end.
pub const LEVEL_FROM_END: usize = 14;

/// Least `v_s` in rad/s, so that nothing is divided by zero.
const SLOWEST: f64 = 1e-9;

/// The friction that a law knows.
#[derive(Debug, Clone, Copy)]
pub struct KnownFriction<S> {
    rate: [S; KNOWN],
    enters: [S; MOST_STATES],
    levels: [S; 2],
    breakaway: S,
    per_stribeck: S,
    uncertain: S,
    slow: S,
    leak: S,
    least: S,
    most: S,
    gain: S,
    hand: S,
    blur: S,
    trust: S,
    rest: S,
}

/// Largest `t` at rest in s. With twice as much, a column with 0.5 lb swings on in one of fifty settings.
const RESTS_S: f64 = 0.06;

/// `t` at rest over the interval for which a turning feel is slower than `v_r`.
const TURNS: f64 = 10.0;

/// `t` in motion in s.
const MOVES_S: f64 = 2.0;

/// `w w_b` from which on the column moves one way.
const ONE_WAY: f64 = 0.8;

/// Rate of the column in rad/s from which on what it teaches is trusted. A slow hand moves it through zero torque for as long as a release takes
/// to settle.
const TRUSTED_RAD_PER_S: f64 = 0.05;

/// Share of what one direction learns that the other does too. By all of it they could not differ; by none an error of both, the usual
/// one, would be there again each time that the column turns.
const SHARED: f64 = 0.5;

/// What is remembered of it from sample to sample.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FrictionState<S> {
    /// Torque that the feel computer received last.
    pub feel_torque: S,
    /// Share of the friction that was learnt beyond what is stated, of motion towards negative and towards positive angles.
    pub learnt: [S; 2],
    /// What is trusted of it.
    pub trusted: [S; 2],
    /// Torque that was estimated of late.
    pub push: S,
    /// Way of late.
    pub way: S,
    /// `s`.
    pub rested: S,
}

impl<S: Scalar> FrictionState<S> {
    /// Nothing learnt yet, the hand's torque as it is received.
    #[inline(always)]
    pub fn initial(feel_torque: S) -> Self {
        Self {
            feel_torque,
            learnt: [feel_torque.zero(); 2],
            trusted: [feel_torque.zero(); 2],
            push: feel_torque,
            way: feel_torque.zero(),
            rested: feel_torque.zero(),
        }
    }

    /// Visits each number.
    #[inline(always)]
    pub fn visit(&mut self, visitor: &mut impl MemoryVisitor<S>) {
        let Self { feel_torque, learnt, trusted, push, way, rested } = self;
        visitor.nonlinear("feel_torque", feel_torque);
        for (way, of_way) in ["learnt_negative", "learnt_positive"].into_iter().zip(learnt) {
            visitor.nonlinear(way, of_way);
        }
        for (way, of_way) in ["trusted_negative", "trusted_positive"].into_iter().zip(trusted) {
            visitor.nonlinear(way, of_way);
        }
        visitor.nonlinear("push", push);
        visitor.nonlinear("way", way);
        visitor.nonlinear("rested", rested);
    }

    /// Between what two laws recall.
    #[inline(always)]
    pub fn lerp(self, next: Self, share: f64) -> Self {
        let between = |a: S, b: S| a + (b - a).times(share);
        Self {
            feel_torque: between(self.feel_torque, next.feel_torque),
            learnt: core::array::from_fn(|k| between(self.learnt[k], next.learnt[k])),
            trusted: core::array::from_fn(|k| between(self.trusted[k], next.trusted[k])),
            push: between(self.push, next.push),
            way: between(self.way, next.way),
            rested: between(self.rested, next.rested),
        }
    }
}

impl<S: Scalar> KnownFriction<S> {
    /// The numbers one after the other.
    #[inline(always)]
    pub fn take(mut next: impl FnMut() -> S) -> Self {
        let rate = core::array::from_fn(|_| next());
        let enters = core::array::from_fn(|_| next());
        let (levels, breakaway, per_stribeck) = ([next(), next()], next(), next());
        let (uncertain, slow, leak) = (next(), next(), next());
        let (least, most, gain, hand, blur, trust) = (next(), next(), next(), next(), next(), next());
        let rest = next();
        Self {
            rate,
            enters,
            levels,
            breakaway,
            per_stribeck,
            uncertain,
            slow,
            leak,
            least,
            most,
            gain,
            hand,
            blur,
            trust,
            rest,
        }
    }

    /// No friction.
    #[inline(always)]
    pub fn none(like: S) -> Self {
        let zero = like.zero();
        Self::take(|| zero)
    }

    /// What is recalled at the next sample, what is received now among it, and the friction that the observer's plant is told.
    #[inline(always)]
    pub fn friction_torque(
        &self,
        estimated: S,
        (xi, y, feel): (&Estimate<S>, &[S; SAMPLED], [S; 2]),
        state: FrictionState<S>,
    ) -> (FrictionState<S>, S) {
        let v = product(&self.rate, xi, y, feel).named("column_rate");
        let given = [estimated, v];
        let outputs = self.at_rate(S::part_begins(given), &state);
        let [feel_torque, learnt_negative, learnt_positive, trusted_negative, trusted_positive, push, way, friction] =
            S::part_ends(given, outputs);
        let (learnt, trusted) = ([learnt_negative, learnt_positive], [trusted_negative, trusted_positive]);
        (FrictionState { feel_torque, learnt, trusted, push, way, rested: state.rested }, friction)
    }

    /// Whether the column is held, and `s` after a period, from the smoothed rate and the spring torque of the feel; `per_inertia`: one over the
    /// inertia of the feel.
    #[inline(always)]
    pub fn holds(&self, [rate, spring]: [S; 2], per_inertia: S, (rested, period): (S, S)) -> (S::Mask, S) {
        let (zero, one) = (rate.zero(), rate.constant(1.0));
        let weak = spring.abs().less(self.uncertain);
        let rests = weak & rate.abs().less(self.rest);
        let per_turn = self.uncertain * per_inertia / self.rest.max(one.times(SLOWEST)).times(2.0 * TURNS);
        let per_rest = per_turn.max(one.times(1.0 / RESTS_S));
        let share = S::select(rests, (per_rest * period).min(one), period.times(1.0 / MOVES_S));
        let rested = rested + (S::select(weak, one, zero) - rested) * share;
        (rests & one.times(0.5).less(rested), rested)
    }

    /// The most that the friction may be, in N m.
    #[inline(always)]
    pub fn largest(&self) -> S {
        self.hand
    }

    /// What the load cell's torque may be of a column that rests, under a push of late.
    #[inline(always)]
    pub fn at_rest(&self, of_load_cell: S, push: S) -> S {
        of_load_cell.within(self.hand + push.abs())
    }

    /// The next `T`, `g` and `h` of both directions, `T_b, w_b`, and `f`, where `T_o` is estimated at the rate `v`.
    #[inline(always)]
    fn at_rate(&self, [estimated, v]: [S; 2], state: &FrictionState<S>) -> [S; 8] {
        let one = v.constant(1.0);
        // A law without friction, beside one with it in a batch, has no slow rate either.
        let slow = self.slow.max(v.constant(SLOWEST));
        let way = (v / (v * v + slow * slow).sqrt()).named("direction");
        let over_coulomb = self.over_coulomb(v);
        let [negative, positive] = [0, 1].map(|k| self.levels[k] * over_coulomb * (one + state.learnt[k]));
        // Of a rate, or a share of the friction, that has this sign.
        let along = |signed: S| signed * S::select(signed.less(v.zero()), negative, positive);
        let friction = along(way).named("friction_torque");
        let total = estimated - friction;
        let two = v.constant(2.0);
        let per_slow = two / slow;
        // The torque estimate does not follow the noise of the rate: it contains the mean of `w`, the friction this sample's.
        let (low, high) = ((v * per_slow - two).within(one).min(way), (v * per_slow + two).within(one).max(way));
        let off = state.push.abs().less(self.hand);
        let measured = S::select(off, v.zero(), total);
        let drifted = measured + (state.feel_torque - measured) * (one - self.leak);
        let [low, high] = [along(low) - self.uncertain, along(high) + self.uncertain];
        let feel_torque = total + (drifted - total).clamp(low, high);
        // A column at rest may show all of its friction; one that moves shows what is told of it, or what it may be more.
        let one_way = v.constant(ONE_WAY).less(way * state.way);
        let moved = friction.abs().max(self.hand - friction.abs());
        let alone = state.push.abs().less(S::select(one_way, moved, self.hand));
        let ([g, g_positive], [h, h_positive]) = self.learnt(estimated * way, v, (one_way, alone), state);
        let push = state.push + (estimated - state.push) * self.blur;
        let way = state.way + (way - state.way) * self.blur;
        [feel_torque, g, g_positive, h, h_positive, push, way, friction]
    }

    /// Friction over that of a fast column: `1 + beta exp(-(v / omega_s)^2)`.
    #[inline(always)]
    fn over_coulomb(&self, v: S) -> S {
        let one = v.constant(1.0);
        if !S::any(one.zero().less(self.breakaway.abs())) {
            return one;
        }
        let share = v * self.per_stribeck;
        let u = share * share;
        let series = one + u * (one + u * (one + u.times(1.0 / 3.0)).times(0.5));
        one + self.breakaway / series
    }

    /// What is known beyond `F` after a sample, and trusted: what is estimated along the motion of a column that moves one way, alone, was the
    /// friction's.
    #[inline(always)]
    fn learnt(
        &self,
        estimated: S,
        v: S,
        (one_way, alone): (S::Mask, S::Mask),
        state: &FrictionState<S>,
    ) -> ([S; 2], [S; 2]) {
        let teaches = one_way & alone;
        let trust = S::select(v.constant(TRUSTED_RAD_PER_S).less(v.abs()), self.trust, v.zero());
        let own = estimated * self.gain;
        let other = own.times(SHARED);
        let negative = v.less(v.zero());
        let less = [S::select(negative, own, other), S::select(negative, other, own)];
        let next = |k: usize| {
            let (was, held) = (state.learnt[k], state.trusted[k]);
            let learnt = (was - less[k]).clamp(self.least, self.most);
            let back = was + (held - was) * self.blur;
            let trusted = held + (was - held) * trust;
            (S::select(teaches, learnt, S::select(alone, was, back)), S::select(teaches, trusted, held))
        };
        let [(g, h), (g_positive, h_positive)] = [next(0), next(1)];
        ([g, g_positive], [h, h_positive])
    }

    /// How a state of the observer moves by the friction.
    #[inline(always)]
    pub fn moves(&self, state: usize, friction: S) -> S {
        self.enters[state] * friction
    }
}
