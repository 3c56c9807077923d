//! Runs in time: one loader, or eight side by side, through the steps of their inputs.

use forcefeel_model::Scalar;
use forcefeel_model::machine::{Inputs, Machine, Now, Rest, Shared};
use forcefeel_model::transducers::SENSORS;

/// Where a run begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Start {
    /// At rest under the first pilot force.
    Rest,
    /// At rest, the grip held at this angle in rad until the run begins.
    Held(f64),
}

impl Start {
    fn rest<S: Scalar>(self, machine: &Machine<S>, shared: &Shared, first: &Inputs, like: S) -> Rest<S> {
        let [trim, factor] = [first.trim[0], first.stiffness_factor[0]].map(|value| like.constant(value));
        match self {
            Self::Held(angle) => machine.held_at(shared, like.constant(angle), trim, factor),
            Self::Rest if shared.effects.biased || first.force[0] != 0.0 || first.trim[0] != 0.0 => {
                machine.held_by(shared, machine.force(first.force[0]), trim, factor)
            }
            Self::Rest => machine.held_at(shared, like.zero(), trim, factor),
        }
    }
}

/// Runs a loader through `inputs`, one for each step; `record` sees the start of every step and the end of the last.
///
/// `normal` gives a standard normal number for each sensor at each sample.
#[inline(always)]
pub fn run<S: Scalar>(
    machine: &Machine<S>,
    shared: &Shared,
    start: Start,
    inputs: &[Inputs],
    mut normal: impl FnMut() -> [S; SENSORS],
    mut record: impl FnMut(usize, &Now<S>),
) {
    let Some(last) = inputs.last() else { return };
    let rest = start.rest(machine, shared, &inputs[0], machine.force(1.0));
    let mut state = machine.start(shared, &rest);
    for (step, inputs) in inputs.iter().enumerate() {
        let begun = machine.begin(shared, &mut state, inputs, &mut normal);
        record(step, &begun.now);
        machine.advance(shared, &mut state, inputs, &begun);
    }
    let end = last.end();
    let begun = machine.begin(shared, &mut state, &end, &mut normal);
    record(inputs.len(), &begun.now);
}
