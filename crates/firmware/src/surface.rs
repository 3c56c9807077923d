//! What the hinge moment of a setting's surface adds to the feel in a flight.

use crate::loader::Setting;
use forcefeel_model::Scalar;
use forcefeel_model::surface::{Added, FLIGHT, FlightState};

/// Numbers of a flight: those of [`FLIGHT`], and the angle of the control in rad.
pub const FLOWN: usize = FLIGHT.len() + 1;

/// Force at the grip in N, spring in N m/rad and damping in N m s/rad; nothing where a number is none.
pub fn hinge_moment<S: Scalar>(setting: &Setting, flown: &[S; FLOWN]) -> Option<[S; 3]> {
    let [.., angle] = *flown;
    let flight = FlightState::from_numbers(core::array::from_fn(|k| flown[k]));
    let Added { force, stiffness, damping } = setting.parameters(angle).hinge_moment(&flight, angle);
    let added = [force, stiffness, damping];
    let number = |of: &S| S::any(of.abs().less(of.constant(f64::INFINITY)));
    (flown.iter().all(number) && added.iter().all(number)).then_some(added)
}
