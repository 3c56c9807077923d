//! The programmed feel: eqs. (11)-(12); in a run with everything that makes it more than these, as the feel computer runs it.
//!
//! `I`, `B`, `G` programmed inertia, damping, stiffness · `G_max` scale · `delta` programmed displacement · `T` torque that the
//! computer sees · `phi = delta / lambda` the column angle that `delta` stands for · `n` trimmed neutral · `mu` what the computer sees
//! per torque of the column · `R_p` lever arm of the grip
//!
//! States: `delta` and its rate. The unit of `delta` follows from the torque that drives it: N m gives rad, and N m V/rad,
//! the scaled torque of the analog computer, gives V.
//!
//! `I delta'' + B delta' + mu b_2 phi' |phi'| + S + mu R_p (F_preload + parts) + stops + friction = T + mu T_s`
//!
//! The spring `S` is `G (delta - lambda n)`, or `mu R_p` times a curve of force over angle, after the deadband and times the factor that
//! the dynamic pressure asks for. The parts are those of `feel_parts.rs`; each is a force of its own at the grip, so parts add up and
//! none changes another. `T_s` comes from outside: `R_p F - G_s phi - B_s phi'`, of which `G_s` and `B_s` are zero but for a
//! hinge moment. Where `delta` is an angle, `lambda` and `mu` are one; in the original system `delta` is a voltage.
//!
//! The linear models divide eq. (11) by the inertia as it is written. A run sums the resistance first and multiplies by `1 / I`, which it
//! takes from that same equation: a division less at every stage, and rounded elsewhere, so both forms stay.

use crate::Scalar;
use crate::compensator::{Compensator, Displacement};
use crate::contact::Stops;
use crate::curve::Curve;
use crate::dry_friction::DryFriction;
use crate::effects::Effects;
use crate::feel_parts::{FeelParts, FeelPlace, FeelUnits};
use crate::parameters::{Feel, Parameters};

impl<S: Scalar> Feel<S> {
    /// Acceleration of the programmed displacement under the torque `torque`.
    #[inline(always)]
    pub fn acceleration(&self, delta: S, delta_rate: S, torque: S) -> S {
        // I delta'' + B delta' + G delta = T                                                          eq. (11)
        (torque - self.damping * delta_rate - self.stiffness * delta) / self.inertia
    }

    /// Scaled torque of the analog computer from the load cell's signal `e_f` in V.
    #[inline(always)]
    pub fn analog_torque(&self, e_f: S) -> S {
        // T = G_max e_F                                                                               eq. (12)
        self.maximum_stiffness * e_f
    }

    /// Inertia and damping `(I, B)` of a control of natural frequency `w` in rad/s, damping ratio `zeta` and stiffness `g`.
    #[inline(always)]
    pub fn from_frequency(w: S, zeta: S, g: S) -> (S, S) {
        // w^2 = G / I, 2 zeta w = B / I                                                               eq. (11)
        let inertia = g / (w * w);
        (inertia, zeta.times(2.0) * w * inertia)
    }

    /// Natural frequency in rad/s and damping ratio of the programmed control.
    #[inline(always)]
    pub fn frequency(&self) -> (S, S) {
        // w = sqrt(G / I), zeta = B / (2 I w)                                                         eq. (11)
        let w = (self.stiffness / self.inertia).sqrt();
        (w, self.damping / (self.inertia.times(2.0) * w))
    }
}

/// The feel in a run: its coefficients in the unit of `delta`.
#[derive(Debug, Clone, Copy)]
pub struct FeelLaw<S> {
    /// `1 / I`.
    pub per_torque: S,
    /// `lambda`: unit of `delta` per radian.
    pub per_angle: S,
    damping: S,
    stiffness: S,
    quadratic_damping: S,
    grip_force: S,
    /// `mu / lambda`: torque per torque per radian of the column and unit of `delta`.
    added: S,
    deadband: S,
    preload: S,
    parts: FeelParts<S>,
    /// Soft stops.
    pub soft_stops: Stops<S>,
    shaker: S,
    /// Dry friction.
    pub friction: DryFriction<S>,
    low: S,
    high: S,
    velocity_limit: S,
    trim_rate: S,
}

