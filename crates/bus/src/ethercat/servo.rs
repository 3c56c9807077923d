//! Process data of a drive of CiA 402, in the cycle.
//!
//! | outputs | `0x6040 u16, 0x6071 i16, 0x6060 u8` |
//! |---|---|
//! | inputs | `0x6041 u16, 0x6064 i32, 0x606C i32, 0x6077 i16, 0x6061 u8`, sensors, `0x603F u16` where it can be mapped |
//!
//! Load cell and force sensor may be at a terminal's inputs, which come behind those of the drive.
//!
//! A fault of the drive is acknowledged only while the loop has it stopped.

use super::analog::Mapped;
use super::axis::{MOST_BYTES, ProcessData};
use super::cia402::{Power, RATED, TORQUE_MODE};
use super::{Units, nearest};
use crate::drive::{Ask, State};
use crate::fault::Fault;
use alloc::format;
use alloc::string::String;

/// Bytes of outputs, and of the inputs that all drives have.
const OUTPUTS: u16 = 5;
const INPUTS: usize = 13;

/// What of the inputs differs from drive to drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Layout {
    /// Bytes of each sensor; none of one that is not there.
    pub sensors: [usize; 3],
    /// Whether the error code comes last.
    pub error_code: bool,
}

/// The inputs of a terminal: bytes, and the first of each sensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TerminalInputs {
    /// All bytes that it has mapped.
    pub bytes: u16,
    /// First byte of each sensor that is there.
    pub places: [Option<usize>; 3],
}

impl TerminalInputs {
    /// Finds the sensors of a file in the map of the inputs.
    ///
    /// # Errors
    /// If one is not mapped, or the map is longer than a frame has room for.
    pub fn new(units: &Units, map: &Mapped) -> Result<Self, String> {
        if usize::from(map.bytes) > MOST_BYTES / 2 {
            return Err(format!("expected at most {} bytes of process data, got {}", MOST_BYTES / 2, map.bytes));
        }
        let mut places = [None; 3];
        for (place, found) in places.iter_mut().enumerate() {
            *found = units.at_terminal(place).map(|object| map.find(object)).transpose()?;
        }
        Ok(Self { bytes: map.bytes, places })
    }
}

/// A drive as its last answer stated it.
#[derive(Debug, Clone)]
pub struct Servo {
    units: Units,
    layout: Layout,
    terminal: Option<TerminalInputs>,
    power: Power,
    mode: u8,
}

impl Servo {
    /// A drive of which nothing is known yet.
    pub fn new(units: Units, layout: Layout) -> Self {
        Self { units, layout, terminal: None, power: Power::NotReady, mode: 0 }
    }

    /// With sensors at a terminal.
    #[must_use]
    pub fn with(self, terminal: Option<TerminalInputs>) -> Self {
        Self { terminal, ..self }
    }

    /// Bytes of its own inputs.
    pub fn own_inputs(&self) -> u16 {
        let Layout { sensors, error_code } = self.layout;
        u16::try_from(INPUTS + sensors.iter().sum::<usize>() + if error_code { 2 } else { 0 }).unwrap_or(0)
    }

    fn acts(&self) -> bool {
        self.power == Power::Enabled && self.mode == TORQUE_MODE
    }
}

impl ProcessData for Servo {
    fn sizes(&self) -> [u16; 2] {
        [OUTPUTS, self.own_inputs() + self.terminal.map_or(0, |terminal| terminal.bytes)]
    }

    fn readers(&self) -> u16 {
        if self.terminal.is_some() { 2 } else { 1 }
    }

    fn put(&mut self, ask: &Ask, odd: bool, to: &mut [u8]) {
        let control = self.power.control(ask.enable, odd);
        let torque = if ask.enable && self.acts() {
            nearest(ask.torque / self.units.rated_torque * RATED).clamp(-32767, 32767)
        } else {
            0
        };
        let ([a, b], [c, d, ..]) = (control.to_le_bytes(), torque.to_le_bytes());
        to.copy_from_slice(&[a, b, c, d, TORQUE_MODE]);
    }

    fn state(&mut self, _: &[u8], inputs: &[u8], enable: bool, _: bool) -> Option<State> {
        let (inputs, others) = inputs.split_at_checked(self.own_inputs().into())?;
        let (fixed, mut rest) = inputs.split_first_chunk::<INPUTS>()?;
        let [s, t, p, q, r, o, v, w, x, y, a, b, mode] = *fixed;
        let mut sensors = [0, 1, 2].map(|place| {
            let size = self.layout.sensors[place];
            let (bytes, after) = rest.split_at_checked(size).unwrap_or_default();
            rest = after;
            if size == 0 { f64::NAN } else { self.units.sensor(place, signed(bytes)) }
        });
        let at_terminal = self.terminal.map_or([None; 3], |terminal| terminal.places);
        for (index, first) in at_terminal.into_iter().enumerate() {
            if let Some(first) = first {
                sensors[index] = self.units.sensor(index, signed(others.get(first..first + 2)?));
            }
        }
        let error = rest.first_chunk().map_or(Fault::UNKNOWN.0, |code| u16::from_le_bytes(*code));
        (self.power, self.mode) = (Power::of(u16::from_le_bytes([s, t])), mode);
        let counted = |bytes: [u8; 4]| f64::from(i32::from_le_bytes(bytes)) / self.units.counts;
        Some(State {
            answers: None,
            position: counted([p, q, r, o]),
            velocity: counted([v, w, x, y]),
            torque: f64::from(i16::from_le_bytes([a, b])) / RATED * self.units.rated_torque,
            acts: self.acts(),
            powered: self.power == Power::Enabled,
            fault: match self.power {
                Power::Fault => Fault::of_drive(error),
                Power::Enabled if enable && mode != TORQUE_MODE => Fault::MODE,
                _ => Fault::NONE,
            },
            sensors,
        })
    }

    fn ready(&self) -> bool {
        !matches!(self.power, Power::Fault | Power::NotReady)
    }
}

/// A number of one to four bytes, with its sign.
fn signed(bytes: &[u8]) -> i32 {
    let negative = bytes.last().is_some_and(|last| last & 0x80 != 0);
    let mut whole = [if negative { 0xff } else { 0 }; 4];
    whole.iter_mut().zip(bytes).for_each(|(to, from)| *to = *from);
    i32::from_le_bytes(whole)
}
