//! Channels of a bench: what is measured of a loader with a hydraulic drive, and what its transducers give. Those of an electric one:
//! `drive/electric/plant.rs`.
//!
//! `theta` column angle · `x_p` piston displacement · `F_c` load cell force, without the friction of the seals · `p` load pressure ·
//! `q` flow into the actuator · `i` valve current · `e_P`, `e_F` signals of potentiometer and load cell

use crate::Scalar;
use crate::parameters::Parameters;

/// What the channels show of a loader at one instant.
#[derive(Debug, Clone, Copy)]
pub struct Bench<S> {
    /// Displacement of the column's base in m.
    pub base: S,
    /// Its velocity in m/s.
    pub base_rate: S,
    /// Piston displacement in m.
    pub piston: S,
    /// Force of the load cell in N.
    pub force: S,
    /// Load pressure in Pa.
    pub pressure: S,
    /// Flow into the actuator in m³/s.
    pub flow: S,
    /// Valve current in A.
    pub current: S,
}

/// One row a channel: its name, its SI unit, and what it shows of a [`Bench`] with these [`Parameters`].
macro_rules! channels {
    (|$bench:ident, $parameters:ident| $( $name:literal, $unit:literal: $value:expr; )*) => {
        /// Name and SI unit of each channel.
        pub const CHANNELS: &[(&str, &str)] = &[ $( ($name, $unit), )* ];

        impl<S: Scalar> Bench<S> {
            /// The channels, in the order of [`CHANNELS`].
            #[inline(always)]
            pub fn channels(&self, $parameters: &Parameters<S>) -> [S; COUNT] {
                let $bench = self;
                [ $( $value, )* ]
            }
        }
    };
}

channels! { |bench, parameters|
    "column_angle", "rad": parameters.column.angle(bench.base);
    "column_velocity", "rad/s": parameters.column.angle(bench.base_rate);
    "piston_position", "m": bench.piston;
    "load_cell_force", "N": bench.force;
    "load_pressure", "Pa": bench.pressure;
    "actuator_flow", "m^3/s": bench.flow;
    "valve_current", "A": bench.current;
    "potentiometer", "V": parameters.potentiometer.signal(bench.piston);
    "load_cell", "V": parameters.load_cell.signal(bench.force);
}

/// How many channels there are, of either drive.
pub const COUNT: usize = CHANNELS.len();