/// What the feel is told from outside.
#[derive(Debug, Clone, Copy)]
pub struct FeelConditions<S> {
    /// Trimmed neutral in the unit of `delta`.
    pub neutral: S,
    /// Factor on the spring.
    pub stiffness_factor: S,
    /// The stick shaker's swing, -1 to 1.
    pub shaker: S,
    /// Force at the grip in N that comes beside the hand's.
    pub added_force: S,
    /// Spring rate in N m/rad and damping in N m s/rad about an angle of zero, beside the feel's own.
    pub added: [S; 2],
    /// Where the slider of the hysteresis was last left, in the unit of `delta`.
    pub slider: S,
    /// Displacement at the start of the step: what a soft stop does, it does from there on.
    pub start: S,
}

impl<S: Scalar> FeelConditions<S> {
    /// Nothing stirs: shaker off, the slider of the hysteresis where `delta` is.
    #[inline(always)]
    pub fn at_rest(neutral: S, stiffness_factor: S, delta: S) -> Self {
        let zero = delta.zero();
        Self {
            neutral,
            stiffness_factor,
            shaker: zero,
            added_force: zero,
            added: [zero; 2],
            slider: delta,
            start: delta,
        }
    }
}

impl<S: Scalar> FeelLaw<S> {
    /// The feel of a loader under a law.
    #[inline(always)]
    pub fn new(parameters: &Parameters<S>, law: &Compensator<S>) -> Self {
        let Parameters { feel, linkage, column, potentiometer, .. } = parameters;
        let one = feel.inertia.constant(1.0);
        let lambda = match law.displacement {
            // The servo at rest: delta = K_3 x_p, x_p = alpha R_b theta                               eq. (13)
            Displacement::Volts => potentiometer.signal(linkage.rigid_piston(column.base_arm)),
            Displacement::Radians => one,
        };
        let mu = law.load_cell_arm / linkage.base_force(column.base_arm);
        let grip_force = mu * column.grip_arm;
        let per_torque = feel.acceleration(one.zero(), one.zero(), one);
        Self {
            per_torque,
            per_angle: lambda,
            damping: feel.damping,
            stiffness: feel.stiffness,
            quadratic_damping: feel.quadratic_damping * mu / (lambda * lambda),
            grip_force,
            added: mu / lambda,
            deadband: feel.deadband * lambda,
            preload: feel.preload * grip_force,
            parts: FeelParts::new(feel, FeelUnits { grip_force, per_angle: lambda }),
            soft_stops: soft_stops(feel, lambda, mu),
            shaker: feel.shaker_force * grip_force,
            friction: DryFriction::new(feel.coulomb_friction, feel.static_friction, grip_force * per_torque),
            low: feel.hard_stop_low * lambda,
            high: feel.hard_stop_high * lambda,
            velocity_limit: feel.velocity_limit * lambda,
            trim_rate: feel.trim_rate * lambda,
        }
    }

    /// Acceleration of `delta` by all but dry friction, under the torque `torque`.
    #[inline(always)]
    pub fn acceleration(
        &self,
        effects: &Effects,
        curve: Option<&Curve>,
        (delta, delta_rate): (S, S),
        torque: S,
        conditions: &FeelConditions<S>,
    ) -> S {
        // First what does not depend on I, B and G: of two feels, one changed into the other, it is the same.
        let torque = if effects.surroundings {
            let [stiffness, damping] = conditions.added;
            torque + self.shaker * conditions.shaker + self.grip_force * conditions.added_force
                - self.added * (stiffness * delta + damping * delta_rate)
        } else {
            torque
        };
        let torque = if effects.feel_spring { torque - self.preload } else { torque };
        let others =
            self.built_up(effects, delta, conditions) - self.pushed(effects, conditions.start, (delta, delta_rate));
        let damping = if effects.feel_damping_and_stops {
            self.damping + self.quadratic_damping * delta_rate.abs()
        } else {
            self.damping
        };
        let linear = damping * delta_rate + self.gradient(effects, curve, delta, conditions);
        ((torque - others - linear) * self.per_torque).named("acceleration")
    }

