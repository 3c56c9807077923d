//! What touched inside a step: stops of column and feel, and the link at the end of its play.
//!
//! See `contact.rs`; what the link does at the end of its play is the drive's, see its `play.rs`.

use super::step::Stage;
use super::{Machine, Shared, State, StepStart};
use crate::Scalar;
use crate::contact::since_touch;
use crate::drive::Drive;
use crate::run::Slow;
use crate::run::{Inputs, StepFraction};

impl<S: Scalar, D: Drive<S>> Machine<S, D> {
    /// Makes good what touched inside the step that began with `step_start` and `start`.
    #[inline(always)]
    pub(super) fn touch(
        &self,
        shared: &Shared,
        state: &mut State<S, D>,
        inputs: &Inputs,
        start: &Slow<S>,
        step_start: &StepStart<S, D>,
    ) {
        let effects = &shared.effects;
        if effects.column_stops {
            self.meet_end_stop(state, start, step_start);
        }
        if effects.feel_damping_and_stops && shared.timing.is_none() {
            self.meet_soft_stop(shared, state, inputs, start, step_start);
        }
        if effects.feel_limits && shared.timing.is_none() {
            self.meet_hard_stop(shared, state, inputs, step_start);
        }
        if effects.backlash {
            self.drive.close_play(&self.neighbors(), shared, state, &start.plant, step_start);
        }
    }

    #[inline(always)]
    fn meet_end_stop(&self, state: &mut State<S, D>, start: &Slow<S>, step_start: &StepStart<S, D>) {
        // What the drive takes of it is a thousandth of the velocity.
        let v = self.drive.base_velocity(state.slow.plant[4], &step_start.now.balance);
        let way = (start.plant[3], state.slow.plant[3]);
        let push = self.column.stops.push(way, v, self.step, v.constant(1.0));
        state.slow.plant[3] = state.slow.plant[3] + push.displacement;
        state.slow.plant[4] = state.slow.plant[4] + push.velocity;
    }

    #[inline(always)]
    fn meet_soft_stop(
        &self,
        shared: &Shared,
        state: &mut State<S, D>,
        inputs: &Inputs,
        start: &Slow<S>,
        step_start: &StepStart<S, D>,
    ) {
        let rate = self.drive.feel_velocity(state.slow.feel[1], &step_start.now.balance);
        let way = (start.feel[0], state.slow.feel[0]);
        let push = self.feel_computer(shared, inputs.fade[0]).soft_stop_push(way, rate, self.step);
        state.slow.feel[0] = state.slow.feel[0] + push.displacement;
        state.slow.feel[1] = state.slow.feel[1] + push.velocity;
    }

    /// Hard stops and velocity limit of the feel.
    #[inline(always)]
    fn meet_hard_stop(&self, shared: &Shared, state: &mut State<S, D>, inputs: &Inputs, step_start: &StepStart<S, D>) {
        let effects = &shared.effects;
        let before = (step_start.now.delta, step_start.now.delta_rate);
        let [delta, u] = state.slow.feel;
        let free = (delta, self.drive.feel_velocity(u, &step_start.now.balance));
        let (mut held, mut rate) = self.control.feel.limited(before, free, self.step);
        let depth = delta - held;
        let zero = depth.zero();
        let met = zero.less(depth.abs()) & zero.less((before.0 - held).abs());
        if S::any(met) {
            let (time, at_stop) = since_touch(met, (depth, delta - before.0), free.1, self.step);
            // The servo was told of a velocity that the control no longer had.
            let moved = self.control.law.gains[3] * (at_stop + free.1).times(-0.5);
            let jump = self.drive.command_jump(effects, &step_start.now, moved) * time;
            state.slow.plant[2] = state.slow.plant[2] + S::select(met, jump, zero);
            // From rest at the stop it goes back at once, if it is drawn back.
            let mut back = self.pull_at_rest(shared, state, inputs, step_start, held);
            if effects.feel_friction {
                back = self.feel_computer(shared, inputs.fade[0]).friction().from_rest(back);
            }
            back = S::select(met & (back * depth).less(zero), back, zero);
            held = held + (back * time * time).times(0.5);
            rate = rate + back * time;
        }
        state.slow.feel = [held, self.drive.feel_momentum(rate, &step_start.now.balance)];
    }

    /// Acceleration of the feel, dry friction left out, at rest at `delta` at the end of the step.
    #[inline(always)]
    fn pull_at_rest(
        &self,
        shared: &Shared,
        state: &State<S, D>,
        inputs: &Inputs,
        step_start: &StepStart<S, D>,
        delta: S,
    ) -> S {
        let stage = Stage { shared, inputs, state, moment: StepFraction::End };
        let pilot_force = self.pilot_force(state, inputs, StepFraction::End);
        let end = self.look(&shared.effects, &step_start.side, &state.slow, state, (pilot_force, delta.zero()));
        let ([force, ..], _) = self.shown(&stage, &end);
        let conditions = self.feel_conditions(&shared.effects, state, inputs, StepFraction::End);
        let torque = self.received_torque(force, &end);
        self.feel_computer(shared, inputs.fade[1]).acceleration((delta, delta.zero()), torque, &conditions)
    }
}
