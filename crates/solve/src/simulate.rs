//! Runs in time: one loader, or several side by side, through the steps of their inputs.

use forcefeel_model::Scalar;
use forcefeel_model::machine::{Inputs, Machine, Now, Rest, Shared};
use forcefeel_model::observer::Observer;
use forcefeel_model::parameters::Parameters;
use forcefeel_model::transducers::SENSORS;

/// Where a run begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Start {
    /// At rest under this pilot force in N; at neutral where the amplifier is open and there is no rest.
    Under(f64),
    /// At rest, the grip held at this angle in rad up to the start of this step.
    Held(f64, usize),
}

impl Start {
    fn rest<S: Scalar>(self, machine: &Machine<S>, shared: &Shared, first: &Inputs, like: S) -> Rest<S> {
        let [trim, factor] = [first.trim[0], first.stiffness_factor[0]].map(|value| like.constant(value));
        let angle = match self {
            Self::Held(angle, _) => angle,
            // Where the amplifier is open nothing brings the column back, so it begins at neutral.
            Self::Under(force)
                if (shared.effects.biased || force != 0.0 || first.trim[0] != 0.0) && !machine.drifts() =>
            {
                return machine.held_by(shared, machine.force(force), trim, factor);
            }
            Self::Under(_) => 0.0,
        };
        machine.held_at(shared, like.constant(angle), trim, factor)
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
    /// The law with an observer that holds afterwards; the one of before if there is none.
    pub observer: Option<Observer<S>>,
}

/// What is wanted of the middles of the steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Middles {
    /// Nothing.
    None,
    /// Where the base is.
    Base,
    /// Everything.
    All,
}

/// What looks on as a run goes by. A trait and no closure, because a closure is not sure to be compiled into the lanes' loop.
pub trait Record<S> {
    /// How much to look at half-way through each step.
    fn middles(&self) -> Middles;
    /// The start of a step or the end of the last, or the middle of one; `instant` counts steps, or half steps.
    fn see(&mut self, instant: usize, now: &Now<S>);
    /// The base's displacement in the middle of a step.
    fn see_base(&mut self, base: S);
}

/// Runs a loader through `inputs`, one for each step; `record` sees the start of every step and the end of the last, and the
/// middles if it asks for them.
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
    if inputs.is_empty() {
        return;
    }
    let rest = start.rest(machine, shared, &inputs[0], machine.per_base());
    let (mut state, mut memory) = (machine.start(shared, &rest), machine.remember(&rest));
    let mut changes = changes.iter().peekable();
    let held_until = start.held_until();
    Machine::hold(&mut state, &rest);
    if held_until == 0 {
        Machine::let_go(&mut state);
    }
    if let Some(change) = changes.peek()
        && change.steps.0 == 0
    {
        machine.fade_to(&change.parameters, change.observer.as_ref());
    }
    let middles = record.middles();
    let stride = if middles == Middles::None { 1 } else { 2 };
    let mut begun = machine.begin(shared, &mut state, &mut memory, &inputs[0], &mut normal);
    record.see(0, &begun.now);
    for (step, now) in inputs.iter().enumerate() {
        machine.advance(shared, &mut state, now, &begun);
        let next = step + 1;
        if next == held_until {
            Machine::let_go(&mut state);
        }
        if changes.peek().is_some_and(|change| next == change.steps.1) {
            machine.faded(shared, &mut state);
            changes.next();
        }
        // Only then: the next change may begin where the last one ends.
        if let Some(change) = changes.peek()
            && next == change.steps.0
        {
            machine.fade_to(&change.parameters, change.observer.as_ref());
        }
        let ended = now.end();
        let coming = inputs.get(next).unwrap_or(&ended);
        let after = machine.begin(shared, &mut state, &mut memory, coming, &mut normal);
        match middles {
            Middles::None => {}
            Middles::Base => record.see_base(machine.middle_base(&begun, &after)),
            Middles::All => record.see(stride * next - 1, &machine.middle(shared, now, &begun, &after)),
        }
        record.see(stride * next, &after.now);
        begun = after;
    }
}
