//! What a slope asks of a loader.

use forcefeel_model::Scalar;
use forcefeel_model::parameters::Parameters;

/// Sensors and converters that do not round: a staircase has no slope.
pub fn without_steps<T: Scalar>(mut parameters: Parameters<T>) -> Parameters<T> {
    let none = parameters.column.inertia.zero();
    let Parameters { load_cell, potentiometer, column_sensor, grip_sensor, controller, .. } = &mut parameters;
    let of_load_cell = [&mut load_cell.resolution, &mut potentiometer.resolution];
    for resolution in of_load_cell.into_iter().chain([&mut column_sensor.resolution, &mut grip_sensor.resolution]) {
        *resolution = none;
    }
    (controller.input_bits, controller.output_bits) = (none, none);
    parameters
}
