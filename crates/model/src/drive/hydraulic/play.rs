//! The link meets the end of its play inside a step: the pressure comes in with a jump.
//!
//! `T` time from the touch to the end of the step · `P` impulse of the pressure over it · see `contact.rs`

use super::pressure::{Flow, Side};
use super::{CURRENT, Hydraulic, Oil};
use crate::Scalar;
use crate::contact::since_touch;
use crate::drive::{Contact, Neighbors};
use crate::effects::Effects;
use crate::run::{RunSnapshot, RunState, RunStepStart, Shared};

impl<S: Scalar> Contact<S> for Hydraulic<S> {
    #[inline(always)]
    fn touches(&self, plant: &[S; 5]) -> S::Mask {
        self.balance.touch(self.balance.stretch(plant[0], plant[3]))
    }

    #[inline(always)]
    fn command_jump(&self, effects: &Effects, now: &RunSnapshot<S, Flow<S>>, e_change: S) -> S {
        self.valve.flow_jump(effects, now.signals[CURRENT], e_change)
    }

    #[inline(always)]
    fn close_play(
        &self,
        neighbors: &Neighbors<'_, S>,
        shared: &Shared,
        state: &mut RunState<S, Oil<S>>,
        start: &[S; 5],
        step_start: &RunStepStart<S, Flow<S>, Side<S>>,
    ) {
        let (effects, balance, h) = (&shared.effects, &self.balance, neighbors.step);
        let [z, q_i, _, x_b, w] = state.slow.plant;
        let zero = z.zero();
        let (before, stretch) = (balance.stretch(start[0], start[3]), balance.stretch(z, x_b));
        let met = balance.touch(stretch) & !balance.touch(before);
        state.late = zero;
        if !S::any(met) {
            return;
        }
        let depth = stretch - stretch.within(balance.half_play);
        let rate = q_i * self.per_area - balance.ratio * w;
        let (time, _) = since_touch(met, (depth, stretch - before), rate, h);
        let first = balance.linked(effects, &step_start.side, z - depth, q_i, x_b, w);
        let last = balance.linked(effects, &step_start.side, z, q_i, x_b, w);
        let [first_on, last_on] = [first, last].map(|flow| flow.pressure - flow.seals);
        let met = met & zero.less(first_on * stretch) & zero.less(last_on * stretch);
        // The pressure is a straight line over T.
        let only = |value: S| S::select(met, value, zero);
        let p = only((first_on + last_on).times(0.5));
        let (impulse, travel) = (p * time, only(first_on.times(2.0) + last_on) * time * time);
        let lost = only((first.flow + last.flow).times(0.5) - q_i) * time;
        state.slow.plant[0] = z + lost * self.per_area;

        let moving = |stuck: S::Mask, there: bool, value: S| if there { S::select(stuck, zero, value) } else { value };
        let by = neighbors.column.per_link_force * balance.area;
        let stuck = state.column.stuck;
        state.slow.plant[3] = x_b + moving(stuck, effects.column_friction, by * travel.times(1.0 / 6.0));
        state.slow.plant[4] = w + moving(stuck, effects.column_friction, by * impulse);
        state.late = only(neighbors.transducers.load_cell_late(time, first_on / last_on));
        if shared.timing.is_some() {
            return;
        }
        let jump = self.command_jump(effects, &step_start.now, neighbors.law.gains[1] * p);
        state.slow.plant[2] = state.slow.plant[2] + only(jump) * time;
        // What a load cell with a lag lets through: a straight line over the whole step is what it takes the pressure for.
        let share = neighbors.transducers.load_cell_share(time);
        let by = neighbors.law.feel_torque(balance.area) * neighbors.feel_per_torque * S::select(met, share, zero);
        let stuck = state.feel.stuck;
        state.slow.feel[0] = state.slow.feel[0] + moving(stuck, effects.feel_friction, by * travel.times(1.0 / 6.0));
        state.slow.feel[1] = state.slow.feel[1] + moving(stuck, effects.feel_friction, by * impulse);
    }
}
