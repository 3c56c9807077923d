//! Channels of a bench: what is measured of a loader, and what its transducers say.
//!
//! `theta` column angle · `x_p` piston displacement · `F_c` load cell force · `p` load pressure · `q` flow into the actuator ·
//! `i` valve current · `e_P`, `e_F` signals of potentiometer and load cell

use crate::Scalar;
use crate::machine::Now;
use crate::parameters::Parameters;

/// How many channels there are.
pub const COUNT: usize = 9;

/// Name and SI unit of each channel.
pub const CHANNELS: [(&str, &str); COUNT] = [
    ("column_angle", "rad"),
    ("column_velocity", "rad/s"),
    ("piston_position", "m"),
    ("load_cell_force", "N"),
    ("load_pressure", "Pa"),
    ("actuator_flow", "m^3/s"),
    ("valve_current", "A"),
    ("potentiometer", "V"),
    ("load_cell", "V"),
];

/// What the channels show of a loader at one instant.
#[derive(Debug, Clone, Copy)]
pub struct Bench<S> {
    /// Displacement of the column's base in m.
    pub base: S,
    /// Its velocity in m/s.
    pub base_rate: S,
    /// Piston displacement in m.
    pub piston: S,
    /// Load pressure in Pa.
    pub pressure: S,
    /// Flow into the actuator in m³/s.
    pub flow: S,
    /// Valve current in A.
    pub current: S,
}

impl<S: Scalar> Bench<S> {
    /// Of a machine in time.
    #[inline(always)]
    pub fn of(now: &Now<S>) -> Self {
        let &Now { base, base_rate, piston, pressure, flow, current, .. } = now;
        Self { base, base_rate, piston, pressure, flow, current }
    }

    /// The channels, in the order of [`CHANNELS`].
    #[inline(always)]
    pub fn channels(&self, parameters: &Parameters<S>) -> [S; COUNT] {
        let Parameters { actuator, column, load_cell, potentiometer, .. } = parameters;
        let force = actuator.force(self.pressure);
        [
            column.angle(self.base),
            column.angle(self.base_rate),
            self.piston,
            force,
            self.pressure,
            self.flow,
            self.current,
            potentiometer.signal(self.piston),
            load_cell.signal(force),
        ]
    }
}
