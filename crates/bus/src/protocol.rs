//! The kinds of drives: a row each.

use crate::drive::{Codec, Node};
use crate::line::Adapter;
use crate::moteus::{self, Moteus};
use crate::moteus_node::MoteusNode;
use crate::odrive::{self, Firmware, Odrive};
use crate::odrive_node::OdriveNode;
use alloc::boxed::Box;
use core::ops::RangeInclusive;

/// Kinds of drives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Protocol {
    /// moteus over CAN FD.
    Moteus,
    /// ODrive by CANSimple.
    Odrive(Firmware),
}

impl Protocol {
    /// All kinds by name.
    pub const ALL: [(&str, Self); 3] = [
        ("moteus", Self::Moteus),
        ("odrive", Self::Odrive(Firmware::Six)),
        ("odrive-0.5", Self::Odrive(Firmware::Five)),
    ];

    /// Adapter at whose serial port it is.
    pub fn adapter(self) -> Adapter {
        match self {
            Self::Moteus => Adapter::Fdcanusb,
            Self::Odrive(_) => Adapter::Slcan,
        }
    }

    /// Numbers that a node may have.
    pub fn nodes(self) -> RangeInclusive<u8> {
        match self {
            Self::Moteus => 1..=moteus::MOST_NODE,
            Self::Odrive(_) => 0..=odrive::MOST_NODE,
        }
    }

    /// The loop's side of a node with these sensors: load cell, column's encoder, force sensor at the grip.
    pub fn codec(self, node: u8, sensors: [bool; 3]) -> Box<dyn Codec + Send> {
        match self {
            Self::Moteus => Box::new(Moteus::new(node, sensors)),
            Self::Odrive(firmware) => Box::new(Odrive::new(node, firmware, sensors)),
        }
    }

    /// A node that answers as the drive would.
    pub fn node(self, number: u8) -> Box<dyn Node + Send> {
        match self {
            Self::Moteus => Box::new(MoteusNode::new(number, SERIAL + i32::from(number))),
            Self::Odrive(firmware) => Box::new(OdriveNode::new(number, firmware)),
        }
    }
}

/// Serial number of an emulated drive, less that of its node.
const SERIAL: i32 = 1000;
