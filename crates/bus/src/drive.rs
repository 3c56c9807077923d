//! What every bus of drives has: a cycle's command, a node's answer, and both sides of a protocol.

use crate::fault::Fault;
use crate::frame::Frame;
use alloc::format;
use alloc::string::String;

/// The number that all nodes answer.
pub const ALL_NODES: u8 = 0x7f;

/// What a cycle asks of a node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ask {
    /// Cycle of the loop.
    pub cycle: u64,
    /// Torque in N m at what the drive states as its output.
    pub torque: f64,
    /// Whether it is to be powered.
    pub enable: bool,
    /// Time without a command after which the drive damps by itself, in s.
    pub watchdog_s: f64,
}

/// What a node states; not a number where it states nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State {
    /// Cycle that it answers, where the protocol carries one.
    pub answers: Option<u64>,
    /// Position in revolutions.
    pub position: f64,
    /// Velocity in revolutions per second.
    pub velocity: f64,
    /// Torque in N m.
    pub torque: f64,
    /// Whether it is powered, or on its way there.
    pub powered: bool,
    /// Whether it carries out its torque by now.
    pub acts: bool,
    /// What it complains of.
    pub fault: Fault,
    /// Load cell, a share of its range from 0 to 1; column's encoder in revolutions; force sensor at the grip like the load cell.
    pub sensors: [f64; 3],
}

impl State {
    /// Nothing is stated.
    pub const NONE: Self = Self {
        answers: None,
        position: f64::NAN,
        velocity: f64::NAN,
        torque: f64::NAN,
        powered: false,
        acts: false,
        fault: Fault::NONE,
        sensors: [f64::NAN; 3],
    };
}

/// What a node states of itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Identity {
    /// Its number on the bus.
    pub node: u8,
    /// Model of the hardware.
    pub model: u32,
    /// Version of the firmware: three bytes, or the maker's number.
    pub firmware: u32,
    /// Version of its registers.
    pub registers: u32,
    /// Serial number.
    pub serial: [u32; 3],
}

impl Identity {
    /// The serial number, hexadecimal.
    pub fn serial_text(&self) -> String {
        let [first, second, third] = self.serial;
        format!("{first:08x}{second:08x}{third:08x}")
    }
}

/// Where frames go.
pub type Send<'a> = &'a mut dyn FnMut(&Frame);

/// The loop's side of a protocol, for one node.
pub trait Codec {
    /// The node's number.
    fn node(&self) -> u8;
    /// The frames of a cycle.
    fn ask(&mut self, ask: &Ask, send: Send);
    /// What a frame completes of the node's state.
    fn take(&mut self, frame: &Frame) -> Option<State>;
    /// Asks a node what it is.
    fn who(&self, node: u8, send: Send);
    /// A node's answer to that.
    fn identity(&self, frame: &Frame) -> Option<Identity>;
    /// Whether a frame is one by which a node that states no serial number answers once to be asked what it is: two of them are two nodes.
    fn answers_once(&self, _frame: &Frame) -> bool {
        false
    }
    /// Whether a node can be driven.
    ///
    /// # Errors
    /// What was expected of it.
    fn accepts(&self, identity: &Identity) -> Result<(), String>;
}

/// What a node's machine shows at an instant, in the units of the node.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Shown {
    /// Position in revolutions.
    pub position: f64,
    /// Velocity in revolutions per second.
    pub velocity: f64,
    /// Torque in N m.
    pub torque: f64,
    /// As of [`State::sensors`].
    pub sensors: [f64; 3],
}

/// What a node does to its machine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Action {
    /// Nothing: the motor turns freely.
    Free,
    /// A torque in N m.
    Torque(f64),
    /// It resists motion.
    Damp,
}

/// The other side: a node that answers as the drive would.
pub trait Node {
    /// Takes a frame of CAN at a time in s, and answers; whether it was a command for it.
    fn take(&mut self, _frame: &Frame, _shown: &Shown, _now_s: f64, _send: Send) -> bool {
        false
    }
    /// Lets a frame of EtherCAT through at a time in s, with its share changed; whether it had a command for it.
    fn pass(&mut self, _frame: &mut [u8], _shown: &Shown, _now_s: f64) -> bool {
        false
    }
    /// What it sends by itself, at a time in s.
    fn tick(&mut self, _now_s: f64, _send: Send) {}
    /// What it does to its machine at a time in s.
    fn action(&mut self, now_s: f64) -> Action;
    /// Has the drive fail, with the maker's code.
    fn fail(&mut self, code: u16);
    /// Has the drive take so long in s to act once it is enabled.
    fn delay_power(&mut self, power_s: f64);
}
