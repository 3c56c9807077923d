//! Law and feel as a loop runs them under a supervisor: placed where the column stands, at rest there until they are followed.
//!
//! The live loop, a target board and the faults in virtual time take each of their samples through this.

use crate::Logic;
use crate::control::{Control, ControlOutput, FeelState, LawState, Sample};
use crate::logic::{LogicState, LogicVisitor};
use crate::observer::Estimate;
use crate::run::{Inputs, Shared};
use crate::supervisor::{SupervisorOutput, finite};
use crate::transducers::SENSORS;

/// What passes of a law's command.
#[derive(Debug, Clone, Copy)]
pub struct LimitedCommand<S: Logic> {
    /// The command that may go out.
    pub command: S,
    /// Whether the drive is to be powered.
    pub enable: S::Mask,
    /// Whether the law is followed.
    pub follows: S::Mask,
}

impl<S: Logic> From<&SupervisorOutput<S>> for LimitedCommand<S> {
    #[inline(always)]
    fn from(allowed: &SupervisorOutput<S>) -> Self {
        Self { command: allowed.command, enable: allowed.enable, follows: allowed.follows }
    }
}

/// Law and feel of a loader under a supervisor.
#[derive(Debug, Clone)]
pub struct SupervisedLaw<S: Logic> {
    remembered: LawState<S>,
    feeling: FeelState<S>,
    /// Whether law and feel know where the column stands.
    placed: S::Mask,
    /// What the sensors show with the column at rest at zero and at another angle: [`Machine::sensors_at_rest`].
    ///
    /// [`Machine::sensors_at_rest`]: crate::machine::Machine::sensors_at_rest
    at_rest: [[S; SENSORS]; 2],
    answer: ControlOutput<S>,
    command: S,
}

impl<S: Logic> LogicState<S> for SupervisedLaw<S> {
    fn visit(&mut self, visitor: &mut impl LogicVisitor<S>) {
        self.remembered.visit_samples(visitor);
        self.feeling.visit(visitor);
        self.remembered.visit_estimate(visitor);
        visitor.flag("placed", &mut self.placed);
        visitor.number("asked", &mut self.answer.command);
        visitor.number("torque", &mut self.answer.torque);
        visitor.number("base_rate", &mut self.answer.base_rate);
        visitor.number("command", &mut self.command);
    }
}

impl<S: Logic> SupervisedLaw<S> {
    /// They find out at the first sample where the column stands.
    pub fn new(control: &Control<S>, at_rest: [[S; SENSORS]; 2]) -> Self {
        let zero = at_rest[0][0].zero();
        Self {
            remembered: control.initial_estimate(at_rest[0]),
            feeling: control.resting(zero, zero),
            placed: S::mask(false),
            at_rest,
            answer: ControlOutput { command: zero, torque: zero, base_rate: zero },
            command: zero,
        }
    }

    /// They begin in an equilibrium: its sensors, the state of the law's observer, and how the feel stands.
    pub fn in_equilibrium(
        control: &Control<S>,
        at_rest: [[S; SENSORS]; 2],
        (sensors, estimate, feeling): ([S; SENSORS], Estimate<S>, FeelState<S>),
    ) -> Self {
        let remembered = control.remember(sensors, estimate, feeling.motion.at);
        Self { remembered, feeling, placed: S::mask(true), ..Self::new(control, at_rest) }
    }

    /// The programmed feel.
    pub fn feeling(&self) -> &FeelState<S> {
        &self.feeling
    }

    /// What the law answered last.
    pub fn answer(&self) -> &ControlOutput<S> {
        &self.answer
    }

    /// A period: the command that goes out. `pass` is the supervisor, and is asked once. Where nothing was sampled that a law could use, the
    /// command holds, as far as it passes.
    #[inline]
    pub fn step(
        &mut self,
        law: (&Shared, &Control<S>),
        inputs: &Inputs,
        sample: Option<&Sample<S>>,
        pass: impl FnOnce(&ControlOutput<S>) -> LimitedCommand<S>,
    ) -> S {
        let none = Sample { sensors: self.at_rest[0], pilot_force: self.command.zero() };
        self.step_where(law, inputs, (sample.unwrap_or(&none), S::mask(sample.is_some())), pass)
    }

