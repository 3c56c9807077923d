//! Runs in time: one loader, or several side by side, through the steps of their inputs.

use forcefeel_model::Scalar;
use forcefeel_model::drive::Drive;
use forcefeel_model::machine::{Inputs, Machine, Shared, Snapshot, State, StepStart};
use forcefeel_model::observer::Observer;
use forcefeel_model::parameters::Parameters;
use forcefeel_model::transducers::SENSORS;
use forcefeel_solve::start::Beginning;

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
pub trait Record<S: Scalar, D: Drive<S>> {
    /// How much to look at half-way through each step.
    fn middles(&self) -> Middles;
    /// The start of a step or the end of the last, or the middle of one; `instant` counts steps, or half steps.
    fn see(&mut self, instant: usize, now: &Snapshot<S, D>);
    /// The base's displacement in the middle of a step.
    fn see_base(&mut self, base: S);
}

/// Runs a loader through `inputs`, one for each step; `record` sees the start of every step and the end of the last, and the
/// middles if it asks for them.
///
/// `in_flight` gives the inputs of a step in a flight, if there is one, from those without, where the loader stands; `normal` a standard normal
/// number for each sensor at each sample.
#[inline(always)]
pub fn run<S: Scalar, D: Drive<S>>(
    machine: &mut Machine<S, D>,
    shared: &Shared,
    beginning: &Beginning<S>,
    inputs: &[Inputs],
    changes: &[FeelChange<S>],
    (in_flight, mut normal): (
        impl Fn(usize, &Inputs, &Machine<S, D>, &State<S, D>) -> Option<Inputs>,
        impl FnMut() -> [S; SENSORS],
    ),
    record: &mut impl Record<S, D>,
) {
    if inputs.is_empty() {
        return;
    }
    let &Beginning { ref equilibrium, held_until } = beginning;
    let (mut state, mut memory) = (machine.start(shared, equilibrium), machine.remember(shared, equilibrium));
    let mut changes = changes.iter().peekable();
    Machine::<S, D>::hold(&mut state, equilibrium);
    if held_until == 0 {
        Machine::<S, D>::let_go(&mut state);
    }
    if let Some(change) = changes.peek()
        && change.steps.0 == 0
    {
        machine.fade_to(&change.parameters, change.observer.as_ref());
    }
    let middles = record.middles();
    let stride = if middles == Middles::None { 1 } else { 2 };
    let ended = inputs[inputs.len() - 1].end();
    let mut last: Option<(StepStart<S, D>, Inputs)> = None;
    // One place where a step begins, the end of the last among them: it is compiled into every vector's loop.
    for step in 0..=inputs.len() {
        let still = inputs.get(step).unwrap_or(&ended);
        let flown = in_flight(step, still, machine, &state);
        let now = flown.as_ref().unwrap_or(still);
        // What runs in vector lanes must be inlined.
        let step_start = if S::IN_LANES {
            machine.begin(shared, &mut state, &mut memory, now, &mut normal)
        } else {
            machine.begin_compiled_once(shared, &mut state, &mut memory, now, &mut normal)
        };
        if let Some((before, inputs)) = &last {
            match middles {
                Middles::None => {}
                Middles::Base => record.see_base(machine.middle_base(before, &step_start)),
                Middles::All => record.see(stride * step - 1, &machine.middle(shared, inputs, before, &step_start)),
            }
        }
        record.see(stride * step, &step_start.now);
        if step == inputs.len() {
            return;
        }
        if S::IN_LANES {
            machine.advance(shared, &mut state, now, &step_start);
        } else {
            machine.advance_compiled_once(shared, &mut state, now, &step_start);
        }
        let next = step + 1;
        if next == held_until {
            Machine::<S, D>::let_go(&mut state);
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
        if middles != Middles::None {
            last = Some((step_start, *now));
        }
    }
}
