//! Dry friction's share of a step, of column and feel.

use super::{Machine, Shared, Snapshot, State};
use crate::Scalar;
use crate::drive::Drive;
use crate::effects::Effects;
use crate::run::Inputs;
use crate::run::Slow;

impl<S: Scalar, D: Drive<S>> Machine<S, D> {
    /// Dry friction at the start of a step: first what it did inside the last step, then what it does in this one.
    #[inline(always)]
    pub(super) fn settle(
        &self,
        shared: &Shared,
        state: &mut State<S, D>,
        inputs: &Inputs,
        now: &mut Snapshot<S, D>,
        rates: &mut Slow<S>,
        side: D::Side,
    ) -> D::Side {
        let effects = &shared.effects;
        let mut side = side;
        if effects.column_friction {
            let friction = &self.column.friction;
            let (v, pull) = (now.base_rate, rates.plant[4]);
            // What the force jumped between the steps did not pull in the last one.
            let jump = self.column.per_pilot_force * (now.pilot_force - state.pilot_force);
            let settled = friction.settled(&state.column, v, pull - jump, (self.step, self.per_step));
            state.column = friction.grip(settled.velocity, pull);
            state.slow.plant[3] = state.slow.plant[3] + settled.displacement;
            let w = self.drive.base_momentum(settled.velocity, &now.balance);
            state.slow.plant[4] = S::select(settled.settled, w, state.slow.plant[4]);
            now.base = state.slow.plant[3];
            now.base_rate = settled.velocity;
            rates.plant[3] = settled.velocity;
            side = self.drive.side(effects, state.column.stuck);
        }
        if effects.feel_friction && shared.timing.is_none() {
            let (rate, pull) = (now.delta_rate, rates.feel[1]);
            let friction = self.feel_computer(shared, inputs.fade[0]).friction();
            let settled = friction.settled(&state.feel, rate, pull, (self.step, self.per_step));
            state.feel = friction.grip(settled.velocity, pull);
            state.slow.feel[0] = state.slow.feel[0] + settled.displacement;
            let u = self.drive.feel_momentum(settled.velocity, &now.balance);
            state.slow.feel[1] = S::select(settled.settled, u, state.slow.feel[1]);
            now.delta = state.slow.feel[0];
            now.delta_rate = settled.velocity;
            rates.feel[0] = settled.velocity;
        }
        self.drive.settle(&self.neighbors(), effects, state, now, rates);
        Self::resist(effects, state, rates);
        side
    }

    /// Adds dry friction to the rates.
    #[inline(always)]
    pub(super) fn resist(effects: &Effects, state: &State<S, D>, rates: &mut Slow<S>) {
        if effects.column_friction {
            let pull = rates.plant[4] + state.column.drag;
            rates.plant[4] = S::select(state.column.stuck, pull.zero(), pull);
        }
        D::resist(effects, &state.drive, rates);
        if effects.feel_friction && !effects.sampled {
            let pull = rates.feel[1] + state.feel.drag;
            rates.feel[1] = S::select(state.feel.stuck, pull.zero(), pull);
        }
    }
}
