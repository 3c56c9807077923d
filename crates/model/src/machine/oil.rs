//! The oil's share of a step: load pressure and flow in balance, and how far the true ones lag behind them.

use super::slow::Slow;
use super::{Machine, Now, State};
use crate::Scalar;
use crate::effects::Effects;
use crate::pressure::{Side, Yielding};

impl<S: Scalar> Machine<S> {
    /// What follows from the slow states: pressure and flow in balance, velocities and forces, and what sensors measure of a pressure
    /// that is off its balance by `lag`.
    #[inline(always)]
    pub(super) fn look(
        &self,
        effects: &Effects,
        side: &Side<S>,
        slow: &Slow<S>,
        state: &State<S>,
        (pilot_force, lag): (S, S),
    ) -> Now<S> {
        let [z, _, _, x_b, w] = slow.plant;
        let [delta, u] = slow.feel;
        let slaved = self.balance.solve(effects, side, self.link_touches(&state.slow), slow.plant);
        let p = slaved.pressure;
        let moving = w - self.base_impulse * p;
        let base_rate = if effects.column_friction { S::select(state.column.stuck, w.zero(), moving) } else { moving };
        let delta_rate = if effects.sampled {
            u
        } else {
            let rate = u + self.feel_impulse * p;
            if effects.feel_friction { S::select(state.feel.stuck, u.zero(), rate) } else { rate }
        };
        let pressure = p + lag;
        Now {
            base: x_b,
            base_rate,
            delta,
            delta_rate,
            piston: self.balance.piston(z, pressure),
            force: self.balance.area * pressure,
            pressure,
            flow: slaved.flow,
            current: p.zero(),
            pilot_force,
            slaved,
        }
    }

    /// Whether the link is beyond its play at the start of the step.
    #[inline(always)]
    pub(super) fn link_touches(&self, start: &Slow<S>) -> S::Mask {
        self.balance.touch(self.balance.stretch(start.plant[0], start.plant[3]))
    }

    /// Pressure and flow as far as they have come behind their balance up to the start of a step.
    #[inline(always)]
    pub(super) fn follow(
        &self,
        effects: &Effects,
        side: &Side<S>,
        yielding: &Yielding<S>,
        state: &mut State<S>,
        now: &mut Now<S>,
    ) {
        let [z, q_i, q_i_rate, x_b, _] = state.slow.plant;
        // Up to here there was the force of before.
        let mut accelerated = self.pull(effects, (x_b, x_b), &Now { pilot_force: state.pilot_force, ..*now });
        if effects.column_friction {
            accelerated = accelerated + state.column.drag;
        }
        let rates = [now.slaved.flow * self.per_area, q_i_rate, q_i.zero(), now.base_rate, accelerated];
        let rate = self.balance.slaved_rate(side, yielding, (q_i, &now.slaved), &rates);
        let slaved = now.slaved.pressure;
        let mut change = slaved - state.pressure;
        if effects.backlash {
            // Where the link met the end of its play the pressure came with a jump, which is no rate.
            change = S::select(self.balance.holds(state.pressure), change, rate * self.step);
        }
        let change = (state.lag, change, rate);
        let mut oil = self.balance.behind(yielding, &now.slaved, change, (self.step, self.per_step));
        if effects.backlash {
            let holds = self.balance.holds(slaved);
            oil.pressure = S::select(holds, oil.pressure, slaved);
            oil.flow = S::select(holds, oil.flow, now.slaved.flow);
        }
        (now.pressure, now.flow) = (oil.pressure, oil.flow);
        (now.piston, now.force) = (self.balance.piston(z, oil.pressure), self.balance.area * oil.pressure);
        (state.pressure, state.lag) = (slaved, slaved - oil.pressure);
    }

    /// Makes good what the pressure's lag behind its slaved value did in the last step.
    #[inline(always)]
    pub(super) fn catch_up(&self, effects: &Effects, yielding: &Yielding<S>, state: &mut State<S>, now: &mut Now<S>) {
        let lagging = self.balance.lagging(yielding, now.slaved.pressure - state.pressure);
        let (base, feel) = (self.base_impulse * lagging.pressure, -self.feel_impulse * lagging.pressure);
        state.slow.plant[0] = state.slow.plant[0] + lagging.piston;
        state.slow.plant[4] = state.slow.plant[4] + base;
        state.slow.feel[1] = state.slow.feel[1] + feel;
        let unless = |mask: S::Mask, value: S, by: S| S::select(mask, value, value + by);
        now.base_rate = if effects.column_friction {
            unless(state.column.stuck, now.base_rate, base)
        } else {
            now.base_rate + base
        };
        now.delta_rate =
            if effects.feel_friction { unless(state.feel.stuck, now.delta_rate, feel) } else { now.delta_rate + feel };
    }
}