    /// Torque of everything that depends on the displacement alone.
    #[inline(always)]
    pub fn spring(&self, effects: &Effects, curve: Option<&Curve>, delta: S, conditions: &FeelConditions<S>) -> S {
        let spring = self.gradient(effects, curve, delta, conditions) + self.built_up(effects, delta, conditions);
        if effects.feel_spring { spring + self.preload } else { spring }
    }

    /// Lowest and highest force at the grip that hold it still at `delta`: whichever way the hysteresis was left and the shaker swings,
    /// up to where dry friction breaks away; around a neutral, with a factor on its spring.
    ///
    /// What holds is minus what accelerates, so that a part which joins the equation is held too.
    #[inline(always)]
    pub fn held_between(
        &self,
        effects: &Effects,
        curve: Option<&Curve>,
        delta: S,
        (neutral, stiffness_factor): (S, S),
    ) -> [S; 2] {
        [-1.0, 1.0].map(|side| {
            let conditions = FeelConditions {
                shaker: delta.constant(-side),
                slider: delta - self.parts.hysteresis.travel.times(side),
                ..FeelConditions::at_rest(neutral, stiffness_factor, delta)
            };
            self.held(effects, curve, delta, side, &conditions)
        })
    }

    /// Force at the grip that holds it still at `delta`; dry friction is about to break away towards `side`, 0 for no friction.
    #[inline(always)]
    pub fn held(
        &self,
        effects: &Effects,
        curve: Option<&Curve>,
        delta: S,
        side: f64,
        conditions: &FeelConditions<S>,
    ) -> S {
        // T = mu R_p F = S + ... + friction                                                           eq. (11) at rest
        let free = self.acceleration(effects, curve, (delta, delta.zero()), delta.zero(), conditions);
        (self.friction.breakaway.times(side) - free) / (self.per_torque * self.grip_force)
    }

    /// Torque of the spring: straight, or a curve, beyond the deadband.
    #[inline(always)]
    fn gradient(&self, effects: &Effects, curve: Option<&Curve>, delta: S, conditions: &FeelConditions<S>) -> S {
        let x = Self::from_neutral(effects, delta, conditions);
        let beyond = if effects.feel_spring { x - x.within(self.deadband) } else { x };
        let factor = |of: S| if effects.surroundings { conditions.stiffness_factor * of } else { of };
        match curve {
            None => factor(self.stiffness) * beyond,
            Some(curve) => factor(self.grip_force) * curve.at(beyond / self.per_angle),
        }
    }

    /// Torque of the parts that depend on the displacement.
    #[inline(always)]
    fn built_up(&self, effects: &Effects, delta: S, conditions: &FeelConditions<S>) -> S {
        if !effects.feel_spring {
            return delta.zero();
        }
        let from_neutral = Self::from_neutral(effects, delta, conditions);
        self.parts.torque(&FeelPlace { from_neutral, delta, slider: conditions.slider })
    }

    #[inline(always)]
    fn from_neutral(effects: &Effects, delta: S, conditions: &FeelConditions<S>) -> S {
        if effects.surroundings { delta - conditions.neutral } else { delta }
    }

    /// Torque of the soft stops on what is at `(delta, delta')` within a step that began at `start`.
    #[inline(always)]
    pub fn pushed(&self, effects: &Effects, start: S, at: (S, S)) -> S {
        if effects.feel_damping_and_stops { self.soft_stops.force(start, at) } else { start.zero() }
    }

    /// The neutral of a straight spring without a factor that would push the control, where it is and as fast as it goes, as the feel does
    /// under what comes beside it: a law for that feel then follows this one.
    #[inline(always)]
    pub fn pushed_to(&self, neutral: S, [delta, delta_rate]: [S; 2], beside: [f64; 3]) -> S {
        if beside.iter().all(|&of| of == 0.0) {
            return neutral;
        }
        let [force, stiffness, damping] = beside.map(|of| neutral.constant(of));
        // G (delta - n_e) = G (delta - n) + mu (G_s phi + B_s phi' - R_p F)
        let added = self.added * (stiffness * delta + damping * delta_rate);
        neutral + (self.grip_force * force - added) / self.stiffness
    }

    /// Torque of a straight spring at `delta`.
    #[inline(always)]
    pub fn spring_torque(&self, neutral: S, delta: S) -> S {
        self.stiffness * (delta - neutral)
    }

