//! Law and feel as a loop runs them under a supervisor: placed where the column stands, at rest there until they are followed.
//!
//! The live loop, a target board and the faults in virtual time take each of their samples through this.

use crate::Scalar;
use crate::control::{Control, ControlOutput, FeelState, LawState, Sample};
use crate::observer::Estimate;
use crate::run::{Inputs, Shared};
use crate::supervisor::{SupervisorOutput, finite};
use crate::transducers::SENSORS;

/// What passes of a law's command.
#[derive(Debug, Clone, Copy)]
pub struct LimitedCommand<S> {
    /// The command that may go out.
    pub command: S,
    /// Whether the drive is to be powered.
    pub enable: bool,
    /// Whether the law is followed.
    pub follows: bool,
}

impl<S: Scalar> From<&SupervisorOutput<S>> for LimitedCommand<S> {
    #[inline(always)]
    fn from(allowed: &SupervisorOutput<S>) -> Self {
        Self { command: allowed.command, enable: allowed.enable, follows: allowed.follows }
    }
}

/// Law and feel of a loader under a supervisor.
#[derive(Debug, Clone)]
pub struct SupervisedLaw<S: Scalar> {
    remembered: LawState<S>,
    feeling: FeelState<S>,
    /// Whether law and feel know where the column stands.
    placed: bool,
    /// What the sensors show with the column at rest at zero and at another angle: [`Machine::sensors_at_rest`].
    ///
    /// [`Machine::sensors_at_rest`]: crate::machine::Machine::sensors_at_rest
    at_rest: [[S; SENSORS]; 2],
    answer: ControlOutput<S>,
    command: S,
}

impl<S: Scalar> SupervisedLaw<S> {
    /// They find out at the first sample where the column stands.
    pub fn new(control: &Control<S>, at_rest: [[S; SENSORS]; 2]) -> Self {
        let zero = at_rest[0][0].zero();
        Self {
            remembered: control.initial_estimate(at_rest[0]),
            feeling: control.resting(zero, zero),
            placed: false,
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
        Self { remembered, feeling, placed: true, ..Self::new(control, at_rest) }
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
        (shared, control): (&Shared, &Control<S>),
        inputs: &Inputs,
        sample: Option<&Sample<S>>,
        pass: impl FnOnce(&ControlOutput<S>) -> LimitedCommand<S>,
    ) -> S {
        let sample = sample.filter(|sample| sample.sensors.iter().all(|&value| finite(value)));
        self.command = match sample {
            Some(sample) => self.act((shared, control), inputs, sample, pass),
            None => pass(&ControlOutput { command: self.command, ..self.answer }).command,
        };
        self.command
    }

    #[inline]
    fn act(
        &mut self,
        (shared, control): (&Shared, &Control<S>),
        inputs: &Inputs,
        sample: &Sample<S>,
        pass: impl FnOnce(&ControlOutput<S>) -> LimitedCommand<S>,
    ) -> S {
        self.place(control, &sample.sensors);
        let (answer, mut passed) = (&mut self.answer, None);
        let law = (&mut self.feeling, &mut self.remembered);
        let written = control.command(shared, law, inputs, sample, |output| {
            *answer = *output;
            let now = pass(output);
            passed = Some(now);
            // Where nothing is changed, the law goes on to the very bit.
            differ(now.command, output.command).then_some(now.command)
        });
        // The model asks once, always.
        let Some(passed) = passed else { return written.zero() };
        if !finite(self.answer.command) {
            // What the law remembers is lost.
            self.placed = false;
        }
        if !passed.follows {
            // The law looks on, told of the command that goes out; the feel waits where the column stands.
            self.rest(control, sample.sensors[2]);
            return passed.command;
        }
        // The converter's step may round the command up; without power there is none.
        if passed.enable { written } else { written.zero() }
    }

    /// The law begins as if it had looked on for long where the column stands. What the drive's sensor and the load cell show besides is not
    /// taken for rest: a law that integrates would make volts of their noise, and take long to forget it.
    fn place(&mut self, control: &Control<S>, sensors: &[S; SENSORS]) {
        if self.placed {
            return;
        }
        self.placed = true;
        let [zero, there] = &self.at_rest;
        let share = (sensors[2] - zero[2]) / (there[2] - zero[2]);
        let sensors_there = core::array::from_fn(|k| zero[k] + (there[k] - zero[k]) * share);
        self.remembered = control.initial_estimate(sensors_there);
        self.rest(control, sensors[2]);
    }

    /// The feel rests where the column stands, its neutral there too.
    fn rest(&mut self, control: &Control<S>, base: S) {
        let delta = control.delta_at(base);
        if finite(delta) {
            self.feeling = control.resting(delta, delta);
        }
    }
}

/// Whether two numbers are not the same; what is no number is not even that.
fn differ<S: Scalar>(a: S, b: S) -> bool {
    !finite(a) || !finite(b) || S::any(a.less(b) | b.less(a))
}
