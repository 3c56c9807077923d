//! Dry friction on one velocity: Coulomb friction while it moves, static friction while it rests.
//!
//! `v` velocity · `a` acceleration without the friction · `f` friction while moving, `f_s >= f` what breaks away, both as
//! accelerations (force over inertia) · `s` direction of motion, +1 or -1 · `a_F` asymmetry: `f (1 + s a_F)` in that direction ·
//! `h` step
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
    /// `a_F`.
    pub asymmetry: S,
}

/// What the friction does during one step.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StickState<S: Scalar> {
    /// Whether the part sticks.
    pub stuck: S::Mask,
    /// Acceleration by the friction while the part moves: `-s f`.
    pub drag: S,
    /// Velocity at the start of the step.
    pub velocity: S,
    /// Acceleration without friction at the start of the step.
    pub pull: S,
}

impl<S: Scalar> StickState<S> {
    /// A part that has come to rest, and not just now broken away.
    pub fn resting(friction: &DryFriction<S>) -> Self {
        let zero = friction.breakaway.zero();
        let stuck = zero.less(friction.breakaway);
        Self { stuck, drag: zero, velocity: zero, pull: zero.constant(f64::INFINITY) }
    }
}

/// Changes of velocity and displacement.
#[derive(Debug, Clone, Copy)]
pub struct Change<S: Scalar> {
    /// Where anything happened, or the part was stuck.
    pub settled: S::Mask,
    /// New velocity.
    pub velocity: S,
    /// To be added to the displacement.
    pub displacement: S,
}

impl<S: Scalar> DryFriction<S> {
    /// From forces: `kinetic` while moving, `breakaway` (at least that) at rest, over the inertia that they slow down.
    #[inline(always)]
    pub fn new(kinetic: S, breakaway: S, per_force: S) -> Self {
        let asymmetry = kinetic.zero();
        Self { kinetic: kinetic * per_force, breakaway: breakaway.max(kinetic) * per_force, asymmetry }
    }

    /// The friction of a motion along `way`.
    #[inline(always)]
    fn along(&self, way: S) -> Self {
        let factor = way.constant(1.0) + self.asymmetry.times_sign(way);
        Self { kinetic: self.kinetic * factor, breakaway: self.breakaway * factor, ..*self }
    }

    /// Friction on its way to `next`.
    #[inline(always)]
    pub fn towards(&self, next: &Self, share: f64) -> Self {
        let between = |a: S, b: S| a + (b - a).times(share);
        Self {
            kinetic: between(self.kinetic, next.kinetic),
            breakaway: between(self.breakaway, next.breakaway),
            asymmetry: between(self.asymmetry, next.asymmetry),
        }
    }

    /// The friction of a step that begins with velocity `v` and friction-free acceleration `a`, which is asked for only of what rests.
    #[inline(always)]
    pub fn grip(&self, v: S, a: S) -> StickState<S> {
        let rests = at_rest(v);
        let way = S::select(rests, a, v);
        let Self { kinetic, breakaway, .. } = self.along(way);
        let stuck = rests & (a.zero().less(breakaway) & !breakaway.less(a.abs()));
        let drag = -kinetic.times_sign(way);
        StickState { stuck, drag, velocity: v, pull: a }
    }

    /// Acceleration of what rests, under the friction-free acceleration `a`.
    #[inline(always)]
    pub fn from_rest(&self, a: S) -> S {
        let Self { kinetic, breakaway, .. } = self.along(a);
        S::select(!breakaway.less(a.abs()), a.zero(), a - kinetic.times_sign(a))
    }

    /// What happened inside a step that began under `grip` and would end with velocity `v`: past zero the part sticks or turns
    /// back, and what stuck may have broken away. `a` is the friction-free acceleration at the end, `per_h` is `1 / h`.
    #[inline(always)]
    pub fn settled(&self, grip: &StickState<S>, v: S, a: S, (h, per_h): (S, S)) -> Change<S> {
        let v_0 = grip.velocity;
        // The drag points against the motion, so a velocity along it has turned round.
        let turned = v.zero().less(v * grip.drag) & !grip.stuck;
        if !S::any(turned | grip.stuck) {
            return Change { settled: turned, velocity: v, displacement: v.zero() };
        }
        let Self { kinetic, breakaway, .. } = self.along(a);
        let (was, is) = (grip.pull.abs(), a.abs());
        let held = !self.along(grip.pull).breakaway.less(was);
        let breaks = grip.stuck & breakaway.less(is) & held;
        // What held the other way may hold more.
        let was = S::select(held, was.min(breakaway), was);
        // Share of the step until the velocity is zero; or share that was left when |a| passed f_s, were it to grow evenly.
        let over = S::select(turned, v_0, is - breakaway);
        let share = over / S::select(turned, v_0 - v, is - was);
        let part = share * h;

        let left = h - part;
        let pull = (v - v_0) * per_h - grip.drag; // mean acceleration without friction
        let onward = self.from_rest(pull) * left;
        // Areas under the two straight pieces of the velocity, less the area under the one that was taken.
        let moved = v_0 * part + onward * left - (v_0 + v) * h;

        let freed = (((breakaway + is).times(0.5) - kinetic) * part).times_sign(a);
        let pick = |turned_value: S, freed_value: S, otherwise: S| {
            S::select(turned, turned_value, S::select(breaks, freed_value, otherwise))
        };
        Change {
            settled: turned | grip.stuck,
            velocity: pick(onward, freed, v),
            displacement: pick(moved, freed * part, v.zero()).times(0.5),
        }
    }
}

/// Whether a velocity is none.
#[inline(always)]
pub fn at_rest<S: Scalar>(v: S) -> S::Mask {
    !v.zero().less(v.abs())
}
