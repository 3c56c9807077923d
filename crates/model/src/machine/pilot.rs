//! The pilot's force in a step.

use super::{Equilibrium, Inputs, Machine, State, StepFraction};
use crate::Scalar;
use crate::drive::Drive;

impl<S: Scalar, D: Drive<S>> Machine<S, D> {
    /// The pilot's force in N where the inputs give `force`.
    #[inline(always)]
    pub fn force(&self, force: f64) -> S {
        self.force_scale.times(force)
    }

    #[inline(always)]
    pub(super) fn pilot_force(&self, state: &State<S, D>, inputs: &Inputs, moment: StepFraction) -> S {
        self.force(moment.of(inputs.force)) + state.hand
    }

    /// A hand holds the grip with the force of `equilibrium`.
    pub fn hold(state: &mut State<S, D>, equilibrium: &Equilibrium<S>) {
        state.hand = equilibrium.pilot_force;
    }

    /// The hand lets go.
    pub fn let_go(state: &mut State<S, D>) {
        state.hand = state.hand.zero();
    }
}
