//! A hand at the grip of a simulated loader.
//!
//! `F` force of a hand that holds the grip at the angle `theta_h` · `K` its stiffness, as a torque · `C` its damping · `R_p` arm of the grip
//!
//! `R_p F = K (theta_h - theta) + K / t_i int (theta_h - theta) dt - C theta'`, within `R_p` times 400 N: an arm, and a person who looks.
//! A hand that pushes takes 0.05 s for each 400 N of a change, and lets go at once.

use crate::Scalar;
use crate::parameters::Parameters;

/// The hand at the grip.
#[derive(Debug, Clone, Copy)]
pub struct Hand {
    /// Force in N to which it pushes, and to which it has come.
    pushes: f64,
    pushed: f64,
    angle: Option<f64>,
    force: f64,
    integral: f64,
    stiffness: f64,
    damping: f64,
    arm: f64,
}

impl Hand {
    /// `t_i` in s.
    const INTEGRATES_S: f64 = 0.15;
    /// Most force of an arm in N.
    const MOST_N: f64 = 400.0;
    /// Time in s in which a hand comes to that force.
    const TAKES_HOLD_S: f64 = 0.05;
    /// Stiffness of an arm that holds tight, in N/m.
    const ARM_N_PER_M: f64 = 1000.0;
    /// Damping ratio of arm and column together.
    const DAMPING: f64 = 0.7;

    /// The hand for a loader, away from its grip.
    pub fn of(parameters: &Parameters<f64>) -> Self {
        let arm = parameters.column.grip_arm;
        let stiffness = 2.0 * parameters.feel.stiffness + Self::ARM_N_PER_M * arm * arm;
        let inertia = parameters.feel.inertia.max(parameters.column.inertia);
        let damping = 2.0 * Self::DAMPING * Scalar::sqrt(stiffness * inertia);
        Self { pushes: 0.0, pushed: 0.0, angle: None, force: 0.0, integral: 0.0, stiffness, damping, arm }
    }

    /// Whether it is at the grip.
    pub fn is_there(&self) -> bool {
        self.pushes != 0.0 || self.angle.is_some() || self.force != 0.0
    }

    /// Pushes with this force in N from now on; lets go at zero.
    pub fn push(&mut self, force: f64) {
        self.pushes = force;
    }

    /// Force in N through the next step.
    pub fn force(&self) -> f64 {
        self.force
    }

    /// Holds the grip at this angle in rad; lets go at none.
    pub fn take_to(&mut self, angle: Option<f64>) {
        (self.angle, self.integral) = (angle, if self.angle.is_some() { self.integral } else { 0.0 });
    }

    /// Works out the force of the next step from where the column is.
    pub fn see(&mut self, angle: f64, rate: f64, step_s: f64) {
        let holds = self.angle.map_or(0.0, |wanted| {
            let off = wanted - angle;
            let most = Self::MOST_N * self.arm;
            self.integral = (self.integral + self.stiffness * off * step_s / Self::INTEGRATES_S).clamp(-most, most);
            (self.stiffness * off + self.integral - self.damping * rate).clamp(-most, most) / self.arm
        });
        let most = Self::MOST_N * step_s / Self::TAKES_HOLD_S;
        let lets_go = self.pushes == 0.0;
        self.pushed = if lets_go { 0.0 } else { self.pushed + (self.pushes - self.pushed).clamp(-most, most) };
        self.force = self.pushed + holds;
    }
}
