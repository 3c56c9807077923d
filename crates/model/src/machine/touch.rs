//! What touched inside a step: stops of column and feel, and the link at the end of its play.
//!
//! `T` time from the touch to the end of the step · `P` impulse of the pressure over it · see `contact.rs`

use super::inputs::{Inputs, Moment};
use super::slow::Slow;
use super::step::Stage;
use super::{Begun, Machine, Shared, State};
use crate::Scalar;
use crate::contact::since_touch;

impl<S: Scalar> Machine<S> {
    /// Makes good what touched inside the step that began with `begun` and `start`.
    #[inline(always)]
    pub(super) fn touch(
        &self,
        shared: &Shared,
        state: &mut State<S>,
        inputs: &Inputs,
        start: &Slow<S>,
        begun: &Begun<S>,
    ) {
        let effects = &shared.effects;
        if effects.column_stops {
            self.meet_end_stop(state, start, begun);
        }
        if effects.feel_damping_and_stops && shared.timing.is_none() {
            self.meet_soft_stop(shared, state, inputs, start, begun);
        }
        if effects.feel_limits && shared.timing.is_none() {
            self.meet_hard_stop(shared, state, inputs, begun);
        }
        if effects.backlash {
            self.close_play(shared, state, start, begun);
        }
    }

    #[inline(always)]
    fn meet_end_stop(&self, state: &mut State<S>, start: &Slow<S>, begun: &Begun<S>) {
        // The oil's impulse is a thousandth of the velocity.
        let v = state.slow.plant[4] - self.base_impulse * begun.now.slaved.pressure;
        let way = (start.plant[3], state.slow.plant[3]);
        let push = self.column.stops.push(way, v, self.step, v.constant(1.0));
        state.slow.plant[3] = state.slow.plant[3] + push.displacement;
        state.slow.plant[4] = state.slow.plant[4] + push.velocity;
    }

    #[inline(always)]
    fn meet_soft_stop(
        &self,
        shared: &Shared,
        state: &mut State<S>,
        inputs: &Inputs,
        start: &Slow<S>,
        begun: &Begun<S>,
    ) {
        let rate = state.slow.feel[1] + self.feel_impulse * begun.now.slaved.pressure;
        let way = (start.feel[0], state.slow.feel[0]);
        let push = self.feel_computer(shared, inputs.fade[0]).soft_stop_push(way, rate, self.step);
        state.slow.feel[0] = state.slow.feel[0] + push.displacement;
        state.slow.feel[1] = state.slow.feel[1] + push.velocity;
    }

    /// Hard stops and velocity limit of the feel.
    #[inline(always)]
    fn meet_hard_stop(&self, shared: &Shared, state: &mut State<S>, inputs: &Inputs, begun: &Begun<S>) {
        let effects = &shared.effects;
        let impulse = self.feel_impulse * begun.now.slaved.pressure;
        let before = (begun.now.delta, begun.now.delta_rate);
        let [delta, u] = state.slow.feel;
        let free = (delta, u + impulse);
        let (mut held, mut rate) = self.feel.limited(before, free, self.step);
        let depth = delta - held;
        let zero = depth.zero();
        let met = zero.less(depth.abs()) & zero.less((before.0 - held).abs());
        if S::any(met) {
            let (time, at_stop) = since_touch(depth, delta - before.0, free.1, self.step);
            // The servo was told of a velocity that the control no longer had.
            let told = self.law.gains[3] * (at_stop + free.1).times(-0.5);
            let jump = self.valve.flow_jump(effects, begun.now.current, told) * time;
            state.slow.plant[2] = state.slow.plant[2] + S::select(met, jump, zero);
            // From rest at the stop it goes back at once, if it is drawn back.
            let mut back = self.pull_at_rest(shared, state, inputs, begun, held);
            if effects.feel_friction {
                back = self.feel_computer(shared, inputs.fade[0]).friction().from_rest(back);
            }
            back = S::select(met & (back * depth).less(zero), back, zero);
            held = held + (back * time * time).times(0.5);
            rate = rate + back * time;
        }
        state.slow.feel = [held, rate - impulse];
    }

