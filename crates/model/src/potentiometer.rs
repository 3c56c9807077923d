//! Potentiometer at the piston: the position feedback of eq. (13).
//!
//! `K_3` gain · `x_p` piston displacement · `e_P` signal

use crate::Scalar;
use crate::parameters::Potentiometer;

impl<S: Scalar> Potentiometer<S> {
    /// Signal of the potentiometer circuit in V.
    #[inline(always)]
    pub fn signal(&self, x_p: S) -> S {
        // e_P = K_3 x_p                                                                             eq. (13)
        self.gain * x_p
    }
}
