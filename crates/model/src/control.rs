//! What a digital controller works out in a period: from what is sampled to the command, law and feel computer together.
//!
//! `T` period · `y = [F_c, x_p, theta, F_g]` what is sampled · `delta`, `delta'` the feel computer's displacement and rate · `e` command ·
//! `a` what is added against a known disturbance · `a_w` anti-windup · `c_3` command per `delta`
//!
//! A machine in a run, the real-time loop and a target board call this one function. It knows nothing of the plant but the numbers of its
//! law: what it is given are sensors' values, what it gives is a number for the converter. See `controller.rs` for when it does.

use crate::Scalar;
use crate::compensator::Compensator;
use crate::contact_law::{ContactInputs, ContactState};
use crate::controller::Converters;
use crate::effects::Effects;
use crate::feel::{FeelConditions, FeelLaw};
use crate::feel_computer::{FeelComputer, FeelMotion};
use crate::known_friction::FrictionState;
use crate::law_vector::{Estimate, MOST_STATES, SAMPLED, STATE_NAMES, quotient};
use crate::memory::MemoryVisitor;
use crate::observer::{LawOutput, Observer};
use crate::parameters::Parameters;
use crate::run::{Inputs, Shared, StepFraction};
use crate::transducers::SENSORS;

/// Law, feel and converters of one loader.
#[derive(Debug, Clone, Copy)]
pub struct Control<S> {
    pub(crate) law: Compensator<S>,
    pub(crate) observer: Observer<S>,
    pub(crate) next_observer: Observer<S>,
    pub(crate) feel: FeelLaw<S>,
    pub(crate) next_feel: FeelLaw<S>,
    pub(crate) converters: Converters<S>,
    /// Column angle in rad per displacement of the base in m.
    pub(crate) per_base: S,
    /// End stops of the column in rad.
    pub(crate) ends: [S; 2],
    pub(crate) force_per_effort: S,
}

/// What the law remembers from sample to sample.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LawState<S> {
    /// Displacement of the base as sampled last.
    pub base: S,
    /// Position of the drive's end as sampled last.
    pub position: S,
    /// State of the observer.
    pub estimate: Estimate<S>,
    /// What the law recalls of the dry friction that it knows.
    pub friction_state: FrictionState<S>,
    /// What the law recalls of contact.
    pub contact_state: ContactState<S>,
}

/// The programmed feel at a sample.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "S: serde::Serialize, S::Mask: serde::Serialize",
        deserialize = "S: serde::Deserialize<'de>, S::Mask: serde::Deserialize<'de>"
    ))
)]
pub struct FeelState<S: Scalar> {
    /// What moves.
    pub motion: FeelMotion<S>,
    /// Trimmed neutral in the unit of `delta`.
    pub neutral: S,
}

impl<S: Scalar> LawState<S> {
    /// Visits each number but those of the estimate.
    #[inline(always)]
    pub fn visit_samples(&mut self, visitor: &mut impl MemoryVisitor<S>) {
        visitor.number("base", &mut self.base);
        // Only what is added against a known disturbance depends on it.
        visitor.nonlinear("position", &mut self.position);
        self.friction_state.visit(visitor);
        self.contact_state.visit(visitor);
    }

    /// Visits each number of the estimate.
    #[inline(always)]
    pub fn visit_estimate(&mut self, visitor: &mut impl MemoryVisitor<S>) {
        for (name, state) in STATE_NAMES.into_iter().zip(&mut self.estimate) {
            visitor.number(name, state);
        }
    }
}

impl<S: Scalar> FeelState<S> {
    /// Visits each number.
    #[inline(always)]
    pub fn visit(&mut self, visitor: &mut impl MemoryVisitor<S>) {
        let Self { motion: FeelMotion { at: [delta, delta_rate], grip, slider }, neutral } = self;
        visitor.number("delta", delta);
        visitor.number("delta_rate", delta_rate);
        visitor.nonlinear("neutral", neutral);
        visitor.nonlinear("slider", slider);
        visitor.nonlinear("grip_drag", &mut grip.drag);
        visitor.nonlinear("grip_velocity", &mut grip.velocity);
        visitor.nonlinear("grip_pull", &mut grip.pull);
        visitor.flag("grip_stuck", &mut grip.stuck);
    }
}

