//! A moteus in torque mode: the loop's side.
//!
//! Position mode, mode 10, with position not a number and both gains zero: what is left is the feed-forward torque, register 0x022.
//! Register 0x027 is the drive's own watchdog: without a command for so long the drive goes to mode 11 and damps, until it is told
//! to stop. The same frame asks for the state, and each is sent from a number of its own, to which the node answers: so an answer
//! tells the cycle that it belongs to. A command engages a drive that has just started like any other, so the drive's counter of
//! milliseconds, register 0x070, tells a start: it falls back.

use crate::drive::{Ask, Codec, Identity, Send, State};
use crate::fault::{Fault, MOTEUS};
use crate::frame::Frame;
use alloc::format;
use alloc::string::String;
use moteus_protocol::command::{PositionCommand, PositionFormat, StopCommand};
use moteus_protocol::query::QueryFormat;
use moteus_protocol::{
    CURRENT_REGISTER_MAP_VERSION, CanFdFrame, Mode, Register, Resolution, Subframe, Value, calculate_arbitration_id,
    parse_arbitration_id, parse_frame, scaling,
};

/// Highest number of a node; those above are the loop's.
pub const MOST_NODE: u8 = 95;

/// First of the numbers from which the loop sends.
const FIRST: i8 = 96;
/// How many there are.
const TAGS: u64 = 16;
/// The number from which a node is asked what it is.
const WHO: i8 = FIRST + 16;

/// Load cell, column's encoder, force sensor at the grip.
pub(crate) const SENSORS: [Register; 3] =
    [Register::Aux2AnalogIn1, Register::Encoder1Position, Register::Aux2AnalogIn2];

/// What a node is asked of itself.
const IDENTITY: [Register; 7] = [
    Register::ModelNumber,
    Register::FirmwareVersion,
    Register::RegisterMapVersion,
    Register::MultiplexId,
    Register::SerialNumber1,
    Register::SerialNumber2,
    Register::SerialNumber3,
];

/// The loop's side of one node.
#[derive(Debug, Clone)]
pub struct Moteus {
    node: u8,
    asked: u64,
    answered: Option<u64>,
    /// Counter of the drive in ms.
    counter: Option<i32>,
    /// Whether it started since it was told to stop.
    restarted: bool,
    query: QueryFormat,
}

impl Moteus {
    /// That of a node, with the sensors that are wired to it: load cell, column's encoder, force sensor at the grip.
    pub fn new(node: u8, sensors: [bool; 3]) -> Self {
        let mut query = QueryFormat::default();
        (query.voltage, query.temperature) = (Resolution::Ignore, Resolution::Ignore);
        for (register, _) in SENSORS.iter().zip(sensors).filter(|(_, wired)| *wired) {
            query.add_extra(register.address(), Resolution::Float);
        }
        query.add_extra(Register::MillisecondCounter.address(), Resolution::Int32);
        Self { node, asked: 0, answered: None, counter: None, restarted: false, query }
    }

    fn frame(node: u8, from: i8, write: impl FnOnce(&mut CanFdFrame)) -> Frame {
        let mut frame = CanFdFrame::new();
        write(&mut frame);
        frame.pad_to_dlc();
        let to = i8::try_from(node).unwrap_or(0);
        Frame::fd(calculate_arbitration_id(from, to, 0, true), frame.payload())
    }
}

impl Codec for Moteus {
    fn node(&self) -> u8 {
        self.node
    }

    fn ask(&mut self, ask: &Ask, send: Send) {
        self.asked = ask.cycle;
        self.restarted &= ask.enable;
        #[expect(clippy::cast_possible_truncation, reason = "a drive has numbers of 32 bits; below 16")]
        let (torque, watchdog, tag) = (ask.torque as f32, ask.watchdog_s as f32, (ask.cycle % TAGS) as i8);
        send(&Self::frame(self.node, FIRST + tag, |frame| {
            if ask.enable {
                let command = PositionCommand::new().position(f32::NAN).velocity(0.0).feedforward_torque(torque);
                let command = command.kp_scale(0.0).kd_scale(0.0).ilimit_scale(0.0).watchdog_timeout(watchdog);
                command.serialize(frame, &PositionFormat::default());
            } else {
                StopCommand::serialize(frame);
            }
            self.query.serialize(frame);
        }));
    }