    /// The same, with a sample that can be used where the condition holds.
    #[inline(always)]
    pub fn step_where(
        &mut self,
        law: (&Shared, &Control<S>),
        inputs: &Inputs,
        (sample, usable): (&Sample<S>, S::Mask),
        pass: impl FnOnce(&ControlOutput<S>) -> LimitedCommand<S>,
    ) -> S {
        let usable = sample.sensors.iter().fold(usable, |usable, value| usable & value.is_number());
        self.command = if S::any(usable) {
            self.act(law, inputs, (sample, usable), pass)
        } else {
            pass(&ControlOutput { command: self.command, ..self.answer }).command
        };
        self.command
    }

    #[inline(always)]
    fn act(
        &mut self,
        (shared, control): (&Shared, &Control<S>),
        inputs: &Inputs,
        (sample, usable): (&Sample<S>, S::Mask),
        pass: impl FnOnce(&ControlOutput<S>) -> LimitedCommand<S>,
    ) -> S {
        // Where a sample may be unusable, the law is not asked, and what is written of it is thrown away.
        let before = if S::any(!usable) { Some(self.clone()) } else { None };
        self.place(control, &sample.sensors);
        let (answer, mut passed) = (&mut self.answer, None);
        let law = (&mut self.feeling, &mut self.remembered);
        let written = control.command(shared, law, inputs, sample, |output| {
            *answer = *output;
            if let Some(before) = &before {
                let held = ControlOutput { command: before.command, ..before.answer };
                answer.command = S::select(usable, output.command, held.command);
            }
            let now = pass(answer);
            passed = Some(now);
            // Where nothing is changed, the law goes on to the very bit.
            differ(now.command, answer.command).then_some(now.command)
        });
        // The model asks once, always.
        let Some(passed) = passed else { return written.zero() };
        // Where it is no number, what the law remembers is lost.
        self.placed = self.answer.command.is_number();
        // Where it is not followed, the law looks on, told of the command that goes out; the feel waits where the column stands.
        let rests = !passed.follows;
        self.rest(control, sample.sensors[2], rests);
        if let Some(before) = &before {
            S::paths(self, |this| {
                if S::holds(!usable) {
                    *this = before.clone();
                }
            });
        }
        // The converter's step may round the command up; without power there is none.
        S::select(rests | !usable, passed.command, S::select(passed.enable, written, written.zero()))
    }

    /// The law begins as if it had looked on for long where the column stands. What the drive's sensor and the load cell show besides is not
    /// taken for rest: a law that integrates would make volts of their noise, and take long to forget it.
    #[inline(always)]
    fn place(&mut self, control: &Control<S>, sensors: &[S; SENSORS]) {
        let placed = self.placed;
        self.placed = S::mask(true);
        if !S::any(!placed) {
            return;
        }
        S::section("rest");
        let [zero, there] = &self.at_rest;
        let share = (sensors[2] - zero[2]) / (there[2] - zero[2]);
        let sensors_there = core::array::from_fn(|k| zero[k] + (there[k] - zero[k]) * share);
        let remembered = control.initial_estimate(sensors_there);
        // The law's observer has had sections of its own.
        S::section("rest");
        S::paths(self, |this| {
            if S::holds(!placed) {
                this.remembered = remembered;
            }
        });
        self.rest(control, sensors[2], !placed);
    }

    /// The feel rests where the column stands, its neutral there too, where the condition holds.
    #[inline(always)]
    fn rest(&mut self, control: &Control<S>, base: S, rests: S::Mask) {
        if !S::any(rests) {
            return;
        }
        let delta = control.delta_at(base);
        if finite(delta) {
            let resting = control.resting(delta, delta);
            S::paths(self, |this| {
                if S::holds(rests) {
                    this.feeling = resting;
                }
            });
        }
    }
}

/// Whether two numbers are not the same; what is no number is not even that.
fn differ<S: Logic>(a: S, b: S) -> bool {
    !finite(a) || !finite(b) || S::any(a.less(b) | b.less(a))
}
