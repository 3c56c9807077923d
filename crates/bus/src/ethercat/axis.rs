//! The master in the cycle: the frame of an axis, and what it says when it comes back.
//!
//! `LWR outputs · LRD inputs · FPRD 0x0130 · FPWR 0x0120 where its state is asked for · FRMW 0x0910 where there is a clock`
//!
//! | outputs | `0x6040 u16, 0x6071 i16, 0x6060 u8` |
//! |---|---|
//! | inputs | `0x6041 u16, 0x6064 i32, 0x606C i32, 0x6077 i16, 0x6061 u8`, sensors, `0x603F u16` where it can be mapped |
//!
//! An error of the slave, or a fault of the drive, is acknowledged only while the loop has it stopped.

use super::cia402::{Power, RATED, TORQUE_MODE};
use super::datagram::{Datagram, Packet, at, command, datagrams};
use super::registers::{AL_CONTROL, AL_STATUS, ERROR, OP, SAFE_OP, SYSTEM_TIME};
use super::{Units, nearest};
use crate::drive::{Ask, State};
use crate::fault::Fault;

/// Cycles that a drive may take to clear its fault once it is stopped.
const CLEARING: u32 = 500;
/// Bytes of outputs, and of the inputs that all drives have.
const OUTPUTS: u16 = 5;
const INPUTS: usize = 13;
const MOST_INPUTS: usize = INPUTS + 3 * 4 + 2;

/// What of the inputs differs from drive to drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Layout {
    /// Bytes of each sensor; none of one that is not there.
    pub sensors: [usize; 3],
    /// Whether the error code comes last.
    pub error_code: bool,
}

impl Layout {
    /// Bytes of outputs and inputs.
    pub fn sizes(&self) -> [u16; 2] {
        let inputs = INPUTS + self.sensors.iter().sum::<usize>() + if self.error_code { 2 } else { 0 };
        [OUTPUTS, u16::try_from(inputs).unwrap_or(0)]
    }
}

/// An axis.
#[derive(Debug, Clone)]
pub struct Axis {
    station: u16,
    base: u32,
    units: Units,
    layout: Layout,
    /// Station of the clock that counts.
    clock: Option<u16>,
    cycle: u64,
    enable: bool,
    /// Cycles since it was last enabled or stopped, and whether it has been powered since.
    since: u32,
    powered: bool,
    /// What the last answer stated.
    power: Power,
    mode: u8,
    al: u8,
}

impl Axis {
    /// An axis in SAFE-OP.
    pub fn new(station: u16, base: u32, units: Units, layout: Layout, clock: Option<u16>) -> Self {
        Self {
            station,
            base,
            units,
            layout,
            clock,
            cycle: 0,
            enable: false,
            since: 0,
            powered: false,
            power: Power::NotReady,
            mode: 0,
            al: SAFE_OP,
        }
    }

    /// Station of the clock that counts.
    pub fn clock(&self) -> Option<u16> {
        self.clock
    }

    /// Whether it is stopped, in OP, and has no fault.
    pub fn ready(&self) -> bool {
        self.al == OP && !matches!(self.power, Power::Fault | Power::NotReady)
    }

    fn acts(&self) -> bool {
        self.power == Power::Enabled && self.mode == TORQUE_MODE
    }

    /// The frame of a cycle.
    pub fn ask(&mut self, ask: &Ask) -> Packet {
        if ask.enable != self.enable {
            (self.enable, self.since, self.powered) = (ask.enable, 0, false);
        }
        self.cycle = ask.cycle;
        self.since = self.since.saturating_add(1);
        let index = ask.cycle.to_le_bytes()[0];
        let control = self.power.control(ask.enable, self.since % 2 == 1);
        let torque = if ask.enable && self.acts() {
            nearest(ask.torque / self.units.rated_torque * RATED).clamp(-32767, 32767)
        } else {
            0
        };
        let ([a, b], [c, d, ..]) = (control.to_le_bytes(), torque.to_le_bytes());
        let mut packet = Packet::of(command::LWR, index, self.base, &[a, b, c, d, TORQUE_MODE]);
        let [written, read] = self.layout.sizes();
        packet.put(command::LRD, index, self.base + u32::from(written), &[0; MOST_INPUTS][..usize::from(read)]);
        packet.put(command::FPRD, index, at(self.station, AL_STATUS), &[0; 6]);
        if !ask.enable && self.al != OP {
            let state = if self.al & ERROR == 0 { OP } else { self.al };
            packet.put(command::FPWR, index, at(self.station, AL_CONTROL), &[state, 0]);
        }
        if let Some(clock) = self.clock {
            packet.put(command::FRMW, index, at(clock, SYSTEM_TIME), &[0; 8]);
        }
        packet
    }

    /// What a frame that came back states; nothing if it is another's or damaged, a fault where the slave did not take its share.
    pub fn take(&mut self, frame: &mut [u8]) -> Option<Result<State, Fault>> {
        let mut datagrams = datagrams(frame);
        let written = datagrams.next().filter(|it| it.command == command::LWR && it.logical() == self.base)?;
        let index = written.index;
        let outputs = written.counter();
        let (read, al) = (datagrams.next()?, datagrams.next()?);
        let [_, size] = self.layout.sizes();
        let fits = |it: &Datagram<'_>, command: u8, size: usize| {
            (it.command, it.index, it.data.len()) == (command, index, size)
        };
        if !fits(&read, command::LRD, size.into()) || !fits(&al, command::FPRD, 6) {
            return None;
        }
        if [outputs, read.counter(), al.counter()] != [1; 3] {
            return Some(Err(Fault::COUNTER));
        }
        let &mut [status, _, _, _, low, high] = al.data else { return None };
        self.al = status;
        if status & !ERROR < SAFE_OP {
            return Some(Err(Fault::RESTARTED));
        }
        // The newest command of this number.
        let behind = self.cycle.to_le_bytes()[0].wrapping_sub(index);
        let answers = self.cycle.checked_sub(u64::from(behind))?;
        self.state(answers, read.data, u16::from_le_bytes([low, high])).map(Ok)
    }

    fn state(&mut self, answers: u64, inputs: &[u8], code: u16) -> Option<State> {
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
        self.powered |= self.power == Power::Enabled;
        let counted = |bytes: [u8; 4]| f64::from(i32::from_le_bytes(bytes)) / self.units.counts;
        Some(State {
            answers: Some(answers),
            position: counted([p, q, r, o]),
            velocity: counted([v, w, x, y]),
            torque: f64::from(i16::from_le_bytes([a, b])) / RATED * self.units.rated_torque,
            acts: self.acts(),
            powered: self.power == Power::Enabled || (self.enable && !self.powered),
            fault: self.fault(code, error),
            sensors,
        })
    }

    /// What it complains of: while it is stopped only what does not clear.
    fn fault(&self, code: u16, error: u16) -> Fault {
        if !self.enable && self.since < CLEARING {
            return Fault::NONE;
        }
        match self.power {
            _ if self.al & ERROR != 0 => Fault::of_al(code),
            Power::Fault => Fault::of_drive(error),
            Power::Enabled if self.enable && self.mode != TORQUE_MODE => Fault::MODE,
            _ => Fault::NONE,
        }
    }
}

/// A number of one to four bytes, with its sign.
fn signed(bytes: &[u8]) -> i32 {
    let negative = bytes.last().is_some_and(|last| last & 0x80 != 0);
    let mut whole = [if negative { 0xff } else { 0 }; 4];
    whole.iter_mut().zip(bytes).for_each(|(to, from)| *to = *from);
    i32::from_le_bytes(whole)
}
