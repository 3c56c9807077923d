//! Actuator: flow continuity, eq. (5), without leakage past the piston.
//!
//! `A` piston area · `V_E` effective oil volume · `beta` bulk modulus · `x_p` piston displacement · `p` load pressure ·
//! `q` flow into the actuator
//!
//! State: `p`.

use crate::Scalar;
use crate::parameters::Actuator;

impl<S: Scalar> Actuator<S> {
    /// Rate of the load pressure in Pa/s.
    #[inline(always)]
    pub fn pressure_rate(&self, q: S, x_p_rate: S) -> S {
        // q = A x_p' + (V_E / 4 beta) p', solved for p'                                                    eq. (5)
        self.bulk_modulus.times(4.0) / self.oil_volume * (q - self.swept(x_p_rate))
    }

    /// Flow in m³/s that a piston of the velocity `x_p_rate` sweeps.
    #[inline(always)]
    pub fn swept(&self, x_p_rate: S) -> S {
        self.area * x_p_rate
    }

    /// Force of the oil on the piston in N, which is also the load cell's force: the piston's mass is neglected.
    #[inline(always)]
    pub fn force(&self, p: S) -> S {
        // F_c = A p                                                                               eq. (9), left part
        self.area * p
    }
}
