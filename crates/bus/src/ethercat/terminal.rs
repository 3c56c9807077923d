//! Emulated terminals: four analog outputs of 16 bits, mapped as those of an EL4134, and four inputs, as those of an EL3104.
//!
//! | | objects | map of a channel |
//! |---|---|---|
//! | outputs | 0x7000:1, 0x7010:1, 0x7020:1, 0x7030:1 | 0x1600 and on: 16 bits |
//! | inputs | 0x6000:17, 0x6010:17, 0x6020:17, 0x6030:17 | 0x1a00, 0x1a02 and on: 16 bits of status, 16 bits |
//!
//! Source: Beckhoff, documentation of the series EL4100 and EL3100, process data and objects. A terminal whose outputs are late gives 0 V.

use super::analog::Analog;
use super::dictionary::{ASSIGNED, INPUTS, OUTPUTS, mapped};
use super::mailbox::{Abort, Object};
use super::registers::SAFE_OP;
use super::servo_slave::ServoSlave;
use super::sii::Product;
use super::slave::{Device, Slave};
use super::{ANALOG, Units, nearest};
use crate::drive::{Action, Node, Shown};
use alloc::vec;
use alloc::vec::Vec;
use forcefeel_model::transducers::SENSORS;

/// Channels of a terminal.
const CHANNELS: u8 = 4;
/// Bits of an input's status by sub-index; zero fills up.
const STATUS: [(u8, u32); 10] =
    [(0x01, 1), (0x02, 1), (0x03, 2), (0x05, 2), (0x07, 1), (0, 1), (0, 5), (0x0e, 1), (0x0f, 1), (0x10, 1)];

/// The object of a channel of outputs.
pub const fn output(channel: u8) -> Object {
    Object::new(0x7000 + 0x10 * channel as u16, 1)
}

/// The object of a channel of inputs.
pub const fn input(channel: u8) -> Object {
    Object::new(0x6000 + 0x10 * channel as u16, 0x11)
}

/// A terminal behind its slave's controller.
#[derive(Debug, Clone)]
pub enum Terminal {
    /// Outputs, and what is at each.
    Outputs([i16; CHANNELS as usize]),
    /// Inputs: the object of each sensor, and turns of the column at the end of its input's range.
    Inputs([Option<Object>; SENSORS], f64),
}

impl Terminal {
    fn place(&self) -> usize {
        match self {
            Self::Outputs(_) => 0,
            Self::Inputs(..) => 1,
        }
    }

    /// Index of a channel's map, and its entries.
    fn map(&self, channel: u8) -> (u16, Vec<u32>) {
        let number = u16::from(channel);
        match self {
            Self::Outputs(_) => (OUTPUTS + number, vec![mapped(output(channel), 16)]),
            Self::Inputs(..) => {
                let of = |sub: u8| if sub == 0 { Object::new(0, 0) } else { Object::new(input(channel).index, sub) };
                let status = STATUS.iter().map(|&(sub, bits)| mapped(of(sub), bits));
                (INPUTS + 2 * number, status.chain([mapped(input(channel), 16)]).collect())
            }
        }
    }

    /// Value of a channel.
    fn value(&self, channel: u8, shown: &Shown) -> [u8; 2] {
        let raw = match self {
            Self::Outputs(values) => values[usize::from(channel)],
            Self::Inputs(objects, column_range) => {
                objects.iter().position(|it| *it == Some(input(channel))).map_or(0, |sensor| {
                    let [force, column, grip] = shown.sensors;
                    let shares: [f64; SENSORS] =
                        [2.0 * force - 1.0, shown.position, column / column_range, 2.0 * grip - 1.0];
                    i16::try_from(nearest(shares[sensor] * ANALOG).clamp(-32767, 32767)).unwrap_or(0)
                })
            }
        };
        raw.to_le_bytes()
    }
}

impl Device for Terminal {
    fn product(&self) -> Product {
        match self {
            Self::Outputs(_) => Product { name: "forcefeel emulated outputs", code: 4134, sizes: [8, 0] },
            Self::Inputs(..) => Product { name: "forcefeel emulated inputs", code: 3104, sizes: [0, 16] },
        }
    }

    fn sizes(&self) -> [usize; 2] {
        self.product().sizes.map(usize::from)
    }

