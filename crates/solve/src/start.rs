//! Where a run begins.

use crate::rest::is_pulled;
use crate::wide::Wide;
use forcefeel_model::Scalar;
use forcefeel_model::drive::Drive;
use forcefeel_model::machine::{Equilibrium, Inputs, Machine, Shared};

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
    pub fn of<S: Scalar, D: Drive<S>>(
        self,
        machine: &Machine<S, D>,
        shared: &Shared,
        inputs: &[Inputs],
    ) -> Beginning<S> {
        let first = inputs.first().unwrap_or(&Inputs::NONE);
        let like = machine.per_base();
        let [trim, factor] = [first.trim[0], first.stiffness_factor[0]].map(|value| like.constant(value));
        let held_at = |angle: f64| machine.held_at(shared, like.constant(angle), trim, factor);
        match self {
            Self::Held(angle, step) => Beginning { equilibrium: held_at(angle), held_until: step },
            // Where the amplifier is open nothing brings the column back, so it begins at neutral.
            Self::Under(force) if is_pulled(shared, force, first.trim[0]) && !machine.drifts() => {
                Beginning { equilibrium: machine.held_by(shared, machine.force(force), trim, factor), held_until: 0 }
            }
            Self::Under(_) => Beginning { equilibrium: held_at(0.0), held_until: 0 },
        }
    }
}
