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
use crate::dry_friction::{DryFriction, Grip};
use crate::effects::Effects;
use crate::feel::{FeelLaw, Surroundings};
use crate::machine::SEARCH_RAD;

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
    pub grip: Grip<S>,
    /// Where the slider of the hysteresis was last left.
    pub slider: S,
}

impl<S: Scalar> FeelMotion<S> {
    /// At rest at `delta`, the hysteresis without a force.
    pub fn resting(feel: &FeelLaw<S>, delta: S) -> Self {
        Self { at: [delta, delta.zero()], grip: Grip::resting(&feel.friction), slider: delta }
    }
}

impl<S: Scalar> FeelComputer<'_, S> {
    /// Where the feel rests under a torque: `S(delta) = T`, neutral where that does.
    #[inline(always)]
    pub fn equilibrium(&self, torque: S, neutral: S, stiffness_factor: S) -> S {
        let left = |delta: S| {
            let around = Surroundings::at_rest(neutral, stiffness_factor, delta);
            let spring = self.feel.spring(self.effects, self.curve, delta, &around);
            spring + self.feel.resistance(self.effects, delta, delta, delta.zero()) - torque
        };
        let zero = torque.zero();
        let reach = self.feel.per_angle.times(SEARCH_RAD);
        let found = bisect((neutral - reach, neutral + reach), zero, |delta| (left(delta), delta));
        // A spring that takes no force around neutral is at rest all over that.
        S::select(zero.less(left(neutral).abs()), found, neutral)
    }

    /// Acceleration of `delta`, dry friction left out.
    #[inline(always)]
    pub fn acceleration(&self, at: (S, S), torque: S, around: &Surroundings<S>) -> S {
        let acceleration = self.feel.acceleration(self.effects, self.curve, at, torque, around);
        if self.fade == 0.0 {
            return acceleration;
        }
        let next = self.next.acceleration(self.effects, self.curve, at, torque, around);
        acceleration + (next - acceleration).times(self.fade)
    }

    /// Dry friction.
    #[inline(always)]
    pub fn friction(&self) -> DryFriction<S> {
        if self.fade == 0.0 { self.feel.friction } else { self.feel.friction.towards(&self.next.friction, self.fade) }
    }

    /// What the soft stops did inside a step.
    #[inline(always)]
    pub fn soft_stop_push(&self, way: (S, S), rate: S, h: S) -> Push<S> {
        let push = self.feel.soft_stops.push(way, rate, h, self.feel.per_torque);
        if self.fade == 0.0 {
            return push;
        }
        let next = self.next.soft_stops.push(way, rate, h, self.next.per_torque);
        let between = |a: S, b: S| a + (b - a).times(self.fade);
        Push {
            velocity: between(push.velocity, next.velocity),
            displacement: between(push.displacement, next.displacement),
        }
    }

    /// A period under a torque that stays: a Runge-Kutta step of its own.
    #[inline(always)]
    pub fn run(&self, motion: &mut FeelMotion<S>, torque: S, around: &Surroundings<S>, h: S) {
        let effects = self.effects;
        let friction = effects.feel_friction;
        let pull = |grip: &Grip<S>, [delta, rate]: [S; 2]| {
            let free = self.acceleration((delta, rate), torque, around);
            let held = S::select(grip.stuck, free.zero(), free + grip.drag);
            (free, if friction { held } else { free })
        };
        if friction {
            let (free, _) = pull(&motion.grip, motion.at);
            // The torque jumped to its value at the sample: what broke away, did so now.
            let before = motion.grip.pull;
            let per_h = h.constant(1.0) / h;
            let friction = self.friction();
            let found = friction.settled(&motion.grip, motion.at[1], before, (h, per_h));
            motion.grip = friction.grip(found.velocity, free);
            motion.at = [motion.at[0] + found.displacement, found.velocity];
        }
        let (start, grip) = (motion.at, motion.grip);
        let moved = |[delta, rate]: [S; 2], by: S| [start[0] + by * delta, start[1] + by * rate];
        let limits = (start[0], start[1]);
        let slope = |x: [S; 2]| {
            let (delta, rate) =
                if effects.feel_limits { self.feel.held_within(limits, (x[0], x[1])) } else { (x[0], x[1]) };
            [rate, pull(&grip, [delta, rate]).1]
        };
        let k_1 = slope(start);
        let k_2 = slope(moved(k_1, h.times(0.5)));
        let k_3 = slope(moved(k_2, h.times(0.5)));
        let k_4 = slope(moved(k_3, h));
        let sum = |k: usize| (k_1[k] + k_4[k]) + (k_2[k] + k_3[k]).times(2.0);
        let mut end = moved([sum(0), sum(1)], h.times(1.0 / 6.0));
        if effects.feel_limits {
            let (delta, rate) = self.feel.limited((start[0], start[1]), (end[0], end[1]), h);
            end = [delta, rate];
        }
        if effects.feel_damping_and_stops {
            let push = self.soft_stop_push((start[0], end[0]), end[1], h);
            end = [end[0] + push.displacement, end[1] + push.velocity];
        }
        motion.at = end;
        if effects.feel_spring {
            motion.slider = self.feel.dragged(motion.slider, end[0]);
        }
    }
}