/// What is sampled.
#[derive(Debug, Clone, Copy)]
pub struct Sample<S> {
    /// Load cell (N), position of the drive's end (m), displacement of the column's base (m), force at the grip (N).
    pub sensors: [S; SENSORS],
    /// Pilot's force in N, for a law that feeds it back.
    pub pilot_force: S,
}

/// What follows from a sample.
#[derive(Debug, Clone, Copy)]
pub struct ControlOutput<S> {
    /// Command, before anything limits it.
    pub command: S,
    /// Torque that the feel computer receives: of a law with an observer, its estimate of the pilot's.
    pub torque: S,
    /// Rate of the column's base over the last period in m/s.
    pub base_rate: S,
}

impl<S: Scalar> Control<S> {
    /// The command of a sample, as the converter gives it; moves the feel computer on by a period.
    ///
    /// `allow` may put another command in place of the law's: the observer is then told that one, and the feel gives way to what it
    /// falls short by.
    #[inline(always)]
    pub fn command(
        &self,
        shared: &Shared,
        (feeling, remembered): (&mut FeelState<S>, &mut LawState<S>),
        inputs: &Inputs,
        sample: &Sample<S>,
        allow: impl FnOnce(&ControlOutput<S>) -> Option<S>,
    ) -> S {
        S::section("sampling");
        let [force, piston, base, grip] = sample.sensors;
        let [period, per_period] = [shared.period_s(), 1.0 / shared.period_s()].map(|number| force.constant(number));
        let (force, piston) = self.converters.read(force, piston);
        // There is no tachometer: the velocity is the last period's difference.
        let base_rate = ((base - remembered.base) * per_period).named("base_rate");
        remembered.base = base;
        let y = self.sampled(&[force, piston, base, grip]);
        let [delta, delta_rate] = feeling.motion.at;
        let piston_rate = ((piston - remembered.position) * per_period).named("drive_rate");
        S::section("cancellation");
        let added = shared.cancellation.map(|known| known.command(piston, piston_rate, delta_rate));
        remembered.position = piston;
        let fade = inputs.fade[0];
        let known = if shared.effects.known_friction { Some(remembered.friction_state) } else { None };
        let output = if shared.effects.observer {
            let now = self.observer.output(&remembered.estimate, &y, [delta, delta_rate], known);
            if fade == 0.0 {
                now
            } else {
                now.lerp(self.next_observer.output(&remembered.estimate, &y, [delta, delta_rate], known), fade)
            }
        } else {
            let x = [piston, force / self.force_per_effort, delta, delta_rate, base, base_rate, sample.pilot_force];
            LawOutput::of_gains(self.law.command(&x), self.law.feel_torque(force))
        };
        S::section("neutral");
        let (output, neutral) = if shared.effects.surroundings {
            // A force beside the hand's moves the place where no hand is needed, as the neutral does.
            let beside = [inputs.added_force, inputs.added_stiffness, inputs.added_damping].map(|[now, _]| now);
            let alone = self.feel.pushed_to(feeling.neutral, feeling.motion.at, beside);
            (self.trimmed(output, alone, fade), alone)
        } else {
            (output, feeling.neutral)
        };
        S::section("contact");
        let column = [base, base_rate].map(|number| number * self.per_base);
        let (output, contact) = if shared.effects.contact_law {
            let inputs =
                ContactInputs { force, position: [piston, piston_rate], angle: column, feel: feeling.motion.at };
            let at_end = shared.effects.grip_sensor & shared.effects.column_stops;
            let at_end = at_end.then(|| self.at_end(output.torque, feeling, inputs));
            let neutral = known.map(|_| neutral);
            let state = (&mut *feeling, &mut remembered.contact_state);
            let alone = !shared.effects.excited;
            self.in_contact(output, state, (inputs, neutral, at_end, alone), [period, per_period])
        } else {
            (output, period.zero())
        };
        S::section("limits");
        let requested = added.map_or(output.command, |added| output.command + added);
        let allowed = allow(&ControlOutput { command: requested, torque: output.torque, base_rate });
        if shared.effects.observer {
            remembered.friction_state = output.friction_state;
            // What the amplifier answers together with what is added.
            let e = allowed.map_or(output.command, |allowed| output.command + (allowed - requested));
            let e = added.map_or_else(
                || self.converters.within_range(e),
                |added| self.converters.within_range(e + added) - added,
            );
            S::section("observer_state");
            remembered.estimate =
                self.next_estimate(&remembered.estimate, &y, e, (known.map(|_| output.friction), fade));
        }
        let e = allowed.unwrap_or(requested);
        S::section("trim");
        // The neutral moves through the period; the feel runs about where it is at half of it.
        let trim = period.constant(inputs.trim[0]);
        let neutral = self.feel.trimmed(feeling.neutral, trim, period.times(0.5));
        let at = (neutral, feeling.motion.slider, feeling.motion.at[0]);
        let conditions = self.feel_conditions(&shared.effects, at, inputs, (StepFraction::Start, period));
        self.feel_computer(shared, fade).run(&mut feeling.motion, output.torque, &conditions, period);
        if shared.effects.contact_law {
            S::section("contact");
            self.damp(&mut feeling.motion, contact, period);
        }
        S::section("trim");
        feeling.neutral = self.feel.trimmed(feeling.neutral, trim, period);
        S::section("give_way");
        let gains = if shared.effects.observer {
            let of = |law: &Observer<S>| [law.per_delta(), law.per_rate()];
            let (from, to) = (of(&self.observer), of(&self.next_observer));
            [0, 1].map(|k| from[k] + (to[k] - from[k]).times(fade))
        } else {
            [self.law.gains[2], self.law.gains[3]]
        };
        let beyond = (e - self.converters.within_range(e)).named("beyond_range");
        self.give_way(shared, &mut feeling.motion, (gains, allowed.map_or(beyond, |e| requested - e + beyond)), period);
        if shared.effects.contact_law {
            S::section("contact");
            feeling.motion.at = self.observer.contact.follow(feeling.motion.at, (column, feeling.neutral));
        }
        S::section("conversion");
        self.converters.write(e)
    }

