//! The programmed feel alone: the feel computer under the pilot's torque, `T = R_p F_p`, without servo, linkage and column.
//!
//! The torque is held at its middle through each part of a step, so that a force that changes is followed to second order.

use crate::start::Start;
use forcefeel_model::compensator::Compensator;
use forcefeel_model::feel::{FeelConditions, FeelLaw};
use forcefeel_model::feel_computer::{FeelComputer, FeelMotion};
use forcefeel_model::machine::{Inputs, Shared};
use forcefeel_model::parameters::Parameters;
use forcefeel_model::surface::FlightState;

/// Angle in rad at the start of every step and at the end of the last.
///
/// A step is cut into `parts`; of the inputs, force, factor on the spring and what comes beside the feel count. In a flight, which has a
/// state at the start and at the end of each step, the surface's hinge moment does, too.
pub fn feel_alone(
    parameters: &Parameters<f64>,
    shared: &Shared,
    start: Start,
    (inputs, flights): (&[Inputs], &[[FlightState; 2]]),
    parts: usize,
) -> Vec<f64> {
    // Under state feedback the displacement is an angle, and the torque the column's.
    let feel = FeelLaw::new(parameters, &Compensator::state_feedback(parameters, [0.0; 7]));
    let computer =
        FeelComputer { feel: &feel, next: &feel, fade: 0.0, effects: &shared.effects, curve: shared.curve.as_ref() };
    let torque = |force: f64| parameters.column.grip_arm * force;
    let first = inputs.first().map_or(1.0, |step| step.stiffness_factor[0]);
    let (angle, held_until) = match start {
        Start::Held(angle, until) => (angle, until),
        Start::Under(force) => (computer.equilibrium(torque(force), 0.0, first), 0),
    };
    let mut motion = FeelMotion::resting(&feel, angle);
    #[expect(clippy::cast_precision_loss, reason = "a number of parts, far below 2^52")]
    let (h, middle) = (shared.step_s / parts as f64, |part: usize| (part as f64 + 0.5) / parts as f64);
    let mut angles = Vec::with_capacity(inputs.len() + 1);
    angles.push(angle);
    for (step, now) in inputs.iter().enumerate() {
        for part in 0..if step < held_until { 0 } else { parts } {
            let now = flights.get(step).map_or(*now, |flight| parameters.in_flight(now, flight, motion.at[0]));
            let at = |[begin, end]: [f64; 2]| begin + middle(part) * (end - begin);
            let conditions = FeelConditions {
                neutral: 0.0,
                stiffness_factor: at(now.stiffness_factor),
                shaker: 0.0,
                added_force: at(now.added_force),
                added: [at(now.added_stiffness), at(now.added_damping)],
                slider: motion.slider,
                start: motion.at[0],
            };
            computer.run(&mut motion, torque(at(now.force)), &conditions, h);
        }
        angles.push(motion.at[0]);
    }
    angles
}
