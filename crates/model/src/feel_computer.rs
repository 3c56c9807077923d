//! The feel computer: the programmed feel in time, under a torque that stays through a period.
//!
//! `delta` programmed displacement · `T` torque that the computer sees · `h` period
//!
//! A digital controller runs it from sample to sample under the load cell's torque. Under the pilot's own, `T = R_p F_p`, it is
//! the programmed feel alone, which a loader is held against.

use crate::Scalar;
use crate::bisect::bisect;
use crate::contact::Push;
use crate::curve::Curve;
use crate::dry_friction::{DryFriction, StickState, at_rest};
use crate::effects::Effects;
use crate::feel::{FeelConditions, FeelLaw};
use crate::run::SEARCH_RAD;

/// A feel, or two while the one is changed into the other.
#[derive(Debug, Clone, Copy)]
pub struct FeelComputer<'a, S> {
    /// The feel.
    pub feel: &'a FeelLaw<S>,
    /// The one that it is changed into.
    pub next: &'a FeelLaw<S>,
    /// How far it is, 0 to 1.
    pub fade: f64,
    /// Effects in play.
    pub effects: &'a Effects,
    /// Force over angle in place of the straight spring.
    pub curve: Option<&'a Curve>,
}

/// What moves in it.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "S: serde::Serialize, S::Mask: serde::Serialize",
        deserialize = "S: serde::Deserialize<'de>, S::Mask: serde::Deserialize<'de>"
    ))
)]
pub struct FeelMotion<S: Scalar> {
    /// `delta` and its rate.
    pub at: [S; 2],
    /// What its dry friction does.
    pub grip: StickState<S>,
    /// Where the slider of the hysteresis was last left.
    pub slider: S,
}

impl<S: Scalar> FeelMotion<S> {
    /// At rest at `delta`, the hysteresis without a force.
    pub fn resting(feel: &FeelLaw<S>, delta: S) -> Self {
        Self { at: [delta, delta.zero()], grip: StickState::resting(&feel.friction), slider: delta }
    }
}