    /// The command of a sample that nothing else limits, and the torque that the feel computer receives. Unlike the machine it is the same for
    /// all drives: compiled once for them where [`Scalar::COMPILED_ONCE`].
    #[inline(always)]
    pub fn command_and_torque(
        &self,
        shared: &Shared,
        law: (&mut FeelState<S>, &mut LawState<S>),
        inputs: &Inputs,
        sample: &Sample<S>,
    ) -> [S; 2] {
        if S::COMPILED_ONCE {
            self.command_compiled_once(shared, law, inputs, sample)
        } else {
            self.command_inlined(shared, law, inputs, sample)
        }
    }

    #[inline(never)]
    fn command_compiled_once(
        &self,
        shared: &Shared,
        law: (&mut FeelState<S>, &mut LawState<S>),
        inputs: &Inputs,
        sample: &Sample<S>,
    ) -> [S; 2] {
        self.command_inlined(shared, law, inputs, sample)
    }

    #[inline(always)]
    fn command_inlined(
        &self,
        shared: &Shared,
        law: (&mut FeelState<S>, &mut LawState<S>),
        inputs: &Inputs,
        sample: &Sample<S>,
    ) -> [S; 2] {
        let mut torque = sample.pilot_force;
        let command = self.command(shared, law, inputs, sample, |output| {
            torque = output.torque;
            None
        });
        [command, torque]
    }

