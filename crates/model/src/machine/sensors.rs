//! What sensors measure and show in a step under the analog law, and what the feel computer receives of it.

use super::step::Stage;
use super::{Machine, Snapshot, State};
use crate::Scalar;
use crate::drive::Drive;
use crate::effects::Effects;
use crate::run::{Inputs, StepFraction};
use crate::transducers::SENSORS;

impl<S: Scalar, D: Drive<S>> Machine<S, D> {
    #[inline(always)]
    pub(super) fn measured(now: &Snapshot<S, D>) -> [S; SENSORS] {
        [now.force, now.position, now.base, now.force.zero()]
    }

    /// The same with the force at the grip, of which only a digital controller receives.
    #[inline(always)]
    pub(super) fn measured_at_grip(
        &self,
        effects: &Effects,
        state: &State<S, D>,
        inputs: &Inputs,
        now: &Snapshot<S, D>,
    ) -> [S; SENSORS] {
        let mut measured = Self::measured(now);
        if effects.grip_sensor {
            let mut a = self.column.per_link_force * now.force
                + self.column.per_pilot_force * now.pilot_force
                + self.column.loads(effects, now.base, now.base, now.base_rate);
            if effects.linked {
                a = a + self.column.per_torque.times(inputs.link_torque[0]);
            }
            if effects.column_friction {
                // What it did in the last step, as this one's is not settled yet.
                a = S::select(state.column.stuck, a.zero(), a + state.column.drag);
            }
            measured[3] = self.grip.shown(now.pilot_force, [now.base, now.base_rate, a]);
        }
        measured
    }

    /// What the sensors show under the analog law.
    #[inline(always)]
    pub(super) fn shown(&self, stage: &Stage<'_, S, D>, now: &Snapshot<S, D>) -> ([S; SENSORS], S) {
        let effects = &stage.shared.effects;
        let mut shown = Self::measured(now);
        let mut base_rate = now.base_rate;
        if effects.lags {
            shown = match stage.moment {
                StepFraction::Start => stage.state.seen.shown,
                StepFraction::Half => self.transducers.after_half(&stage.state.seen, shown),
                StepFraction::End => self.transducers.after_whole(&stage.state.seen, shown, now.base.zero()),
            };
            base_rate = self.transducers.column_rate(now.base, base_rate, shown[2]);
        }
        if effects.offsets {
            let offset = &self.transducers.offset;
            shown = [shown[0] + offset[0], shown[1] + offset[1], shown[2] + offset[2], shown[3]];
        }
        (shown, base_rate)
    }

    /// Torque that an analog feel computer receives where the load cell shows `force`.
    #[inline(always)]
    pub(super) fn received_torque(&self, force: S, now: &Snapshot<S, D>) -> S {
        self.control.law.feel_torque(self.drive.feel_force(force, now))
    }
}
