//! Runs in time: one loader, or eight side by side, through the steps of their inputs.

use forcefeel_model::Scalar;
use forcefeel_model::machine::{Inputs, Machine, Now, Rest, Shared};
use forcefeel_model::parameters::Parameters;
use forcefeel_model::transducers::SENSORS;

/// Where a run begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Start {
    /// At rest under this pilot force in N.
    Under(f64),
    /// At rest, the grip held at this angle in rad up to the start of this step.
    Held(f64, usize),
}

impl Start {
    fn rest<S: Scalar>(self, machine: &Machine<S>, shared: &Shared, first: &Inputs, like: S) -> Rest<S> {
        let [trim, factor] = [first.trim[0], first.stiffness_factor[0]].map(|value| like.constant(value));
        match self {
            Self::Held(angle, _) => machine.held_at(shared, like.constant(angle), trim, factor),
            Self::Under(force) if shared.effects.biased || force != 0.0 || first.trim[0] != 0.0 => {
                machine.held_by(shared, machine.force(force), trim, factor)
            }
            Self::Under(_) => machine.held_at(shared, like.zero(), trim, factor),
        }
    }

    /// Up to which step a hand holds the grip.
    fn held_until(self) -> usize {
        if let Self::Held(_, step) = self { step } else { 0 }
    }
}

/// A change of the feel while running.
#[derive(Debug, Clone, Copy)]
pub struct FeelChange<S> {
    /// Step at which it begins, and step at which it is done; how far it is between, the inputs' `fade` says.
    pub steps: (usize, usize),
    /// Parameters whose feel holds afterwards.
    pub parameters: Parameters<S>,
}

/// What looks on as a run goes by. A trait and no closure, because a closure is not sure to be compiled into the lanes' loop.
pub trait Record<S> {
    /// The start of step `step`, or the end of the last.
    fn see(&mut self, step: usize, now: &Now<S>);
}

/// Runs a loader through `inputs`, one for each step; `record` sees the start of every step and the end of the last.
///
/// `normal` gives a standard normal number for each sensor at each sample.
#[inline(always)]
pub fn run<S: Scalar>(
    machine: &mut Machine<S>,
    shared: &Shared,
    start: Start,
    inputs: &[Inputs],
    changes: &[FeelChange<S>],
    mut normal: impl FnMut() -> [S; SENSORS],
    record: &mut impl Record<S>,
) {
    let Some(last) = inputs.last() else { return };
    let rest = start.rest(machine, shared, &inputs[0], machine.per_base());
    let (mut state, mut memory) = (machine.start(shared, &rest), machine.remember(&rest));
    let mut changes = changes.iter().peekable();
    let held_until = start.held_until();
    Machine::hold(&mut state, &rest);
    for (step, inputs) in inputs.iter().enumerate() {
        if step == held_until {
            Machine::let_go(&mut state);
        }
        if let Some(change) = changes.peek() {
            if step == change.steps.0 {
                machine.fade_to(&change.parameters);
            }
            if step == change.steps.1 {
                machine.faded(shared, &mut state);
                changes.next();
            }
        }
        let begun = machine.begin(shared, &mut state, &mut memory, inputs, &mut normal);
        record.see(step, &begun.now);
        machine.advance(shared, &mut state, inputs, &begun);
    }
    let begun = machine.begin(shared, &mut state, &mut memory, &last.end(), &mut normal);
    record.see(inputs.len(), &begun.now);
}
