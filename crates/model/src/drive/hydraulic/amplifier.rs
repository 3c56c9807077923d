//! Servo amplifier: wide-band, so a constant (page of eq. (1)).
//!
//! `K_2` admittance · `e` amplifier input · `i` valve current

use crate::Scalar;
use crate::parameters::Amplifier;

impl<S: Scalar> Amplifier<S> {
    /// Valve current `i` in A from the amplifier's input `e` in V.
    #[inline(always)]
    pub fn current(&self, e: S) -> S {
        // i = K_2 e                                                                   eq. (13), right-hand factor
        self.admittance * e
    }
}