    fn take(&mut self, frame: &Frame) -> Option<State> {
        let (source, to, prefix) = parse_arbitration_id(frame.id);
        let tag = u64::try_from(to.checked_sub(FIRST)?).ok().filter(|tag| *tag < TAGS)?;
        if prefix != 0 || u8::try_from(source).ok()? != self.node {
            return None;
        }
        let late = (self.asked % TAGS + TAGS - tag) % TAGS;
        let mut state = State { answers: self.asked.checked_sub(late), ..State::NONE };
        let newer = state.answers > self.answered;
        let (mut mode, mut code) = (Mode::Stopped, 0);
        for (register, value) in answered(frame) {
            let number = f64::from(value.to_f32(&scaling::INT));
            match register {
                Register::Mode => mode = u8::try_from(value.to_i32()).ok().and_then(|it| Mode::try_from(it).ok())?,
                Register::Position => state.position = number,
                Register::Velocity => state.velocity = number,
                Register::Torque => state.torque = number,
                Register::MillisecondCounter if newer => {
                    let counter = value.to_i32();
                    self.restarted |= self.counter.is_some_and(|before| counter.wrapping_sub(before) < 0);
                    self.counter = Some(counter);
                }
                Register::Fault => code = u16::try_from(value.to_i32()).unwrap_or(0),
                other => {
                    if let Some(sensor) = SENSORS.iter().position(|register| *register == other) {
                        state.sensors[sensor] = number;
                    }
                }
            }
        }
        self.answered = self.answered.max(state.answers);
        state.powered = !matches!(mode, Mode::Stopped | Mode::Fault | Mode::Timeout);
        // On the way there it measures its currents, and calibrates.
        state.acts = mode == Mode::Position;
        state.fault = match mode {
            Mode::Fault => Fault::of(MOTEUS + code),
            Mode::Timeout => Fault::WATCHDOG,
            _ if self.restarted => Fault::RESTARTED,
            _ if state.position.is_nan() => Fault::NO_POSITION,
            _ => Fault::NONE,
        };
        Some(state)
    }

    fn who(&self, node: u8, send: Send) {
        send(&Self::frame(node, WHO, |frame| {
            let mut query = QueryFormat::minimal();
            query.mode = Resolution::Ignore;
            query.position = Resolution::Ignore;
            query.velocity = Resolution::Ignore;
            query.torque = Resolution::Ignore;
            for register in IDENTITY {
                query.add_extra(register.address(), Resolution::Int32);
            }
            query.serialize(frame);
        }));
    }

    fn identity(&self, frame: &Frame) -> Option<Identity> {
        let (source, to, _) = parse_arbitration_id(frame.id);
        if to != WHO {
            return None;
        }
        let mut identity = Identity { node: u8::try_from(source).ok()?, ..Identity::default() };
        for (register, value) in answered(frame) {
            let number = value.to_i32().cast_unsigned();
            match register {
                Register::ModelNumber => identity.model = number,
                Register::FirmwareVersion => identity.firmware = number,
                Register::RegisterMapVersion => identity.registers = number,
                Register::SerialNumber1 => identity.serial[0] = number,
                Register::SerialNumber2 => identity.serial[1] = number,
                Register::SerialNumber3 => identity.serial[2] = number,
                _ => {}
            }
        }
        Some(identity)
    }

    fn accepts(&self, identity: &Identity) -> Result<(), String> {
        let (known, got) = (u32::from(CURRENT_REGISTER_MAP_VERSION), identity.registers);
        if got == known {
            return Ok(());
        }
        Err(format!("expected register map {known}, got {got}; update its firmware with moteus_tool --flash"))
    }
}

/// The registers that a frame states.
fn answered(frame: &Frame) -> impl Iterator<Item = (Register, Value)> {
    parse_frame(frame.data()).filter_map(|subframe| match subframe {
        Subframe::Register { register, value: Some(value), .. } => {
            Register::from_address(register).map(|register| (register, value))
        }
        _ => None,
    })
}
