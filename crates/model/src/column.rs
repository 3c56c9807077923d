//! Control column: eqs. (6), (7), (16), (18).
//!
//! `J` inertia · `R_b`, `R_p` lever arms of base and grip · `F_p` pilot force · `x_b` displacement of the base ·
//! `theta` angle of the column
//!
//! States of the compliant model: `x_b` and its rate.

use crate::Scalar;
use crate::parameters::Column;

impl<S: Scalar> Column<S> {
    /// Acceleration of the column's base in m/s², from the linkage's force on the base and the pilot's on the grip, in N.
    #[inline(always)]
    pub fn base_acceleration(&self, base_force: S, pilot_force: S) -> S {
        // J theta'' = R_p F_p + R_b (alpha A p), theta = x_b / R_b                                     eqs. (6), (7)
        (self.grip_arm * pilot_force + self.base_arm * base_force) * self.base_arm / self.inertia
    }

    /// Angle of the column in rad (small motions).
    #[inline(always)]
    pub fn angle(&self, x_b: S) -> S {
        // theta = x_b / R_b                                                                           eqs. (16), (18)
        x_b / self.base_arm
    }

    /// Torque of the pilot's force about the pivot in N m.
    #[inline(always)]
    pub fn pilot_torque(&self, pilot_force: S) -> S {
        // R_p F_p                                                                               eq. (6), first term
        self.grip_arm * pilot_force
    }
}
