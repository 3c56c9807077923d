//! Drives on a bus: what a cycle of a live loop writes to a drive's node, and how the node's answer reads.
//!
//! | question | file |
//! |---|---|
//! | what every bus has: a cycle's command, an answer, both sides of a protocol; the kinds | [`drive`], [`protocol`] |
//! | what a drive may complain of, by name | [`fault`] |
//! | a CAN frame, and the lines of a serial adapter that carry it | [`frame`], [`line`] |
//! | what a cycle takes of the bus, frame by frame | [`load`] |
//! | revolutions and torque of a drive in the loader's units, and back | [`scale`] |
//! | moteus, ODrive: the loop's side, and a node that answers as one | [`moteus`], [`moteus_node`], [`odrive`], [`odrive_node`] |
//! | CiA 402 over EtherCAT: the loop's side, and a slave that answers as a drive | [`ethercat`] |
//!
//! A new kind of CAN is a codec with its node here, and a row in [`protocol::Protocol`].
#![no_std]
#![forbid(unsafe_code)]

extern crate alloc;

pub mod drive;
pub mod ethercat;
pub mod fault;
pub mod frame;
pub mod line;
pub mod load;
pub mod moteus;
pub mod moteus_node;
pub mod odrive;
pub mod odrive_node;
pub mod protocol;
pub mod scale;
