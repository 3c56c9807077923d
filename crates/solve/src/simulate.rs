//! Runs in time: one loader, or several side by side, through the steps of their inputs.

use crate::wide::Wide;
use forcefeel_model::Scalar;
use forcefeel_model::machine::{Begun, Equilibrium, Inputs, Machine, Now, Shared};
use forcefeel_model::observer::Observer;
use forcefeel_model::parameters::Parameters;
use forcefeel_model::transducers::SENSORS;

/// Where a run begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Start {
    /// At rest under this pilot force in N; at neutral where the amplifier is open and there is no equilibrium.
    Under(f64),
    /// In equilibrium, the grip held at this angle in rad up to the start of this step.
    Held(f64, usize),
}

/// Where a run begins, found.
#[derive(Debug, Clone, Copy)]
pub struct Beginning<S> {
    /// The loader in equilibrium.
    pub equilibrium: Equilibrium<S>,
    /// Up to which step a hand holds the grip.
    pub held_until: usize,
}

impl<T: Wide> Beginning<T> {
    /// Those of several runs side by side; the last one again where there are no more.
    #[inline(always)]
    pub fn gathered(token: T::Token, runs: &[Beginning<f64>]) -> Self {
        let numbers: Vec<_> = runs.iter().map(|run| run.equilibrium.numbers()).collect();
        let last = runs.len() - 1;
        let equilibrium = core::array::from_fn(|k| T::gather(token, |lane| numbers[lane.min(last)][k]));
        Self { equilibrium: Equilibrium::from_numbers(&equilibrium), held_until: runs[last].held_until }
    }
}

impl Start {
    /// The loader in equilibrium, under the first of `inputs`.
    pub fn of<S: Scalar>(self, machine: &Machine<S>, shared: &Shared, inputs: &[Inputs]) -> Beginning<S> {
        let first = inputs.first().unwrap_or(&Inputs::NONE);
        let like = machine.per_base();
        let [trim, factor] = [first.trim[0], first.stiffness_factor[0]].map(|value| like.constant(value));
        let held_at = |angle: f64| machine.held_at(shared, like.constant(angle), trim, factor);
        match self {
            Self::Held(angle, step) => Beginning { equilibrium: held_at(angle), held_until: step },
            // Where the amplifier is open nothing brings the column back, so it begins at neutral.
            Self::Under(force)
                if (shared.effects.biased || force != 0.0 || first.trim[0] != 0.0) && !machine.drifts() =>
            {
                Beginning { equilibrium: machine.held_by(shared, machine.force(force), trim, factor), held_until: 0 }
            }
            Self::Under(_) => Beginning { equilibrium: held_at(0.0), held_until: 0 },
        }
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
    beginning: &Beginning<S>,
    inputs: &[Inputs],
    changes: &[FeelChange<S>],
    mut normal: impl FnMut() -> [S; SENSORS],
    record: &mut impl Record<S>,
) {
    if inputs.is_empty() {
        return;
    }
    let &Beginning { ref equilibrium, held_until } = beginning;
    let (mut state, mut memory) = (machine.start(shared, equilibrium), machine.remember(equilibrium));
    let mut changes = changes.iter().peekable();
    Machine::hold(&mut state, equilibrium);
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
    let ended = inputs[inputs.len() - 1].end();
    let mut last: Option<(Begun<S>, &Inputs)> = None;
    // One place where a step begins, the end of the last among them: it is compiled into every vector's loop.
    for step in 0..=inputs.len() {
        let now = inputs.get(step).unwrap_or(&ended);
        let begun = machine.begin(shared, &mut state, &mut memory, now, &mut normal);
        if let Some((before, inputs)) = &last {
            match middles {
                Middles::None => {}
                Middles::Base => record.see_base(machine.middle_base(before, &begun)),
                Middles::All => record.see(stride * step - 1, &machine.middle(shared, inputs, before, &begun)),
            }
        }
        record.see(stride * step, &begun.now);
        if step == inputs.len() {
            return;
        }
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
        if middles != Middles::None {
            last = Some((begun, now));
        }
    }
}
