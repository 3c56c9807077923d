//! The feel computer's share of a step.

use super::{Machine, Shared, State};
use crate::Scalar;
use crate::drive::Drive;
use crate::effects::Effects;
use crate::feel::FeelConditions;
use crate::feel_computer::FeelComputer;
use crate::observer::Observer;
use crate::parameters::Parameters;
use crate::run::{Inputs, StepFraction};

impl<S: Scalar, D: Drive<S>> Machine<S, D> {
    /// Begins to change the feel to that of `parameters`, and the law to `observer` where there is one; how far it is, the inputs'
    /// `fade` says.
    #[inline(always)]
    pub fn fade_to(&mut self, parameters: &Parameters<S>, observer: Option<&Observer<S>>) {
        self.control.fade_to(parameters, observer);
    }

    /// The next feel is the feel from now on.
    #[inline(always)]
    pub fn faded(&mut self, shared: &Shared, state: &mut State<S, D>) {
        let side = self.drive.side(&shared.effects, state.column.stuck);
        let touches = self.drive.touches(&state.slow.plant);
        let balance = self.drive.balance(&shared.effects, &side, touches, &state.slow.plant);
        let friction_torque =
            self.drive.feel_changed(self.control.feel.per_torque, self.control.next_feel.per_torque, &balance);
        self.control.faded();
        if shared.timing.is_none() {
            // The velocity stays; what is given back to it with the drive's impulse does not.
            state.slow.feel[1] = state.slow.feel[1] + friction_torque;
        }
    }

    /// The feel computer where the feel has been changed so far.
    #[inline(always)]
    pub(super) fn feel_computer<'a>(&'a self, shared: &'a Shared, fade: f64) -> FeelComputer<'a, S> {
        self.control.feel_computer(shared, fade)
    }

    #[inline(always)]
    pub(super) fn feel_conditions(
        &self,
        effects: &Effects,
        state: &State<S, D>,
        inputs: &Inputs,
        moment: StepFraction,
    ) -> FeelConditions<S> {
        let at = (state.neutral, state.slider, state.slow.feel[0]);
        self.control.feel_conditions(effects, at, inputs, (moment, self.step))
    }

    #[inline(always)]
    pub(super) fn dragged(&self, effects: &Effects, state: &State<S, D>) -> S {
        if effects.feel_spring { self.control.feel.dragged(state.slider, state.slow.feel[0]) } else { state.slider }
    }
}
