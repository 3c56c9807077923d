//! What there is at one instant.

use super::{Machine, Snapshot, State};
use crate::Scalar;
use crate::drive::{self, Drive};
use crate::effects::Effects;
use crate::run::Slow;

impl<S: Scalar, D: Drive<S>> Machine<S, D> {
    /// What follows from the slow states: the drive in balance, velocities and forces, and what sensors measure of a drive that is
    /// behind its balance, by what the last step `left`.
    #[inline(always)]
    pub(super) fn look(
        &self,
        effects: &Effects,
        side: &D::Side,
        slow: &Slow<S>,
        state: &State<S, D>,
        (pilot_force, left): (S, S),
    ) -> Snapshot<S, D> {
        let [.., x_b, w] = slow.plant;
        let [delta, u] = slow.feel;
        let balance = self.drive.balance(effects, side, self.drive.touches(&state.slow.plant), &slow.plant);
        let moving = self.drive.base_velocity(w, &balance);
        let base_rate = if effects.column_friction { S::select(state.column.stuck, w.zero(), moving) } else { moving };
        let delta_rate = if effects.sampled {
            u
        } else {
            let rate = self.drive.feel_velocity(u, &balance);
            if effects.feel_friction { S::select(state.feel.stuck, u.zero(), rate) } else { rate }
        };
        let drive::DriveSignals { position, force, signals } = self.drive.signals(&slow.plant, &balance, left);
        Snapshot::<S, D> { base: x_b, base_rate, delta, delta_rate, position, force, signals, pilot_force, balance }
    }
}