impl<S: Scalar> FeelComputer<'_, S> {
    /// Where the feel rests under a torque: `S(delta) = T`, neutral where that does.
    #[inline(always)]
    pub fn equilibrium(&self, torque: S, neutral: S, stiffness_factor: S) -> S {
        let left = |delta: S| {
            let conditions = FeelConditions::at_rest(neutral, stiffness_factor, delta);
            let spring = self.feel.spring(self.effects, self.curve, delta, &conditions);
            spring - self.feel.pushed(self.effects, delta, (delta, delta.zero())) - torque
        };
        let zero = torque.zero();
        let reach = self.feel.per_angle.times(SEARCH_RAD);
        let settled = bisect((neutral - reach, neutral + reach), zero, |delta| (left(delta), delta));
        // A spring that takes no force around neutral is at rest all over that.
        S::select(zero.less(left(neutral).abs()), settled, neutral)
    }

    /// Acceleration of `delta`, dry friction left out.
    #[inline(always)]
    pub fn acceleration(&self, at: (S, S), torque: S, conditions: &FeelConditions<S>) -> S {
        let given = [at.0, at.1];
        let [delta, rate] = S::part_begins(given);
        S::section("feel");
        let of = |feel: &FeelLaw<S>| feel.acceleration(self.effects, self.curve, (delta, rate), torque, conditions);
        let mut settled = of(self.feel);
        if self.fade != 0.0 {
            settled = settled + (of(self.next) - settled).times(self.fade);
        }
        S::part_ends(given, [settled])[0]
    }

    /// Dry friction.
    #[inline(always)]
    pub fn friction(&self) -> DryFriction<S> {
        if self.fade == 0.0 { self.feel.friction } else { self.feel.friction.towards(&self.next.friction, self.fade) }
    }

    /// What the soft stops did inside a step.
    #[inline(always)]
    pub fn soft_stop_push(&self, way: (S, S), rate: S, h: S) -> Push<S> {
        let push = Self::push_of(self.feel, way, rate, h);
        if self.fade == 0.0 {
            return push;
        }
        let next = Self::push_of(self.next, way, rate, h);
        let between = |a: S, b: S| a + (b - a).times(self.fade);
        Push {
            velocity: between(push.velocity, next.velocity),
            displacement: between(push.displacement, next.displacement),
        }
    }

    #[inline(always)]
    fn push_of(feel: &FeelLaw<S>, way: (S, S), rate: S, h: S) -> Push<S> {
        let given = [way.0, way.1, rate];
        let [before, after, rate] = S::part_begins(given);
        S::section("feel_stops");
        let push = feel.soft_stops.push((before, after), rate, h, feel.per_torque);
        let [velocity, displacement] = S::part_ends(given, [push.velocity, push.displacement]);
        Push { velocity, displacement }
    }

    /// A period under a torque that stays: a Runge-Kutta step of its own. Its four stages are a loop round one piece of code, which is
    /// so small enough to go whole into every vector's loop: a function of its own would be called there, number by number.
    #[inline(always)]
    pub fn run(&self, motion: &mut FeelMotion<S>, torque: S, conditions: &FeelConditions<S>, h: S) {
        S::section("feel");
        let effects = self.effects;
        let mut conditions = *conditions;
        // Acceleration without dry friction at the start of the step, where it is known before the stages ask for it.
        let mut known = None;
        if effects.feel_friction {
            S::section("feel_friction");
            // The torque jumped to its value at the sample: what broke away, did so now.
            let before = motion.grip.pull;
            let per_h = h.constant(1.0) / h;
            let friction = self.friction();
            let settled = friction.settled(&motion.grip, motion.at[1], before, (h, per_h));
            motion.at = [motion.at[0] + settled.displacement, settled.velocity];
            conditions.start = motion.at[0];
            // What moves, slides on; what rests may be held.
            let rests = at_rest(settled.velocity);
            let free = if S::any(rests) {
                let free = self.acceleration((motion.at[0], motion.at[1]), torque, &conditions);
                S::select(rests, free, free.zero())
            } else {
                torque.zero()
            };
            S::section("feel_friction");
            motion.grip = friction.grip(settled.velocity, free);
            S::section("feel");
            known = Some((rests, free));
        }
        let start = (motion.at[0], motion.at[1]);
        let half = h.times(0.5);
        let moved = |[rate, acceleration]: [S; 2], by: S| (start.0 + by * rate, start.1 + by * acceleration);
        let sum = |a: [S; 2], b: [S; 2]| [a[0] + b[0], a[1] + b[1]];
        let parts = effects.feel_friction | effects.feel_spring | effects.feel_damping_and_stops;
        let (outer, inner) = if !S::COMPILED_ONCE && !parts && self.curve.is_none() && self.fade == 0.0 {
            // Of a feel of inertia, damping and stiffness alone the stages are so small that they need no loop.
            let effects = &Effects { feel_spring: false, feel_damping_and_stops: false, ..*effects };
            let plain = FeelComputer { feel: self.feel, next: self.next, fade: 0.0, effects, curve: None };
            let slope = |at: (S, S)| [at.1, plain.acceleration(at, torque, &conditions)];
            let k_1 = slope(start);
            let k_2 = slope(moved(k_1, half));
            let k_3 = slope(moved(k_2, half));
            (sum(k_1, slope(moved(k_3, h))), sum(k_2, k_3))
        } else {
            // From one stage to the next in registers: an array of slopes would go through memory.
            let (mut at, mut outer, mut inner) = (start, [h.zero(); 2], [h.zero(); 2]);
            for stage in 0..4 {
                let mut acceleration = self.acceleration(at, torque, &conditions);
                if stage == 0
                    && let Some((rests, free)) = known
                {
                    acceleration = S::select(rests, free, acceleration);
                }
                if effects.feel_friction {
                    acceleration = acceleration + motion.grip.drag;
                }
                let slope = [at.1, acceleration];
                if stage == 0 || stage == 3 {
                    outer = sum(outer, slope);
                } else {
                    inner = sum(inner, slope);
                }
                at = moved(slope, if stage == 2 { h } else { half });
            }
            (outer, inner)
        };
        let sixth = h.times(1.0 / 6.0);
        let mut end = [start.0, start.1];
        for k in 0..2 {
            end[k] = end[k] + sixth * (outer[k] + inner[k].times(2.0));
        }
        if effects.feel_friction {
            // What sticks has no velocity.
            end = [S::select(motion.grip.stuck, start.0, end[0]), S::select(motion.grip.stuck, start.1, end[1])];
        }
        S::section("feel_stops");
        if effects.feel_limits {
            // A limit that is met takes hold at the end: nothing follows the feel within the step. What was too fast went too far.
            let rate = self.feel.slowed(start.1, end[1], h);
            let (delta, rate) = self.feel.stopped(start, (end[0] - (end[1] - rate) * half, rate), h);
            end = [delta, rate];
        }
        if effects.feel_damping_and_stops {
            let push = self.soft_stop_push((start.0, end[0]), end[1], h);
            end = [end[0] + push.displacement, end[1] + push.velocity];
        }
        motion.at = end;
        if effects.feel_spring {
            motion.slider = self.feel.dragged(motion.slider, end[0]);
        }
    }
}
