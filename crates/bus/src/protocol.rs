//! The kinds of drives: a row each.

use crate::drive::{Codec, Node};
use crate::ethercat::Units;
use crate::ethercat::analog::Analog;
use crate::ethercat::servo_slave::ServoSlave;
use crate::ethercat::terminal::{DriveWithInputs, TerminalPair};
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
    /// CiA 402 over EtherCAT.
    EtherCat,
    /// A valve's amplifier and sensors at analog terminals on EtherCAT.
    Analog,
}

impl Protocol {
    /// All kinds by name.
    pub const ALL: [(&str, Self); 5] = [
        ("moteus", Self::Moteus),
        ("odrive", Self::Odrive(Firmware::Six)),
        ("odrive-0.5", Self::Odrive(Firmware::Five)),
        ("ethercat", Self::EtherCat),
        ("ethercat-analog", Self::Analog),
    ];

    /// Adapter at whose serial port it is; nothing of EtherCAT, which has a network interface.
    pub fn adapter(self) -> Option<Adapter> {
        match self {
            Self::Moteus => Some(Adapter::Fdcanusb),
            Self::Odrive(_) => Some(Adapter::Slcan),
            Self::EtherCat | Self::Analog => None,
        }
    }

    /// Numbers that a node may have.
    pub fn nodes(self) -> RangeInclusive<u8> {
        match self {
            Self::Moteus => 1..=moteus::MOST_NODE,
            Self::Odrive(_) => 0..=odrive::MOST_NODE,
            Self::EtherCat | Self::Analog => 1..=u8::MAX,
        }
    }

    /// The loop's side of a node on CAN with these sensors: load cell, column's encoder, force sensor at the grip.
    pub fn codec(self, node: u8, sensors: [bool; 3]) -> Option<Box<dyn Codec + Send>> {
        match self {
            Self::Moteus => Some(Box::new(Moteus::new(node, sensors))),
            Self::Odrive(firmware) => Some(Box::new(Odrive::new(node, firmware, sensors))),
            Self::EtherCat | Self::Analog => None,
        }
    }

    /// A node that answers as the drive would; of EtherCAT with its units or terminals, the last of its line or not.
    pub fn node(self, number: u8, units: Units, analog: Option<Analog>, last: bool) -> Box<dyn Node + Send> {
        match (self, analog) {
            (Self::Analog, Some(analog)) => Box::new(TerminalPair::new(analog, number, last)),
            (Self::EtherCat, _) => match units.input_node {
                Some(input_node) => Box::new(DriveWithInputs::new(units, number, input_node, last)),
                None => Box::new(ServoSlave::new(units, number, last)),
            },
            _ => self.on_can(number, SERIAL + i32::from(number)),
        }
    }

    /// A second drive on CAN with the number of another: its serial number is its own.
    pub fn twin(self, number: u8) -> Box<dyn Node + Send> {
        self.on_can(number, 2 * SERIAL + i32::from(number))
    }

    fn on_can(self, number: u8, serial: i32) -> Box<dyn Node + Send> {
        match self {
            Self::Odrive(firmware) => Box::new(OdriveNode::new(number, firmware, serial)),
            Self::Moteus | Self::EtherCat | Self::Analog => Box::new(MoteusNode::new(number, serial)),
        }
    }
}

/// Serial number of an emulated drive, less that of its node.
const SERIAL: i32 = 1000;
