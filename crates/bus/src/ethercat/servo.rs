//! Process data of a drive of CiA 402, in the cycle.
//!
//! | outputs | `0x6040 u16, 0x6071 i16, 0x6060 u8` |
//! |---|---|
//! | inputs | `0x6041 u16, 0x6064 i32, 0x606C i32, 0x6077 i16, 0x6061 u8`, sensors, `0x603F u16` where it can be mapped |
//!
//! A fault of the drive is acknowledged only while the loop has it stopped.

use super::axis::ProcessData;
use super::cia402::{Power, RATED, TORQUE_MODE};
use super::{Units, nearest};
use crate::drive::{Ask, State};
use crate::fault::Fault;

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

/// A drive as its last answer stated it.
#[derive(Debug, Clone)]
pub struct Servo {
    units: Units,
    layout: Layout,
    power: Power,
    mode: u8,
}

impl Servo {
    /// A drive of which nothing is known yet.
    pub fn new(units: Units, layout: Layout) -> Self {
        Self { units, layout, power: Power::NotReady, mode: 0 }
    }

    fn acts(&self) -> bool {
        self.power == Power::Enabled && self.mode == TORQUE_MODE
    }
}

impl ProcessData for Servo {
    fn sizes(&self) -> [u16; 2] {
        let Layout { sensors, error_code } = self.layout;
        let inputs = INPUTS + sensors.iter().sum::<usize>() + if error_code { 2 } else { 0 };
        [OUTPUTS, u16::try_from(inputs).unwrap_or(0)]
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
        let (fixed, mut rest) = inputs.split_first_chunk::<INPUTS>()?;
        let [s, t, p, q, r, o, v, w, x, y, a, b, mode] = *fixed;
        let sensors = [0, 1, 2].map(|place| {
            let size = self.layout.sensors[place];
            let (bytes, after) = rest.split_at_checked(size).unwrap_or_default();
            rest = after;
            if size == 0 { f64::NAN } else { self.units.sensor(place, signed(bytes)) }
        });
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
