//! Linkage between piston and column: rigid, eq. (8), or compliant, eqs. (9)-(10).
//!
//! `alpha` linkage ratio · `k`, `c` spring rate and damping of the link · `x_p` piston displacement · `x_b` displacement of
//! the column's base · `F_c` load cell force
//!
//! State of the compliant linkage: `x_p`; the piston has no mass, so its velocity follows from the force on the link.

use crate::Scalar;
use crate::parameters::{Column, Linkage};

impl<S: Scalar> Linkage<S> {
    /// Displacement of the piston, in m, when the link does not stretch; holds for velocities and accelerations too.
    #[inline(always)]
    pub fn rigid_piston(&self, x_b: S) -> S {
        // x_p = alpha x_b                                                                  geometry behind eq. (8)
        self.ratio * x_b
    }

    /// Displacement of the column's base, in m, when the link does not stretch.
    #[inline(always)]
    pub fn rigid_base(&self, x_p: S) -> S {
        // x_b = x_p / alpha                                                                geometry behind eq. (8)
        x_p / self.ratio
    }

    /// Velocity of the piston, in m/s, under the link's force `f_c`.
    #[inline(always)]
    pub fn piston_velocity(&self, f_c: S, x_p: S, x_b: S, x_b_rate: S) -> S {
        // F_c = k (x_p - alpha x_b) + c (x_p' - alpha x_b'), solved for x_p'                           eqs. (9), (10)
        (f_c - self.stiffness * (x_p - self.ratio * x_b)) / self.damping + self.ratio * x_b_rate
    }

    /// Force of the link on the column's base, in N.
    #[inline(always)]
    pub fn base_force(&self, f_c: S) -> S {
        // alpha F_c: the bellcrank's lever                                                             eq. (6), second term
        self.ratio * f_c
    }

    /// Travel of the drive's end per travel of the grip, `alpha R_b / R_p`, of a link that does not stretch; so also force at the grip
    /// per force of the drive.
    #[inline(always)]
    pub fn per_grip(&self, column: &Column<S>) -> S {
        self.rigid_piston(column.base_arm) / column.grip_arm
    }

    /// Spring rate and damping `(k, c)` of a link on which the column swings at `w` rad/s with damping ratio `zeta` while
    /// the piston stands still.
    #[inline(always)]
    pub fn from_resonance(ratio: S, column: &Column<S>, w: S, zeta: S) -> (S, S) {
        let lever = ratio * column.base_arm;
        // J theta'' + (alpha R_b)^2 (c theta' + k theta) = 0                    eqs. (6), (9) with x_p = 0
        let mass = column.inertia / (lever * lever);
        (mass * w * w, zeta.times(2.0) * w * mass)
    }
}