    fn upload(&self, object: Object, shown: &Shown) -> Result<Vec<u8>, Abort> {
        let Object { index, sub } = object;
        let of = |place: u8, list: &[u32]| list.get(usize::from(place).wrapping_sub(1)).copied();
        if let Some(place) = ASSIGNED.iter().position(|assigned| *assigned == index) {
            if place != self.place() {
                return if sub == 0 { Ok(vec![0]) } else { Err(Abort::MISSING) };
            }
            let channel = if sub == 0 { return Ok(vec![CHANNELS]) } else { sub - 1 };
            return if channel < CHANNELS {
                Ok(self.map(channel).0.to_le_bytes().to_vec())
            } else {
                Err(Abort::MISSING)
            };
        }
        for channel in 0..CHANNELS {
            let (map, entries) = self.map(channel);
            if index == map {
                let count = u8::try_from(entries.len()).unwrap_or(0);
                let entry = of(sub, &entries).map(|entry| entry.to_le_bytes().to_vec());
                return if sub == 0 { Ok(vec![count]) } else { entry.ok_or(Abort::MISSING) };
            }
            if object == [output, input][self.place()](channel) {
                return Ok(self.value(channel, shown).to_vec());
            }
        }
        match (index, sub) {
            // Kinds of the sync managers.
            (0x1c00, 0) => Ok(vec![4]),
            (0x1c00, 1..=4) => Ok(vec![sub]),
            (0x1008, 0) => Ok(self.product().name.as_bytes().to_vec()),
            (0x1018, 0) => Ok(vec![2]),
            (0x1018, 2) => Ok(self.product().code.to_le_bytes().to_vec()),
            _ => Err(Abort::MISSING),
        }
    }

    fn download(&mut self, object: Object, _: &[u8], _: bool) -> Result<(), Abort> {
        let known = self.upload(object, &Shown::default());
        known.and(Err(Abort::READ_ONLY))
    }

    fn take(&mut self, outputs: &[u8], _: f64) {
        if let Self::Outputs(values) = self {
            for (value, bytes) in values.iter_mut().zip(outputs.chunks_exact(2)) {
                *value = i16::from_le_bytes([bytes[0], bytes[1]]);
            }
        }
    }

    fn give(&self, inputs: &mut [u8], shown: &Shown) {
        if let Self::Inputs(..) = self {
            for (channel, to) in (0..CHANNELS).zip(inputs.chunks_exact_mut(4)) {
                let [low, high] = self.value(channel, shown);
                to.copy_from_slice(&[0, 0, low, high]);
            }
        }
    }

    fn stopped(&mut self, _: bool) {
        if let Self::Outputs(values) = self {
            *values = [0; CHANNELS as usize];
        }
    }
}

/// Outputs and inputs of a valve's loader, one after the other on the wire.
#[derive(Debug, Clone)]
pub struct TerminalPair {
    outputs: Slave<Terminal>,
    inputs: Slave<Terminal>,
    channel: Option<u8>,
}

impl TerminalPair {
    /// Terminals in INIT, the inputs' the last of a line or not.
    pub fn new(analog: Analog, node: u8, last: bool) -> Self {
        Self {
            outputs: Slave::with(Terminal::Outputs([0; CHANNELS as usize]), node, false),
            inputs: Slave::with(Terminal::Inputs(analog.inputs, analog.column_range), analog.input_node, last),
            channel: (0..CHANNELS).find(|&channel| output(channel) == analog.output),
        }
    }
}

impl Node for TerminalPair {
    fn pass(&mut self, frame: &mut [u8], shown: &Shown, now_s: f64) -> bool {
        let commanded = self.outputs.let_through(frame, shown, now_s);
        self.inputs.let_through(frame, shown, now_s);
        commanded
    }

    fn action(&mut self, now_s: f64) -> Action {
        self.outputs.watch(now_s);
        match (&self.outputs.device, self.channel) {
            (Terminal::Outputs(values), Some(channel)) if self.outputs.operational() => {
                Action::Torque(f64::from(values[usize::from(channel)]) / ANALOG)
            }
            _ => Action::Free,
        }
    }

    fn fail(&mut self, code: u16) {
        self.outputs.enter(SAFE_OP, code);
    }

    fn delay_power(&mut self, _: f64) {}
}

/// A drive, then a terminal with its force sensors.
#[derive(Debug, Clone)]
pub struct DriveWithInputs {
    drive: ServoSlave,
    inputs: Slave<Terminal>,
}

impl DriveWithInputs {
    /// Slaves in INIT, the terminal at a node the last of a line or not.
    pub fn new(units: Units, node: u8, input_node: u8, last: bool) -> Self {
        let [load_cell, _, grip] = [0, 1, 2].map(|place| units.at_terminal(place));
        let inputs = Terminal::Inputs([load_cell, None, None, grip], 1.0);
        Self { drive: ServoSlave::new(units, node, false), inputs: Slave::with(inputs, input_node, last) }
    }
}

impl Node for DriveWithInputs {
    fn pass(&mut self, frame: &mut [u8], shown: &Shown, now_s: f64) -> bool {
        let commanded = self.drive.pass(frame, shown, now_s);
        self.inputs.let_through(frame, shown, now_s);
        commanded
    }

    fn action(&mut self, now_s: f64) -> Action {
        self.drive.action(now_s)
    }

    fn fail(&mut self, code: u16) {
        self.drive.fail(code);
    }

    fn delay_power(&mut self, power_s: f64) {
        self.drive.delay_power(power_s);
    }
}