    /// Acceleration of the feel, dry friction left out, at rest at `delta` at the end of the step.
    #[inline(always)]
    fn pull_at_rest(&self, shared: &Shared, state: &State<S>, inputs: &Inputs, begun: &Begun<S>, delta: S) -> S {
        let stage = Stage { shared, inputs, state, moment: Moment::End };
        let pilot_force = self.pilot_force(state, inputs, Moment::End);
        let end = self.look(&shared.effects, &begun.side, &state.slow, state, (pilot_force, delta.zero()));
        let ([force, ..], _) = self.shown(&stage, &end);
        let around = self.around(&shared.effects, state, inputs, Moment::End);
        let torque = self.heard_torque(force, &end);
        self.feel_computer(shared, inputs.fade[1]).acceleration((delta, delta.zero()), torque, &around)
    }

    /// The link meets the end of its play: the pressure comes in with a jump.
    #[inline(always)]
    fn close_play(&self, shared: &Shared, state: &mut State<S>, start: &Slow<S>, begun: &Begun<S>) {
        let (effects, balance, h) = (&shared.effects, &self.balance, self.step);
        let [z, q_i, _, x_b, w] = state.slow.plant;
        let zero = z.zero();
        let (before, stretch) = (balance.stretch(start.plant[0], start.plant[3]), balance.stretch(z, x_b));
        let met = balance.touch(stretch) & !balance.touch(before);
        state.late = zero;
        if !S::any(met) {
            return;
        }
        let depth = stretch - stretch.within(balance.half_play);
        let rate = q_i * self.per_area - balance.ratio * w;
        let (time, _) = since_touch(depth, stretch - before, rate, h);
        let first = balance.linked(effects, &begun.side, z - depth, q_i, x_b, w);
        let last = balance.linked(effects, &begun.side, z, q_i, x_b, w);
        let met = met & zero.less(first.pressure * stretch) & zero.less(last.pressure * stretch);
        // The pressure is a straight line over T.
        let only = |value: S| S::select(met, value, zero);
        let p = only((first.pressure + last.pressure).times(0.5));
        let (impulse, travel) = (p * time, only(first.pressure.times(2.0) + last.pressure) * time * time);
        let lost = only((first.flow + last.flow).times(0.5) - q_i) * time;
        state.slow.plant[0] = z + lost * self.per_area;

        let moving = |stuck: S::Mask, there: bool, value: S| if there { S::select(stuck, zero, value) } else { value };
        let by = self.column.per_link_force * balance.area;
        let stuck = state.column.stuck;
        state.slow.plant[3] = x_b + moving(stuck, effects.column_friction, by * travel.times(1.0 / 6.0));
        state.slow.plant[4] = w + moving(stuck, effects.column_friction, by * impulse);
        state.late = only(self.transducers.load_cell_late(time, first.pressure / last.pressure));
        if shared.timing.is_some() {
            return;
        }
        let jump = self.valve.flow_jump(effects, begun.now.current, self.law.gains[1] * p);
        state.slow.plant[2] = state.slow.plant[2] + only(jump) * time;
        // What a load cell with a lag lets through: a straight line over the whole step is what it takes the pressure for.
        let heard = self.transducers.load_cell_share(time);
        let by = self.law.feel_torque(balance.area) * self.feel.per_torque * S::select(met, heard, zero);
        let stuck = state.feel.stuck;
        state.slow.feel[0] = state.slow.feel[0] + moving(stuck, effects.feel_friction, by * travel.times(1.0 / 6.0));
        state.slow.feel[1] = state.slow.feel[1] + moving(stuck, effects.feel_friction, by * impulse);
    }
}
