//! What is around the column of a case beside a hand that pushes: an arm, a clamp, an end stop close by.

use crate::case::{ARMS, Case};
use core::f64::consts::FRAC_PI_2;
use forcefeel_model::parameters::Parameters;

/// What holds or stops the column of a case.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Environment {
    /// Nothing.
    Free,
    /// A hand that holds it with an arm.
    Arm,
    /// A clamp at the grip.
    Clamp,
    /// An end stop of the loader, close by, which the hand pushes into.
    Stop,
}

impl Environment {
    const ALL: [Self; 6] = [Self::Free, Self::Free, Self::Free, Self::Arm, Self::Clamp, Self::Stop];
}

/// Stiffness in N/m at the grip of what holds a column or stops it, its damping ratio, and the mass in kg that a clamp adds, as those by which the
/// envelope judges a law.
const CLAMPS: (f64, f64) = (1e3, 1e6);
/// See [`CLAMPS`].
const END_STOPS: (f64, f64) = (1e4, 1e6);
/// See [`CLAMPS`].
const DAMPING_RATIOS: (f64, f64) = (0.02, 0.5);
/// See [`CLAMPS`].
const CLAMPED_KG: (f64, f64) = (0.0, 3.0);
/// How far a hand moves a clamped column at most, in rad.
const CLAMPED_RAD: f64 = 0.1;
/// Where an end stop is, in rad.
const STOP_RAD: (f64, f64) = (0.0, 0.1);

impl Case {
    /// The same, half of them with something that holds or stops the column.
    #[must_use]
    pub fn in_environment(mut self) -> Self {
        let mut draw = || self.noise.uniform();
        let mut between = |(low, high): (f64, f64)| low + (high - low) * draw();
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small number above zero")]
        let mut choose = |count: u8| between((0.0, f64::from(count))) as usize;
        let there = Environment::ALL[choose(6).min(5)];
        // What is the hand's own fault comes back from a clamp.
        let by_hand = self.faults.iter().any(|fault| fault.kind.is_of_hand());
        let there = if by_hand && there == Environment::Clamp { Environment::Free } else { there };
        let arm = ARMS[choose(3).min(2)];
        let mut decades = |(low, high): (f64, f64)| low * (high / low).powf(between((0.0, 1.0)));
        let ratio = decades(DAMPING_RATIOS);
        let mut parameters = Parameters::from_values(&self.values);
        let grip_arm = parameters.column.grip_arm;
        let own = parameters.column.inertia / (grip_arm * grip_arm);
        let damping = |stiffness: f64, mass: f64| 2.0 * ratio * (stiffness * mass).sqrt();
        let pilot = &mut parameters.pilot;
        let mut most = f64::INFINITY;
        match there {
            Environment::Free => {}
            Environment::Arm => [pilot.arm_mass, pilot.arm_damping, pilot.arm_stiffness] = arm,
            Environment::Clamp => {
                let stiffness = decades(CLAMPS);
                let mass = between(CLAMPED_KG);
                [pilot.arm_mass, pilot.arm_damping, pilot.arm_stiffness] =
                    [mass, damping(stiffness, own + mass), stiffness];
                // Where it does not pull.
                (self.angle, self.clamped) = (0.0, true);
                most = CLAMPED_RAD * stiffness * grip_arm;
            }
            Environment::Stop => {
                let stiffness = decades(END_STOPS);
                let column = &mut parameters.column;
                column.stop_high = between(STOP_RAD);
                self.angle = self.angle.min(column.stop_high);
                column.stop_stiffness = stiffness * grip_arm * grip_arm;
                column.stop_damping = damping(stiffness, own) * grip_arm * grip_arm;
                (self.hand.frequency, self.hand.phase) = (0.0, FRAC_PI_2);
                most = 0.5 * parameters.safety.travel_margin * stiffness * grip_arm;
            }
        }
        self.hand.force = self.hand.force.clamp(-most, most);
        self.values = parameters.values();
        self
    }
}