    /// What the law says between free motion and contact, and the share of the contact that damps the feel; where it begins, the feel stands where the
    /// drive stands. A column that friction holds near the neutral is in contact too.
    #[inline(always)]
    fn in_contact(
        &self,
        output: LawOutput<S>,
        (feeling, state): (&mut FeelState<S>, &mut ContactState<S>),
        (inputs, neutral, at_end, alone): (ContactInputs<S>, Option<S>, Option<S::Mask>, bool),
        period: [S; 2],
    ) -> (LawOutput<S>, S) {
        let law = &self.observer.contact;
        let friction = neutral.map(|_| self.observer.friction.largest());
        let (now, begins) = law.noticed(
            (output.torque, friction),
            ([inputs.angle[0], inputs.feel[0], inputs.feel[1]], at_end, alone),
            *state,
            period,
        );
        let [delta, rate] = inputs.feel;
        let stands = law.where_drive_stands(inputs.position[0]);
        *state = now;
        let mut feel = [S::select(begins, stands, delta), S::select(begins, rate.zero(), rate)];
        feeling.motion.at = feel;
        if let Some(at_end) = at_end {
            // The feel has the column's rate as it is, the command that without noise.
            let [delta, rate] = feel;
            let [column, column_rate] = inputs.angle;
            feeling.motion.at = [S::select(at_end, column, delta), S::select(at_end, column_rate, rate)];
            feel = [feeling.motion.at[0], S::select(at_end, now.rate, rate)];
        }
        let inputs = ContactInputs { feel, ..inputs };
        let touching = law.torque(inputs.force);
        let mut friction_state = output.friction_state;
        let (share, touching) = neutral.map_or((now.share, touching), |neutral| {
            let friction = &self.observer.friction;
            let spring = self.feel.spring_torque(neutral, inputs.feel[0]);
            let before = (friction_state.rested, period[0]);
            let (held, rested) = friction.holds([now.rate, spring], self.feel.per_torque, before);
            friction_state.rested = rested;
            let one = touching.constant(1.0);
            (
                S::select(held, one, now.share),
                S::select(held, friction.at_rest(touching, friction_state.push), touching),
            )
        });
        let [command, torque] = law.output([share, now.offset], [output.command, output.torque], touching, &inputs);
        let beyond = command - self.converters.within_range(command);
        state.offset = law.next_offset(&now, [inputs.feel[0], inputs.angle[0]], (beyond, period[0]));
        // A feel that moves as the column is not damped.
        let damps = at_end.map_or(share, |at_end| S::select(at_end, share.zero(), share));
        (LawOutput { command, torque, friction_state, ..output }, damps)
    }

    /// Whether feel and column are at an end stop that the hand pushes into, or the feel's own motion: a force sensor at the grip does not show
    /// it. The feel would go on, and the drive push the column into the stop with all that it has.
    #[inline(always)]
    fn at_end(&self, hand: S, feeling: &FeelState<S>, inputs: ContactInputs<S>) -> S::Mask {
        let ([low, high], near) = (self.ends, self.observer.contact.near);
        let ([delta, rate], [column, _]) = (feeling.motion.at, inputs.angle);
        let (spring, zero) = (self.feel.spring_torque(feeling.neutral, delta), hand.zero());
        (high.less(delta) & (high - near).less(column) & (spring.less(hand) | zero.less(rate)))
            | (delta.less(low) & column.less(low + near) & (hand.less(spring) | rate.less(zero)))
    }

    /// The feel after a period, damped by its share in a contact.
    #[inline(always)]
    fn damp(&self, motion: &mut FeelMotion<S>, share: S, period: S) {
        let [delta, rate] = motion.at;
        let damped = self.observer.contact.damped(share, rate, self.feel.per_torque, period);
        // The way goes with the mean of the rates.
        motion.at = [delta - (rate - damped) * period.times(0.5), damped];
    }

    /// What the law says where the feel, without a hand, does not rest at zero.
    #[inline(always)]
    pub(crate) fn trimmed(&self, output: LawOutput<S>, neutral: S, fade: f64) -> LawOutput<S> {
        let (from, to) = (self.observer.per_neutral(), self.next_observer.per_neutral());
        // What a neutral has no part in takes nothing from one that is no number: in the traced C it is left out.
        let of = |k: usize| {
            let per_neutral = if fade == 0.0 { from[k] } else { from[k] + (to[k] - from[k]).times(fade) };
            per_neutral.slope_times(neutral)
        };
        LawOutput { command: output.command + of(0), torque: output.torque + of(1), ..output }
    }

