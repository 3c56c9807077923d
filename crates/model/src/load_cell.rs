//! Load cell: what the feel computer receives of the pilot, the right-hand side of eq. (12).
//!
//! `K_1` transducer gain · `F_c` load cell force · `e_F` its signal · `G_max` scale of the computer
//!
//! Sign. A pilot who pushes with `+F_p` loads the link with `F_c = -R_p F_p / (alpha R_b)` at rest, eq. (6). Eq. (12) as
//! printed drives the computer with `+G_max K_1 A p`, against the pilot: the column would move towards him and run away.
//! The signal is therefore taken with the sign of the pilot's torque; the printed sign is a negative `K_1`.

use crate::Scalar;
use crate::parameters::LoadCell;

impl<S: Scalar> LoadCell<S> {
    /// Signal of the load cell circuit in V, positive when the pilot pushes.
    #[inline(always)]
    pub fn signal(&self, f_c: S) -> S {
        // e_F = -K_1 A p                                                                       eq. (12), sign see above
        -self.gain * f_c
    }
}
