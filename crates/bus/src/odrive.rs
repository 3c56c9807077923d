//! An ODrive in torque mode by CANSimple, firmware 0.5 or 0.6: the loop's side.
//!
//! | frame, `node << 5` or | data | |
//! |---|---|---|
//! | 0x00, on request | protocol, hardware 3 bytes, firmware 3 bytes | 0.6 alone |
//! | 0x06, on request | node u8, serial number 6 bytes, connection u8 | 0.6 alone |
//! | 0x03, on request | errors | asked for once, it tells how many drives have a number |
//! | 0x01, by itself | error u32, state u8 | state 1 idle, 8 closed loop |
//! | 0x07 | state u32 | |
//! | 0x09, on request | position f32 in turns, velocity f32 | |
//! | 0x0B | control mode u32, 1 torque; input mode u32, 1 as it comes | |
//! | 0x0E | torque f32 | feeds the drive's watchdog |
//! | 0x18 | nothing; 0.6: u8 | clears errors |
//!
//! An answer does not tell the command that it belongs to, and the state comes by itself: a fault shows with the drive's heartbeat. The
//! torque is that which was asked for. Sensors are on a board of their own, which answers a request for 0x700 or the node with load
//! cell and force sensor at the grip, u16 of their range each, and the column's angle, u32 of a turn, all little-endian.

use crate::drive::{ALL_NODES, Ask, Codec, Identity, Send, State};
use crate::fault::{Fault, ODRIVE_5, ODRIVE_6};
use crate::frame::Frame;
use alloc::format;
use alloc::string::String;

/// Parts of a turn.
pub(crate) const TURN: f64 = 4_294_967_296.0;

/// Highest number of a node; those above are the sensor boards'.
pub const MOST_NODE: u8 = 55;

pub(crate) const VERSION: u32 = 0x00;
pub(crate) const HEARTBEAT: u32 = 0x01;
pub(crate) const ERRORS: u32 = 0x03;
pub(crate) const ADDRESS: u32 = 0x06;
pub(crate) const SET_STATE: u32 = 0x07;
pub(crate) const ESTIMATES: u32 = 0x09;
pub(crate) const SET_MODE: u32 = 0x0b;
pub(crate) const SET_TORQUE: u32 = 0x0e;
pub(crate) const CLEAR: u32 = 0x18;
pub(crate) const SENSORS: u32 = 0x700;
pub(crate) const IDLE: u8 = 1;
pub(crate) const CLOSED_LOOP: u8 = 8;
pub(crate) const TORQUE_MODE: [u8; 8] = [1, 0, 0, 0, 1, 0, 0, 0];

/// Versions of the firmware that differ.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Firmware {
    /// 0.5.1 to 0.5.6.
    Five,
    /// 0.6.
    Six,
}

impl Firmware {
    /// Bit of the error that a missed watchdog has.
    pub(crate) fn watchdog(self) -> u32 {
        match self {
            Self::Five => 1 << 11,
            Self::Six => 1 << 24,
        }
    }

    /// Number of the first fault.
    fn faults(self) -> u16 {
        match self {
            Self::Five => ODRIVE_5,
            Self::Six => ODRIVE_6,
        }
    }
}

/// The loop's side of one node.
#[derive(Debug, Clone)]
pub struct Odrive {
    node: u8,
    firmware: Firmware,
    wired: [bool; 3],
    enabled: bool,
    torque: f64,
    /// State by the last heartbeat, and whether it was in closed loop since it was asked for.
    state: u8,
    acted: bool,
    error: u32,
    sensors: Option<[f64; 3]>,
}

impl Odrive {
    /// That of a node, with the sensors that its board has: load cell, column's encoder, force sensor at the grip.
    pub fn new(node: u8, firmware: Firmware, wired: [bool; 3]) -> Self {
        let (state, sensors) = (IDLE, None);
        Self { node, firmware, wired, enabled: false, torque: 0.0, state, acted: false, error: 0, sensors }
    }

    fn fault(&self, position: f64) -> Fault {
        match self.error {
            0 if self.acted && self.state != CLOSED_LOOP => Fault::RESTARTED,
            0 if position.is_nan() => Fault::NO_POSITION,
            0 => Fault::NONE,
            error if error & self.firmware.watchdog() != 0 => Fault::WATCHDOG,
            error => Fault::of(self.firmware.faults() + u16::try_from(error.trailing_zeros()).unwrap_or(0)),
        }
    }

    /// What has come, once all of it has.
    fn whole(&mut self, position: f64, velocity: f64) -> Option<State> {
        let sensors = if self.wired.contains(&true) { self.sensors.take()? } else { [f64::NAN; 3] };
        // It takes a heartbeat to say so.
        let acts = self.acted && self.state == CLOSED_LOOP;
        Some(State {
            answers: None,
            position,
            velocity,
            torque: if acts { self.torque } else { 0.0 },
            powered: acts || !self.acted,
            acts,
            fault: self.fault(position),
            sensors,
        })
    }
}