    /// The feel gives way where the drive does not follow: `beyond` of its command, of which there is so much per `delta` and per `delta'`.
    #[inline(always)]
    fn give_way(
        &self,
        shared: &Shared,
        motion: &mut FeelMotion<S>,
        ([per_delta, per_rate], beyond): ([S; 2], S),
        period: S,
    ) {
        if !S::any(beyond.zero().less(beyond.abs())) {
            return;
        }
        let [further, faster] = self.given_way([per_delta, per_rate], period);
        let excess = quotient(beyond, per_delta);
        let slower = faster * excess;
        let [delta, rate] = motion.at;
        let sticks = shared.effects.feel_friction;
        // What sticks keeps its speed of zero.
        let slower = if sticks { S::select(motion.grip.stuck, rate.zero(), slower) } else { slower };
        motion.at = [delta - further * excess, rate - slower];
    }

    /// Displacement and rate that the feel gives up in a period, per displacement that its command is beyond the drive.
    #[inline(always)]
    pub(crate) fn given_way(&self, [per_delta, per_rate]: [S; 2], period: S) -> [S; 2] {
        // delta' = ... - 2 a_w x, delta'' = ... - a_w^2 x, x = (e - e_cut) / c_3: place and speed give way, or the speed would carry the
        // control on.
        let way = self.converters.antiwindup;
        let given = [way.times(2.0) * period, way * way * period];
        // The command goes back by c_3 delta + c_4 delta'; by no more than it is beyond, however quick a_w is for the period.
        let back = given[0] + given[1] * quotient(per_rate, per_delta).max(per_delta.zero());
        let over = back.max(back.constant(1.0));
        given.map(|given| given / over)
    }

    /// The observer's state at the next sample; while the feel changes, between the two laws'.
    #[inline(always)]
    fn next_estimate(
        &self,
        xi: &Estimate<S>,
        y: &[S; SAMPLED],
        e: S,
        (friction, fade): (Option<S>, f64),
    ) -> Estimate<S> {
        let from = self.observer.next(xi, y, e, friction);
        if fade == 0.0 {
            return from;
        }
        let to = self.next_observer.next(xi, y, e, friction);
        let mut next = from;
        for k in 0..MOST_STATES {
            next[k] = from[k] + (to[k] - from[k]).times(fade);
        }
        next
    }

    /// What the law remembers in equilibrium, where the sensors show `sensors`, its observer's state is `estimate` and the feel stands at
    /// displacement and rate.
    #[inline(always)]
    pub fn remember(&self, sensors: [S; SENSORS], estimate: Estimate<S>, feel: [S; 2]) -> LawState<S> {
        let (y, [_, position, base, _]) = (self.sampled(&sensors), sensors);
        let friction_state = self.observer.output(&estimate, &y, feel, None).friction_state;
        let contact_state = ContactState::free(friction_state.feel_torque, base * self.per_base);
        LawState { base, position, estimate, friction_state, contact_state }
    }

    /// What the law remembers where it has looked on for long, without a command, at sensors that show `sensors`.
    pub fn initial_estimate(&self, sensors: [S; SENSORS]) -> LawState<S> {
        let y = self.sampled(&sensors);
        let zero = y[0].zero();
        self.remember(sensors, self.observer.initial_estimate(&y, zero), [self.delta_at(sensors[2]), zero])
    }

    /// Sensors as a law takes them, the column's as an angle.
    #[inline(always)]
    pub(crate) fn sampled(&self, &[force, position, base, grip]: &[S; SENSORS]) -> [S; SAMPLED] {
        [force, position, base * self.per_base, grip]
    }

    /// The feel at rest at the programmed displacement `delta`, its neutral in the same unit.
    #[inline(always)]
    pub fn resting(&self, delta: S, neutral: S) -> FeelState<S> {
        FeelState { motion: FeelMotion::resting(&self.feel, delta), neutral }
    }

    /// Programmed displacement where feel and column, its base at `base`, stand alike.
    #[inline(always)]
    pub fn delta_at(&self, base: S) -> S {
        base * self.per_base * self.feel.per_angle
    }

    /// What the drive answers of a command: within what converter and amplifier give.
    #[inline(always)]
    pub fn within_range(&self, e: S) -> S {
        self.converters.within_range(e)
    }

