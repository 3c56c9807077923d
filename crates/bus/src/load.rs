//! What a cycle takes of its bus: each frame of command and answer, with its bits and its time.
//!
//! `n` bytes of data; `h` bits before them, 19 of a frame of CAN with 11 bits of identifier, 39 with 29, of CAN FD 17 and 36
//!
//! | frame | bits, with the most stuffing (ISO 11898-1) |
//! |---|---|
//! | CAN | `h + 8 n + 15 + floor((h + 8 n + 14) / 4) + 13`, at 1 Mbit/s |
//! | CAN FD | `h + floor((h - 1) / 4) + 13` at 1 Mbit/s, the rest at 5 Mbit/s: `8 n + 5`, `floor((h + 8 n + 4) / 4)` of both parts, and 27 up to 16 bytes, else 32 |
//! | EtherCAT | `8 (n + 24)` with preamble, check sum and gap, 60 bytes at least, at 100 Mbit/s |
//!
//! The frames are those of the codec, the answers those of the node that is emulated.

use crate::drive::{Ask, Shown};
use crate::ethercat::Units;
use crate::ethercat::analog::{Analog, Terminals};
use crate::ethercat::axis::{Axis, ProcessData};
use crate::ethercat::servo::{Layout, Servo, TerminalInputs};
use crate::frame::Frame;
use crate::protocol::Protocol;
use alloc::boxed::Box;
use alloc::vec;
use alloc::vec::Vec;

/// Bits per second: of classic CAN and the arbitration of CAN FD, of its data, of Ethernet.
const NOMINAL: f64 = 1e6;
const FAST: f64 = 5e6;
const ETHERNET: f64 = 1e8;
/// Bits behind the check sum of a frame of CAN, with the space to the next.
const TAIL: u32 = 13;
/// Bytes of Ethernet beside a frame: preamble, check sum, gap.
const AROUND: usize = 24;
/// Time in s that a frame of EtherCAT takes through a slave, there and back.
const SLAVE_S: f64 = 1e-6;
/// Period of a heartbeat in s, as the guide has it set.
const HEARTBEAT_S: f64 = 0.01;
/// Bytes of the sensors of a drive on EtherCAT, and of a terminal of four outputs and of four inputs with a status each.
const SENSORS: [usize; 3] = [2, 4, 2];
const TERMINAL: [u16; 2] = [8, 16];

/// A frame on the bus.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameLoad {
    /// What it is.
    pub name: &'static str,
    /// Its data, of Ethernet the whole frame.
    pub bytes: usize,
    /// Bits on the wire.
    pub bits: u32,
    /// Time that they take in s.
    pub time_s: f64,
    /// Period in which it comes in s; nothing of one that comes in each cycle.
    pub every_s: Option<f64>,
}

/// The frames of a cycle of a node with these sensors: load cell, column's encoder, force sensor at the grip.
pub fn of_cycle(
    protocol: Protocol,
    node: u8,
    sensors: [bool; 3],
    units: &Units,
    analog: Option<&Analog>,
) -> Vec<FrameLoad> {
    let ask = |cycle| Ask { cycle, torque: 1.0, enable: true, watchdog_s: 0.1 };
    let Some(mut codec) = protocol.codec(node, sensors) else {
        let mut axis = axis(units, analog);
        let bytes = axis.ask(&ask(1)).sent().len();
        let bits = bits(8 * (bytes + AROUND));
        let frame = FrameLoad { name: "frame", bytes, bits, time_s: f64::from(bits) / ETHERNET, every_s: None };
        let slaves = f64::from(axis.count());
        return vec![frame, FrameLoad { name: "slave", bytes: 0, bits: 0, time_s: SLAVE_S * slaves, every_s: None }];
    };
    let mut other = protocol.node(node, *units, analog.copied(), true);
    // What enables comes once.
    codec.ask(&ask(0), &mut |_| ());
    let mut frames = vec![];
    codec.ask(&ask(1), &mut |frame| {
        frames.push(of_can(if frame.remote { "request" } else { "command" }, frame));
        other.take(frame, &Shown::default(), 0.0, &mut |answer| frames.push(of_can("answer", answer)));
    });
    other.tick(0.0, &mut |beat| frames.push(FrameLoad { every_s: Some(HEARTBEAT_S), ..of_can("heartbeat", beat) }));
    frames
}

/// An axis on EtherCAT.
fn axis(units: &Units, analog: Option<&Analog>) -> Axis {
    let sizes = [0, 1, 2].map(|place| if units.own(place).is_some() { SENSORS[place] } else { 0 });
    let terminal = units.input_node.map(|_| TerminalInputs { bytes: TERMINAL[1], places: [None; 3] });
    let data: Box<dyn ProcessData> = match analog {
        Some(_) => Box::new(Terminals::with_sizes(TERMINAL)),
        None => Box::new(Servo::new(*units, Layout { sensors: sizes, error_code: true }).with(terminal)),
    };
    let second = (analog.is_some() || terminal.is_some()).then_some(2);
    Axis::new([Some(1), second], 0, data, analog.is_none().then_some(1))
}

fn of_can(name: &'static str, frame: &Frame) -> FrameLoad {
    let bytes = frame.data().len();
    let data = bits(8 * bytes);
    let (nominal, fast) = if frame.fd {
        let head = if frame.extended { 36 } else { 17 };
        let in_head = (head - 1) / 4;
        let stuffed = (head + data + 4) / 4 - in_head;
        // Count of stuffed bits and check sum, with a bit before them and one behind each four.
        let sum = if bytes > 16 { 32 } else { 27 };
        (head + in_head + TAIL, 5 + data + stuffed + sum)
    } else {
        let stuffed = if frame.extended { 39 } else { 19 } + data + 15;
        (stuffed + (stuffed - 1) / 4 + TAIL, 0)
    };
    let time_s = f64::from(nominal) / NOMINAL + f64::from(fast) / FAST;
    FrameLoad { name, bytes, bits: nominal + fast, time_s, every_s: None }
}

fn bits(count: usize) -> u32 {
    u32::try_from(count).unwrap_or(u32::MAX)
}
