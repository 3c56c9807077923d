//! Between which values a law takes its inputs, wherever it is not under a supervisor: exported as C, and in an importer's hands.
//!
//! What lies outside is refused, not cut off: a sensor that shows it is broken, and a host that asks for it is wrong.

use crate::parameters::Parameters;
use crate::transducers::SENSORS;

/// Commanded neutral of the feel in rad.
pub const TRIM: (f64, f64) = (-core::f64::consts::PI, core::f64::consts::PI);

/// Factor on the spring of the feel.
pub const STIFFNESS_FACTOR: (f64, f64) = (0.0, 100.0);

/// Swing of the stick shaker.
pub const SHAKER_SWING: (f64, f64) = (-1.0, 1.0);

/// How far the stick shaker is on.
pub const SHAKER: (f64, f64) = (0.0, 1.0);

/// Force at the grip in N, spring rate in N m/rad and damping in N m s/rad beside the feel's.
pub const ADDED: [(f64, f64); 3] = [(-2000.0, 2000.0), (-1e5, 1e5), (-1e4, 1e4)];

/// Force of a hand at the grip in N: a sensor there measures whatever a hand does.
pub const HAND: (f64, f64) = (-1e5, 1e5);

/// What a loader's sensors can show: load cell in N, position of the drive's end in m, displacement of the column's base in m, force at
/// the grip in N.
pub fn sensed(loader: &Parameters<f64>) -> [(f64, f64); SENSORS] {
    let within = |most: f64| (-most, most);
    let safety = &loader.safety;
    [
        within(safety.force_range),
        within(safety.position_range),
        within(safety.angle_range * loader.column.base_arm),
        HAND,
    ]
}
