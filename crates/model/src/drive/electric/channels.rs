//! Channels of a bench with an electric drive.

use crate::channels;

/// Name and SI unit of each channel of a bench.
pub const CHANNELS: &[(&str, &str)] = &[
    ("column_angle", "rad"),
    ("column_velocity", "rad/s"),
    ("drive_position", "m"),
    ("load_cell_force", "N"),
    ("motor_current", "A"),
    ("motor_voltage", "V"),
    ("motor_speed", "rad/s"),
    ("motor_angle", "rad"),
    ("winding_temperature", "degC"),
];

const _: () = assert!(CHANNELS.len() == channels::COUNT, "as many channels as of a hydraulic drive");
