//! Feel computer: the programmed control, eqs. (11)-(12).
//!
//! `I`, `B`, `G` programmed inertia, damping, stiffness · `G_max` scale · `delta` programmed displacement · `T` torque
//!
//! States: `delta` and its rate. The unit of `delta` follows from the torque that drives it: N m gives rad, and N m V/rad,
//! the scaled torque of the analog computer, gives V.

use crate::Scalar;
use crate::parameters::Feel;

impl<S: Scalar> Feel<S> {
    /// Acceleration of the programmed displacement under the torque `torque`.
    #[inline(always)]
    pub fn acceleration(&self, delta: S, delta_rate: S, torque: S) -> S {
        // I delta'' + B delta' + G delta = T                                                          eq. (11)
        (torque - self.damping * delta_rate - self.stiffness * delta) / self.inertia
    }

    /// Scaled torque of the analog computer from the load cell's signal `e_f` in V.
    #[inline(always)]
    pub fn analog_torque(&self, e_f: S) -> S {
        // T = G_max e_F                                                                               eq. (12)
        self.maximum_stiffness * e_f
    }

    /// Inertia and damping `(I, B)` of a control of natural frequency `w` in rad/s, damping ratio `zeta` and stiffness `g`.
    #[inline(always)]
    pub fn from_frequency(w: S, zeta: S, g: S) -> (S, S) {
        // w^2 = G / I, 2 zeta w = B / I                                                               eq. (11)
        let inertia = g / (w * w);
        (inertia, zeta.times(2.0) * w * inertia)
    }

    /// Natural frequency in rad/s and damping ratio of the programmed control.
    #[inline(always)]
    pub fn frequency(&self) -> (S, S) {
        // w = sqrt(G / I), zeta = B / (2 I w)                                                         eq. (11)
        let w = (self.stiffness / self.inertia).sqrt();
        (w, self.damping / (self.inertia.times(2.0) * w))
    }
}