    /// Where the hysteresis leaves its slider once `delta` has been reached.
    #[inline(always)]
    pub fn dragged(&self, slider: S, delta: S) -> S {
        slider.clamp(delta - self.parts.hysteresis.travel, delta + self.parts.hysteresis.travel)
    }

    /// `(delta, delta')` inside a step from `before`, held within hard stops and velocity limit. A stop that is met inside the
    /// step takes the velocity at its end.
    #[inline(always)]
    pub fn held_within(&self, before: (S, S), (delta, delta_rate): (S, S)) -> (S, S) {
        let rate = delta_rate.within(self.velocity_limit.max(before.1.abs()));
        let at_high = !before.0.less(self.high) & !self.high.less(before.0);
        let at_low = !before.0.less(self.low) & !self.low.less(before.0);
        let rate = S::select(at_high, rate.min(rate.zero()), S::select(at_low, rate.max(rate.zero()), rate));
        // Anywhere on the side of a stop that it began beyond.
        let low = S::select(before.0.less(self.low), delta, self.low);
        let high = S::select(self.high.less(before.0), delta, self.high);
        (delta.clamp(low, high), rate)
    }

    /// The displacement between the hard stops that is nearest to this one.
    #[inline(always)]
    pub fn between_stops(&self, delta: S) -> S {
        delta.clamp(self.low, self.high)
    }

    /// The trimmed neutral after `h` seconds of following the command, an angle.
    #[inline(always)]
    pub fn trimmed(&self, neutral: S, command: S, h: S) -> S {
        let unlimited = !self.trim_rate.less(h.constant(f64::INFINITY));
        let most = S::select(unlimited, self.trim_rate, self.trim_rate * h);
        neutral + (command * self.per_angle - neutral).within(most)
    }

    /// `(delta, delta')` after a step from `before`, held within hard stops and velocity limit.
    #[inline(always)]
    pub fn limited(&self, before: (S, S), (delta, delta_rate): (S, S), h: S) -> (S, S) {
        self.stopped(before, (delta, self.slowed(before.1, delta_rate, h)), h)
    }

    /// `delta'` after a step that began with `before`, held within the velocity limit.
    ///
    /// One that has just been programmed takes hold over some hundredths of a second.
    #[inline(always)]
    pub fn slowed(&self, before: S, delta_rate: S, h: S) -> S {
        delta_rate.within(self.velocity_limit.max(before.abs() * taken_hold(h)))
    }

    /// `(delta, delta')` after a step from `before`, held within the hard stops.
    ///
    /// A stop behind a control that moves on outwards takes hold over some hundredths of a second; it lets the control come back and
    /// does not throw it.
    #[inline(always)]
    pub fn stopped(&self, before: (S, S), (delta, rate): (S, S), h: S) -> (S, S) {
        let (outwards, zero) = (before.1.abs() * taken_hold(h), rate.zero());
        // Each stop for itself, so that what meets none asks no more.
        let stop = |beyond: S::Mask, place: S| (S::select(beyond, delta, place), S::select(beyond, outwards, zero));
        let (high, upwards) = stop(self.high.less(before.0), self.high);
        let (low, downwards) = stop(before.0.less(self.low), self.low);
        let between = |of_low: S, free: S, of_high: S| {
            S::select(delta.less(self.high), S::select(self.low.less(delta), free, of_low), of_high)
        };
        (between(low, delta, high), between(rate.max(-downwards), rate, rate.min(upwards)))
    }
}

/// What a limit that takes hold leaves of a speed beyond it in a step.
#[inline(always)]
fn taken_hold<S: Scalar>(h: S) -> S {
    (h.constant(1.0) - h.times(1.0 / LIMIT_TAKES_HOLD_S)).max(h.zero())
}

/// Time in which a newly programmed limit takes hold.
const LIMIT_TAKES_HOLD_S: f64 = 0.02;

#[inline(always)]
fn soft_stops<S: Scalar>(feel: &Feel<S>, lambda: S, mu: S) -> Stops<S> {
    Stops {
        low: feel.soft_stop_low * lambda,
        high: feel.soft_stop_high * lambda,
        stiffness: feel.soft_stop_stiffness * mu / lambda,
        damping: feel.soft_stop_damping * mu / lambda,
    }
}
