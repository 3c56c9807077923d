//! A machine beside another, as a link between their columns sees it.

use super::{Machine, Shared, Snapshot, State, StepStart};
use crate::Scalar;
use crate::drive::Drive;

impl<S: Scalar, D: Drive<S>> Machine<S, D> {
    /// Angle of the column in rad.
    #[inline(always)]
    pub fn column_angle(&self, state: &State<S, D>) -> S {
        state.slow.plant[3] * self.per_base()
    }

    /// Angle of the column in rad and its rate after a step that began with `step_start`.
    #[inline(always)]
    pub fn column_motion(&self, shared: &Shared, state: &State<S, D>, step_start: &StepStart<S, D>) -> [S; 2] {
        let none = (state.pilot_force, state.held.zero());
        let now = self.look(&shared.effects, &step_start.side, &state.slow, state, none);
        [now.base, now.base_rate].map(|number| number * self.per_base())
    }

    /// Angle of the programmed control in rad and its rate; the rate under a digital controller.
    #[inline(always)]
    pub fn programmed_motion(&self, state: &State<S, D>) -> [S; 2] {
        state.slow.feel.map(|number| number * self.per_delta())
    }

    /// Force of the hand on the grip in N: the pilot's, and what damping and spring of the arm add.
    #[inline(always)]
    pub fn hand_force(&self, now: &Snapshot<S, D>) -> S {
        self.grip.hand(now.pilot_force, [now.base, now.base_rate])
    }

    /// Holds the column from now on, whatever moves it; `shared` has dry friction of the column in play.
    pub fn jam(&mut self, start: &StepStart<S, D>) {
        self.column.jam([start.now.base_rate, start.rates.plant[4]], self.step);
    }
}
