//! Dry friction on one velocity: Coulomb friction while it moves, static friction while it rests.
//!
//! `v` velocity · `a` acceleration without the friction · `f` friction while moving, `f_s >= f` what breaks away, both as
//! accelerations (force over inertia) · `s` direction of motion, +1 or -1 · `h` step
//!
//! Friction is a set, not a function of the velocity: at rest it takes whatever value holds the velocity at zero, as long as
//! `|a| <= f_s`. So the velocity of what sticks is exactly zero, and nothing creeps. Within one step the direction is kept, and
//! what happens inside the step (the velocity passes zero, the part breaks away) is put right after it, to second order in `h`.

use crate::Scalar;

/// Dry friction as accelerations.
#[derive(Debug, Clone, Copy)]
pub struct DryFriction<S> {
    /// `f`: deceleration while moving.
    pub kinetic: S,
    /// `f_s`: acceleration that breaks away.
    pub breakaway: S,
}

/// What the friction does during one step.
#[derive(Debug, Clone, Copy)]
pub struct Grip<S: Scalar> {
    /// Whether the part sticks.
    pub stuck: S::Mask,
    /// Acceleration by the friction while the part moves: `-s f`.
    pub drag: S,
    /// Velocity at the start of the step.
    pub velocity: S,
    /// Acceleration without friction at the start of the step.
    pub pull: S,
}

impl<S: Scalar> Grip<S> {
    /// A part that has come to rest, and not just now broken away.
    #[inline(always)]
    pub fn resting(like: S) -> Self {
        let zero = like.zero();
        Self { stuck: zero.less(like.constant(1.0)), drag: zero, velocity: zero, pull: like.constant(f64::INFINITY) }
    }
}

/// Changes of velocity and displacement.
#[derive(Debug, Clone, Copy)]
pub struct Change<S> {
    /// New velocity.
    pub velocity: S,
    /// To be added to the displacement.
    pub displacement: S,
}

impl<S: Scalar> DryFriction<S> {
    /// From forces: `kinetic` while moving, `breakaway` (at least that) at rest, over the inertia that they slow down.
    #[inline(always)]
    pub fn new(kinetic: S, breakaway: S, per_force: S) -> Self {
        Self { kinetic: kinetic * per_force, breakaway: breakaway.max(kinetic) * per_force }
    }

    /// The friction of a step that begins with velocity `v` and friction-free acceleration `a`.
    #[inline(always)]
    pub fn grip(&self, v: S, a: S) -> Grip<S> {
        let rests = at_rest(v);
        let stuck = rests & a.zero().less(self.breakaway) & !self.breakaway.less(a.abs());
        let drag = -self.kinetic.times_sign(S::select(rests, a, v));
        Grip { stuck, drag, velocity: v, pull: a }
    }

    /// A part that broke away during the last step: its velocity now, and how far it came. `before` is the friction-free
    /// acceleration at the start of that step, `a` that of now; both hold while `v` is zero.
    #[inline(always)]
    pub fn broken_away(&self, v: S, before: S, a: S, h: S) -> Change<S> {
        let (was, is) = (before.abs(), a.abs());
        let breaks = at_rest(v) & self.breakaway.less(is) & !self.breakaway.less(was);
        // Share of the step that was left when |a| passed f_s, were it to grow evenly.
        let left = S::select(breaks, (is - self.breakaway) / (is - was), v.zero()) * h;
        let gained = ((self.breakaway + is).times(0.5) - self.kinetic) * left;
        let velocity = S::select(breaks, gained.times_sign(a), v);
        Change { velocity, displacement: (velocity * left).times(0.5) }
    }

    /// What holds where a step, under the drag of its start, ends with velocity `v`: past zero the part sticks or turns back.
    /// `per_h` is `1 / h`.
    #[inline(always)]
    pub fn passed_zero(&self, grip: &Grip<S>, v: S, h: S, per_h: S) -> Change<S> {
        let v_0 = grip.velocity;
        // The drag points against the motion, so a velocity along it has turned round.
        let turned = v.zero().less(v * grip.drag) & !grip.stuck;
        let to_zero = S::select(turned, v_0 / (v_0 - v), v.zero()); // share of the step until the velocity is zero
        let pull = (v - v_0) * per_h - grip.drag; // mean acceleration without friction
        let sticks = !self.breakaway.less(pull.abs());
        let left = (v.constant(1.0) - to_zero) * h;
        let onward = (pull - self.kinetic.times_sign(pull)) * left;
        let velocity = S::select(turned, S::select(sticks, v.zero(), onward), v);
        // Areas under the two straight pieces of the velocity, less the area under the one that was taken.
        let moved = v_0 * (h - left) + velocity * left - (v_0 + v) * h;
        Change { velocity, displacement: S::select(turned, moved.times(0.5), v.zero()) }
    }
}

#[inline(always)]
fn at_rest<S: Scalar>(v: S) -> S::Mask {
    !v.zero().less(v.abs())
}