    /// Programmed angle in rad per programmed displacement.
    #[inline(always)]
    pub fn per_delta(&self) -> S {
        self.per_base.constant(1.0) / self.feel.per_angle
    }

    /// Column angle in rad per displacement of the base in m.
    #[inline(always)]
    pub fn per_base(&self) -> S {
        self.per_base
    }

    /// Acceleration in rad/s² that the feel would give the programmed control if no hand were on it, its dry friction left out.
    #[inline(always)]
    pub fn free_acceleration(&self, shared: &Shared, feeling: &FeelState<S>, inputs: &Inputs) -> S {
        let [delta, rate] = feeling.motion.at;
        let at = (feeling.neutral, feeling.motion.slider, delta);
        let conditions = self.feel_conditions(&shared.effects, at, inputs, (StepFraction::Start, delta.zero()));
        self.feel_computer(shared, inputs.fade[0]).acceleration((delta, rate), delta.zero(), &conditions)
            / self.feel.per_angle
    }

    /// Force at the grip in N that holds the programmed control at rest at an angle in rad: what its spring, which has a factor, preload,
    /// detent, hysteresis and soft stops push back with there. Its dry friction is left out; `fade`: how far the feel has been changed.
    ///
    /// The effects have `surroundings`, in which a force at the grip is.
    #[inline(always)]
    pub fn holding_force(&self, shared: &Shared, feeling: &FeelState<S>, (factor, fade): (S, f64), angle: S) -> S {
        let (zero, delta) = (angle.zero(), angle * self.feel.per_angle);
        let slider = self.feel.dragged(feeling.motion.slider, delta);
        let still = FeelConditions { slider, ..FeelConditions::at_rest(feeling.neutral, factor, delta) };
        let computer = self.feel_computer(shared, fade);
        let under = |added_force| computer.acceleration((delta, zero), zero, &FeelConditions { added_force, ..still });
        // The feel is linear in a force: what takes the acceleration away.
        let free = under(zero);
        free / (free - under(angle.constant(1.0)))
    }

    /// Begins to change the feel to that of `parameters`, and the law to `observer` where there is one; how far it is, the inputs'
    /// `fade` says.
    #[inline(always)]
    pub fn fade_to(&mut self, parameters: &Parameters<S>, observer: Option<&Observer<S>>) {
        self.next_feel = FeelLaw::new(parameters, &self.law);
        self.next_observer = *observer.unwrap_or(&self.observer);
    }

    /// The next feel is the feel from now on.
    #[inline(always)]
    pub fn faded(&mut self) {
        self.feel = self.next_feel;
        self.observer = self.next_observer;
    }

    /// The feel computer where the feel has been changed so far.
    #[inline(always)]
    pub(crate) fn feel_computer<'a>(&'a self, shared: &'a Shared, fade: f64) -> FeelComputer<'a, S> {
        FeelComputer {
            feel: &self.feel,
            next: &self.next_feel,
            fade,
            effects: &shared.effects,
            curve: shared.curve.as_ref(),
        }
    }

    /// What the feel is told from outside, where its neutral, its hysteresis' slider and it itself stand, within a step of `h`.
    #[inline(always)]
    pub(crate) fn feel_conditions(
        &self,
        effects: &Effects,
        (neutral, slider, start): (S, S, S),
        inputs: &Inputs,
        (moment, h): (StepFraction, S),
    ) -> FeelConditions<S> {
        let one = neutral.constant(1.0);
        let share = match moment {
            StepFraction::Start => 0.0,
            StepFraction::Half => 0.5,
            StepFraction::End => 1.0,
        };
        FeelConditions {
            neutral: if effects.surroundings {
                self.feel.trimmed(neutral, one.constant(moment.of(inputs.trim)), h.times(share))
            } else {
                neutral
            },
            stiffness_factor: one.constant(moment.of(inputs.stiffness_factor)),
            shaker: one.constant(moment.of(inputs.shaker)),
            added_force: one.constant(moment.of(inputs.added_force)),
            added: [inputs.added_stiffness, inputs.added_damping].map(|of| one.constant(moment.of(of))),
            slider,
            start,
        }
    }
}