impl Codec for Odrive {
    fn node(&self) -> u8 {
        self.node
    }

    fn ask(&mut self, ask: &Ask, send: Send) {
        let node = self.node;
        if ask.enable != self.enabled || ask.cycle == 0 {
            (self.enabled, self.acted) = (ask.enable, false);
            if ask.enable {
                send(&frame(node, SET_MODE, &TORQUE_MODE));
                send(&frame(node, SET_STATE, &[CLOSED_LOOP, 0, 0, 0]));
            } else {
                send(&frame(node, SET_STATE, &[IDLE, 0, 0, 0]));
                send(&frame(node, CLEAR, if self.firmware == Firmware::Six { &[0] } else { &[] }));
            }
        }
        self.torque = if ask.enable { ask.torque } else { 0.0 };
        #[expect(clippy::cast_possible_truncation, reason = "a drive has numbers of 32 bits")]
        send(&frame(node, SET_TORQUE, &(self.torque as f32).to_le_bytes()));
        if self.wired.contains(&true) {
            send(&Frame { remote: true, ..Frame::new(SENSORS | u32::from(node), &[]) });
        }
        send(&request(node, ESTIMATES));
    }

    fn take(&mut self, frame: &Frame) -> Option<State> {
        if frame.extended || frame.remote {
            return None;
        }
        let data = frame.data();
        let of = |start: usize| data.get(start..start + 4)?.try_into().ok();
        if frame.id == SENSORS | u32::from(self.node) {
            let (&[a, b, c, d], column) = (data.first_chunk::<4>()?, u32::from_le_bytes(of(4)?));
            let share = |low, high| f64::from(u16::from_le_bytes([low, high])) / f64::from(u16::MAX);
            self.sensors = Some([share(a, b), f64::from(column) / TURN, share(c, d)]);
            return None;
        }
        if frame.id >> 5 != u32::from(self.node) {
            return None;
        }
        match frame.id & 0x1f {
            HEARTBEAT => {
                (self.error, self.state) = (u32::from_le_bytes(of(0)?), *data.get(4)?);
                self.acted |= self.enabled && self.state == CLOSED_LOOP;
                None
            }
            ESTIMATES => {
                let [position, velocity] = [of(0)?, of(4)?].map(|bytes| f64::from(f32::from_le_bytes(bytes)));
                self.whole(position, velocity)
            }
            _ => None,
        }
    }

    fn who(&self, node: u8, send: Send) {
        // Without a request to all nodes, each is heard by its heartbeat.
        if node != ALL_NODES {
            send(&request(node, VERSION));
            match self.firmware {
                Firmware::Five => send(&request(node, ERRORS)),
                Firmware::Six => send(&request(node, ADDRESS)),
            }
        }
    }

    fn identity(&self, frame: &Frame) -> Option<Identity> {
        let node = u8::try_from(frame.id >> 5).ok().filter(|node| *node <= MOST_NODE)?;
        let known = Identity { node, ..Identity::default() };
        match (frame.id & 0x1f, frame.data()) {
            (VERSION, &[_, line, model, _, major, minor, revision, ..]) if !frame.remote => Some(Identity {
                model: u32::from_be_bytes([0, 0, line, model]),
                firmware: u32::from_be_bytes([0, major, minor, revision]),
                registers: 6,
                ..known
            }),
            (ADDRESS, &[_, a, b, c, d, e, f, _]) if !frame.remote => Some(Identity {
                serial: [u32::from_le_bytes([a, b, c, d]), u32::from(u16::from_le_bytes([e, f])), 0],
                ..known
            }),
            (HEARTBEAT, &[_, _, _, _, _, ..]) => Some(Identity { registers: 5, ..known }),
            _ => None,
        }
    }

    fn answers_once(&self, frame: &Frame) -> bool {
        self.firmware == Firmware::Five && !frame.remote && frame.id == u32::from(self.node) << 5 | ERRORS
    }

    fn accepts(&self, identity: &Identity) -> Result<(), String> {
        let (expected, remedy) = match (self.firmware, identity.registers) {
            (Firmware::Five, 5) | (Firmware::Six, 6) => return Ok(()),
            (Firmware::Five, _) => ("0.5", "odrive"),
            (Firmware::Six, _) => ("0.6, which states its version", "odrive-0.5"),
        };
        Err(format!("expected firmware {expected}, got 0.{}; say kind = \"{remedy}\" in [bus]", identity.registers))
    }
}

pub(crate) fn frame(node: u8, command: u32, data: &[u8]) -> Frame {
    Frame::new(u32::from(node) << 5 | command, data)
}

fn request(node: u8, command: u32) -> Frame {
    Frame { remote: true, ..frame(node, command, &[]) }
}
