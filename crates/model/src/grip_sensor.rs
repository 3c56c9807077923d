//! Force sensor at the grip, between the hand and the column.
//!
//! `F_p` pilot force · `F_g` force that the sensor shows · `m_o` mass outboard of it · `m_a`, `d_a`, `k_a` the arm's mass, damping and
//! spring rate at the grip · `theta` angle of the column · `R_p` lever arm of the grip · `K_g` its gain
//!
//! The column's inertia `J` includes `m_o R_p^2`: it is that of the column as it is built. What moves arm and grip does not reach the
//! sensor:
//!
//! `F_g = K_g (F_p - (m_a + m_o) R_p theta'' - d_a R_p theta' - k_a R_p theta)`
//!
//! Dry friction, inertia and drive of the column lie inboard of it, so it sees past them. The weight outboard is left out: gravity
//! acts on the column as a whole.

use crate::Scalar;
use crate::parameters::Parameters;

/// The sensor of one loader; zeros where there is none.
#[derive(Debug, Clone, Copy)]
pub struct GripForce<S> {
    gain: S,
    /// Per acceleration, velocity and displacement of the base.
    mass: S,
    damping: S,
    /// See [`GripForce::mass`].
    pub spring: S,
}

impl<S: Scalar> GripForce<S> {
    /// The sensor of a loader.
    #[inline(always)]
    pub fn new(parameters: &Parameters<S>) -> Self {
        let Parameters { column, pilot, grip_sensor, .. } = parameters;
        let lever = column.grip_arm / column.base_arm;
        Self {
            gain: grip_sensor.gain,
            mass: (pilot.arm_mass + grip_sensor.mass) * lever,
            damping: pilot.arm_damping * lever,
            spring: pilot.arm_stiffness * lever,
        }
    }

    /// Force of the hand on the grip: the pilot's, and what the arm's damping and spring add.
    #[inline(always)]
    pub fn hand(&self, pilot_force: S, [x_b, v]: [S; 2]) -> S {
        pilot_force - self.damping * v - self.spring * x_b
    }

    /// What it shows of a pilot force while the base moves so: displacement, velocity, acceleration.
    #[inline(always)]
    pub fn shown(&self, pilot_force: S, [x_b, v, a]: [S; 3]) -> S {
        self.gain * (pilot_force - self.mass * a - self.damping * v - self.spring * x_b)
    }
}
