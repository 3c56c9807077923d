//! A valve's amplifier at an analog output, and sensors at analog inputs: what is at which terminal, and its process data.
//!
//! A terminal's process data are as the terminal has them mapped; the objects of a loader's file are looked up there. Numbers have 16
//! bits, of which 32767 is the end of a range. Other channels of the output terminal get zero.
//!
//! An amplifier states nothing of itself: the command acts where both terminals are in OP.

use super::axis::{MOST_BYTES, ProcessData};
use super::mailbox::Object;
use super::{ANALOG, nearest};
use crate::drive::{Ask, State};
use crate::fault::Fault;
use alloc::format;
use alloc::string::{String, ToString};
use alloc::vec::Vec;
use forcefeel_model::transducers::SENSORS;

/// Terminals of a loader.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Analog {
    /// Node of the terminal with the inputs; it may be that of the output.
    pub input_node: u8,
    /// Object of the command.
    pub output: Object,
    /// Objects of load cell, drive's end, column and force sensor at the grip.
    pub inputs: [Option<Object>; SENSORS],
    /// Command in V at the end of the output's range.
    pub output_range: f64,
    /// Position in m of the drive's end at the end of its input's range.
    pub position_range: f64,
    /// Turns of the column at the end of its input's range.
    pub column_range: f64,
}

/// Objects of a terminal's outputs or inputs as it has them mapped, each with its first bit and its bits; and all bytes.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Mapped {
    /// The objects in order.
    pub objects: Vec<(Object, usize, usize)>,
    /// Bytes.
    pub bytes: u16,
}

impl Mapped {
    /// First byte of an object of 16 bits.
    ///
    /// # Errors
    /// If it is not mapped as such.
    pub fn find(&self, object: Object) -> Result<usize, String> {
        let whole = self.objects.iter().filter(|(_, first, bits)| (first % 8, *bits) == (0, 16));
        if let Some((_, first, _)) = whole.clone().find(|(its, ..)| *its == object) {
            return Ok(first / 8);
        }
        let names: Vec<_> = whole.map(|(its, ..)| its.to_string()).collect();
        let names = if names.is_empty() { "none".into() } else { names.join(", ") };
        Err(format!(
            "{object}: expected an object of 16 bits that the terminal has mapped, which are {names}; change [bus]"
        ))
    }
}

/// The terminals of an axis as their last answer stated them.
#[derive(Debug, Clone)]
pub struct Terminals {
    sizes: [u16; 2],
    /// First bytes of the output, and of each input.
    output: usize,
    inputs: [Option<usize>; SENSORS],
    column_range: f64,
    operational: bool,
}

impl Terminals {
    /// Finds what a file names in the maps of outputs and inputs.
    ///
    /// # Errors
    /// If an object is not mapped, or the maps are longer than a frame has room for.
    pub fn new(analog: &Analog, [outputs, inputs]: [&Mapped; 2]) -> Result<Self, String> {
        for map in [outputs, inputs] {
            if usize::from(map.bytes) > MOST_BYTES {
                return Err(format!("expected at most {MOST_BYTES} bytes of process data, got {}", map.bytes));
            }
        }
        let mut places = [None; SENSORS];
        for (place, object) in places.iter_mut().zip(analog.inputs) {
            *place =
                object.map(|object| inputs.find(object).map_err(|why| format!("input_node: {why}"))).transpose()?;
        }
        let (output, column_range) = (outputs.find(analog.output)?, analog.column_range);
        Ok(Self { output, inputs: places, column_range, ..Self::with_sizes([outputs.bytes, inputs.bytes]) })
    }

    /// Terminals of which only the bytes of outputs and inputs are known.
    pub fn with_sizes(sizes: [u16; 2]) -> Self {
        Self { sizes, output: 0, inputs: [None; SENSORS], column_range: 1.0, operational: false }
    }

    /// Share of a range.
    fn share(bytes: &[u8], place: usize) -> Option<f64> {
        let bytes = bytes.get(place..)?.first_chunk()?;
        Some(f64::from(i16::from_le_bytes(*bytes)) / ANALOG)
    }
}

impl ProcessData for Terminals {
    fn sizes(&self) -> [u16; 2] {
        self.sizes
    }

    fn put(&mut self, ask: &Ask, _: bool, to: &mut [u8]) {
        let share = if ask.enable && self.operational { ask.torque } else { 0.0 };
        let [low, high, ..] = nearest(share * ANALOG).clamp(-32767, 32767).to_le_bytes();
        to.fill(0);
        if let Some(place) = to.get_mut(self.output..).and_then(<[u8]>::first_chunk_mut) {
            *place = [low, high];
        }
    }

    fn state(&mut self, outputs: &[u8], inputs: &[u8], enable: bool, operational: bool) -> Option<State> {
        self.operational = operational;
        let mut shares = [f64::NAN; SENSORS];
        for (share, place) in shares.iter_mut().zip(self.inputs) {
            if let Some(place) = place {
                *share = Self::share(inputs, place)?;
            }
        }
        let [force, position, column, grip] = shares;
        Some(State {
            position,
            torque: Self::share(outputs, self.output)?,
            powered: enable && operational,
            acts: enable && operational,
            fault: Fault::NONE,
            sensors: [0.5 + 0.5 * force, self.column_range * column, 0.5 + 0.5 * grip],
            ..State::NONE
        })
    }

    fn ready(&self) -> bool {
        true
    }
}
