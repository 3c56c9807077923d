//! Drives of CiA 402 over EtherCAT, in cyclic synchronous torque, and valves at analog terminals: the loop's side as a master, and slaves
//! that answer as these.
//!
//! | question | file |
//! |---|---|
//! | frames, registers and states, the mailbox, the EEPROM | [`datagram`], [`registers`], [`mailbox`], [`sii`] |
//! | the drive profile | [`cia402`] |
//! | the master: what it asks of a slave, its start, an axis in the cycle | [`station`], [`start`], [`axis`] |
//! | process data of a drive, of terminals | [`servo`], [`analog`] |
//! | the slave: its controller, its states | `controller`, [`slave`] |
//! | the emulated drive and its dictionary, the emulated terminals | [`servo_slave`], `dictionary`, [`terminal`] |
//!
//! Each axis has a frame of its own, so a slave that is gone silences its own axis alone.

pub mod analog;
pub mod axis;
pub mod cia402;
mod controller;
pub mod datagram;
mod dictionary;
pub mod mailbox;
pub mod registers;
pub mod servo;
pub mod servo_slave;
pub mod sii;
pub mod slave;
pub mod start;
pub mod station;
pub mod terminal;

use mailbox::Object;

/// Highest position on the line that a node's number states; those above are aliases.
pub const MOST_POSITION: u8 = 127;

/// Units of a drive that it does not state, and where its sensors are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Units {
    /// Rated torque in N m: the unit of torque is a thousandth of it.
    pub rated_torque: f64,
    /// Counts of the encoder per revolution.
    pub counts: f64,
    /// The same of the column's encoder.
    pub column_counts: f64,
    /// Load cell, column's encoder, force sensor at the grip: an object of its own for each that there is.
    pub sensors: [Option<Object>; 3],
    /// Node of the terminal whose inputs have load cell and force sensor; nothing where the drive has them.
    pub input_node: Option<u8>,
}

impl Units {
    /// Those of a node that has none to state.
    pub const ONE: Self =
        Self { rated_torque: 1.0, counts: 1.0, column_counts: 1.0, sensors: [None; 3], input_node: None };

    /// The object of a sensor at the drive.
    pub(crate) fn own(&self, place: usize) -> Option<Object> {
        if self.is_analog_at_terminal(place) { None } else { self.sensors[place] }
    }

    /// The object of a sensor at the terminal; an encoder is at the drive.
    pub(crate) fn at_terminal(&self, place: usize) -> Option<Object> {
        if self.is_analog_at_terminal(place) { self.sensors[place] } else { None }
    }

    fn is_analog_at_terminal(&self, place: usize) -> bool {
        self.input_node.is_some() && place != ENCODER
    }

    /// A sensor's number of full scale: an analog input has 16 bits, half of its range on each side; an encoder has counts.
    fn sensor(&self, place: usize, raw: i32) -> f64 {
        if place == ENCODER { f64::from(raw) / self.column_counts } else { 0.5 + f64::from(raw) / (2.0 * ANALOG) }
    }

    fn raw(&self, place: usize, sensor: f64) -> i32 {
        nearest(if place == ENCODER { sensor * self.column_counts } else { (2.0 * sensor - 1.0) * ANALOG })
    }
}

/// Place of the column's encoder among the sensors.
const ENCODER: usize = 1;
/// The end of an analog input's range.
const ANALOG: f64 = 32767.0;

/// The nearest whole number; without a standard library. It saturates, and is zero of what is no number.
#[expect(clippy::cast_possible_truncation, reason = "it saturates")]
fn nearest(number: f64) -> i32 {
    (number + if number < 0.0 { -0.5 } else { 0.5 }) as i32
}
