//! How far load pressure and flow are behind their balance, and what that did in the last step.

use super::pressure::{Flow, PressureSensitivity, Side};
use super::{FLOW, Hydraulic, Oil, PRESSURE};
use crate::Scalar;
use crate::drive::{Motion, Neighbors, QuickPart};
use crate::effects::Effects;
use crate::run::{RunSnapshot, RunState};

impl<S: Scalar> QuickPart<S> for Hydraulic<S> {
    #[inline(always)]
    fn base_velocity(&self, w: S, balance: &Flow<S>) -> S {
        w - self.base_impulse * balance.pressure
    }

    #[inline(always)]
    fn base_momentum(&self, velocity: S, balance: &Flow<S>) -> S {
        velocity + self.base_impulse * balance.pressure
    }

    #[inline(always)]
    fn feel_velocity(&self, u: S, balance: &Flow<S>) -> S {
        u + self.feel_impulse * balance.pressure
    }

    #[inline(always)]
    fn feel_momentum(&self, rate: S, balance: &Flow<S>) -> S {
        rate - self.feel_impulse * balance.pressure
    }

    #[inline(always)]
    fn feel_changed(&mut self, from: S, to: S, balance: &Flow<S>) -> S {
        let before = self.feel_impulse;
        self.feel_impulse = before * to / from;
        (before - self.feel_impulse) * balance.pressure
    }

    /// Where the feel receives the load cell directly, it is a motion like the column's, whose `u` knows of the lag.
    #[inline(always)]
    fn feel_force(&self, force: S, now: &RunSnapshot<S, Flow<S>>) -> S {
        force + self.direct * (now.balance.pressure - now.signals[PRESSURE])
    }

    /// At the start of a step: makes good what the lag did in the last one, and shows pressure and flow behind their balance.
    #[inline(always)]
    fn catch_up(
        &self,
        neighbors: &Neighbors<'_, S>,
        effects: &Effects,
        side: &Side<S>,
        state: &mut RunState<S, Oil<S>>,
        now: &mut RunSnapshot<S, Flow<S>>,
    ) {
        let yielding = self.balance.yielding(effects, side, state.slow.plant[1], &now.balance);
        self.catch(effects, &yielding, state, now);
        self.follow(neighbors, effects, (side, &yielding), state, now);
    }
}

impl<S: Scalar> Hydraulic<S> {
    /// Makes good what the pressure's lag behind its slaved value did in the last step.
    #[inline(always)]
    fn catch(
        &self,
        effects: &Effects,
        yielding: &PressureSensitivity<S>,
        state: &mut RunState<S, Oil<S>>,
        now: &mut RunSnapshot<S, Flow<S>>,
    ) {
        let lagging = self.balance.lagging(yielding, now.balance.pressure - state.drive.pressure);
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

    /// Pressure and flow as far as they have come behind their balance up to the start of a step.
    #[inline(always)]
    fn follow(
        &self,
        neighbors: &Neighbors<'_, S>,
        effects: &Effects,
        (side, yielding): (&Side<S>, &PressureSensitivity<S>),
        state: &mut RunState<S, Oil<S>>,
        now: &mut RunSnapshot<S, Flow<S>>,
    ) {
        let [z, q_i, q_i_rate, x_b, _] = state.slow.plant;
        // Up to here there was the force of before.
        let column = neighbors.column;
        let by_link = self.pull(column.per_link_force, &now.balance);
        let mut accelerated = column.acceleration(effects, (by_link, state.pilot_force), (x_b, x_b), now.base_rate);
        if effects.column_friction {
            accelerated = accelerated + state.column.drag;
        }
        let rates = [now.balance.flow * self.per_area, q_i_rate, q_i.zero(), now.base_rate, accelerated];
        let rate = self.balance.slaved_rate(side, yielding, (q_i, &now.balance), &rates);
        let quasi_steady = now.balance.pressure;
        let mut change = quasi_steady - state.drive.pressure;
        if effects.backlash {
            // Where the link met the end of its play the pressure came with a jump, which is no rate.
            change = S::select(self.balance.holds(state.drive.pressure), change, rate * neighbors.step);
        }
        let change = (state.drive.lag, change, rate);
        let mut oil = self.balance.behind(yielding, &now.balance, change, (neighbors.step, neighbors.per_step));
        if effects.backlash {
            let holds = self.balance.holds(quasi_steady);
            oil.pressure = S::select(holds, oil.pressure, quasi_steady);
            oil.flow = S::select(holds, oil.flow, now.balance.flow);
        }
        (now.signals[PRESSURE], now.signals[FLOW]) = (oil.pressure, oil.flow);
        now.position = self.balance.piston(z, oil.pressure);
        now.force = self.balance.area * (oil.pressure - oil.seals);
        (state.drive.pressure, state.drive.lag) = (quasi_steady, quasi_steady - oil.pressure);
    }
}
