//! What there was half-way through a step, from what there is at its start and at the next one's.

use super::{Machine, Shared, Snapshot, StepStart};
use crate::Scalar;
use crate::drive::{self, Drive};
use crate::run::{Inputs, StepFraction};
use crate::run::{Slow, cubic};

impl<S: Scalar, D: Drive<S>> Machine<S, D> {
    /// Displacement of the base half-way between the starts of two steps.
    #[inline(always)]
    pub fn middle_base(&self, before: &StepStart<S, D>, after: &StepStart<S, D>) -> S {
        let (a, b) = (&before.now, &after.now);
        cubic((a.base, a.base_rate), (b.base, b.base_rate), self.step.times(0.125))
    }

    /// What there was half-way between the starts of two steps: of the third order where nothing was switched between them.
    #[inline(always)]
    pub fn middle(
        &self,
        shared: &Shared,
        inputs: &Inputs,
        before: &StepStart<S, D>,
        after: &StepStart<S, D>,
    ) -> Snapshot<S, D> {
        let (a, b) = (&before.now, &after.now);
        let eighth = self.step.times(0.125);
        // The rate of the same cubic.
        let rate = |x_0: S, x_1: S, rate_0: S, rate_1: S| {
            ((x_1 - x_0) * self.per_step).times(1.5) - (rate_0 + rate_1).times(0.25)
        };
        let slow = Slow::middle((&before.slow, &before.rates), (&after.slow, &after.rates), self.step);
        let touches = self.drive.touches(&before.slow.plant) | self.drive.touches(&after.slow.plant);
        let balance = self.drive.balance(&shared.effects, &before.side, touches, &slow.plant);
        let digital = shared.timing.is_some();
        let seen = self.drive.signals_between(&slow.plant, &balance, [a, b], digital);
        let drive::DriveSignals { position, force: on_load_cell, signals } = seen;
        let force = StepFraction::Half.of(inputs.force) - inputs.force[0];
        Snapshot::<S, D> {
            base: self.middle_base(before, after),
            base_rate: rate(a.base, b.base, a.base_rate, b.base_rate),
            delta: if digital { a.delta } else { cubic((a.delta, a.delta_rate), (b.delta, b.delta_rate), eighth) },
            delta_rate: if digital { a.delta_rate } else { rate(a.delta, b.delta, a.delta_rate, b.delta_rate) },
            position,
            force: on_load_cell,
            signals,
            pilot_force: a.pilot_force + self.force(force),
            balance,
        }
    }
}
