//! The master in the cycle: the frame of an axis, and what it says when it comes back.
//!
//! `LWR outputs · LRD inputs · FPRD 0x0130 of each slave · FPWR 0x0120 where its state is asked for · FRMW 0x0910 where there is a clock`
//!
//! An error of a slave is acknowledged only while the loop has the axis stopped.

use super::datagram::{Datagram, Packet, at, command, datagrams};
use super::registers::{AL_CONTROL, AL_STATUS, ERROR, OP, SAFE_OP, SYSTEM_TIME};
use crate::drive::{Ask, State};
use crate::fault::Fault;
use alloc::boxed::Box;
use core::fmt::Debug;

/// Cycles that a slave may take to clear its fault once it is stopped.
const CLEARING: u32 = 500;
/// Most bytes of outputs, and of inputs.
pub const MOST_BYTES: usize = 256;
/// Logical address of an axis's inputs, from that of its outputs.
pub const INPUTS_AT: u32 = 0x8000;
/// Slaves of an axis at most.
pub const MOST_SLAVES: usize = 2;

/// What is in the process data of an axis.
pub trait ProcessData: Debug + Send {
    /// Bytes of outputs and inputs.
    fn sizes(&self) -> [u16; 2];
    /// Writes the outputs of a cycle; `odd` changes from cycle to cycle.
    fn put(&mut self, ask: &Ask, odd: bool, to: &mut [u8]);
    /// What the inputs state in a frame with these outputs: power, and faults, as the node itself has them. `operational`: its slaves are in OP.
    fn state(&mut self, outputs: &[u8], inputs: &[u8], enable: bool, operational: bool) -> Option<State>;
    /// Slaves that have inputs.
    fn readers(&self) -> u16 {
        1
    }
    /// Whether it could be enabled.
    fn ready(&self) -> bool;
}

/// An axis.
#[derive(Debug)]
pub struct Axis {
    /// Stations of its slaves, and the state of each.
    stations: [Option<u16>; MOST_SLAVES],
    al: [u8; MOST_SLAVES],
    base: u32,
    data: Box<dyn ProcessData>,
    /// Station of the clock that counts.
    clock: Option<u16>,
    cycle: u64,
    enable: bool,
    /// Cycles since it was last enabled or stopped, and whether it has been powered since.
    since: u32,
    powered: bool,
}

impl Axis {
    /// An axis whose slaves are in SAFE-OP, with outputs at a logical address.
    pub fn new(
        stations: [Option<u16>; MOST_SLAVES],
        base: u32,
        data: Box<dyn ProcessData>,
        clock: Option<u16>,
    ) -> Self {
        Self {
            stations,
            al: [SAFE_OP; MOST_SLAVES],
            base,
            data,
            clock,
            cycle: 0,
            enable: false,
            since: 0,
            powered: false,
        }
    }

    /// Station of the clock that counts.
    pub fn clock(&self) -> Option<u16> {
        self.clock
    }

    /// Slaves that it has.
    pub fn count(&self) -> u8 {
        self.slaves().map(|_| 1).sum()
    }

    fn slaves(&self) -> impl Iterator<Item = (usize, u16)> {
        self.stations.into_iter().enumerate().filter_map(|(place, station)| Some((place, station?)))
    }

    fn operational(&self) -> bool {
        self.slaves().all(|(place, _)| self.al[place] == OP)
    }

    /// Whether it is stopped, in OP, and has no fault.
    pub fn ready(&self) -> bool {
        self.operational() && self.data.ready()
    }

    /// The frame of a cycle.
    pub fn ask(&mut self, ask: &Ask) -> Packet {
        if ask.enable != self.enable {
            (self.enable, self.since, self.powered) = (ask.enable, 0, false);
        }
        self.cycle = ask.cycle;
        self.since = self.since.saturating_add(1);
        let index = ask.cycle.to_le_bytes()[0];
        let [written, read] = self.data.sizes().map(usize::from);
        let mut outputs = [0; MOST_BYTES];
        self.data.put(ask, self.since % 2 == 1, &mut outputs[..written]);
        let mut packet = Packet::of(command::LWR, index, self.base, &outputs[..written]);
        packet.put(command::LRD, index, self.base + INPUTS_AT, &[0; MOST_BYTES][..read]);
        for (_, station) in self.slaves() {
            packet.put(command::FPRD, index, at(station, AL_STATUS), &[0; 6]);
        }
        for (place, station) in self.slaves() {
            let al = self.al[place];
            if !ask.enable && al != OP {
                let state = if al & ERROR == 0 { OP } else { al };
                packet.put(command::FPWR, index, at(station, AL_CONTROL), &[state, 0]);
            }
        }
        if let Some(clock) = self.clock {
            packet.put(command::FRMW, index, at(clock, SYSTEM_TIME), &[0; 8]);
        }
        packet
    }

    /// What a frame that came back states; nothing if it is another's or damaged, a fault where a slave did not take its share.
    pub fn take(&mut self, frame: &mut [u8]) -> Option<Result<State, Fault>> {
        let mut datagrams = datagrams(frame);
        let written = datagrams.next().filter(|it| it.command == command::LWR && it.logical() == self.base)?;
        let index = written.index;
        let read = datagrams.next()?;
        let [outputs, inputs] = self.data.sizes().map(usize::from);
        let fits = |it: &Datagram<'_>, command: u8, size: usize| {
            (it.command, it.index, it.data.len()) == (command, index, size)
        };
        if !fits(&read, command::LRD, inputs) || written.data.len() != outputs {
            return None;
        }
        let mut counted = [written.counter(), read.counter()] == [1, self.data.readers()];
        let (mut al, mut code) = (self.al, 0);
        for (place, _) in self.slaves() {
            let its = datagrams.next().filter(|it| fits(it, command::FPRD, 6))?;
            counted &= its.counter() == 1;
            let &mut [status, _, _, _, low, high] = its.data else { return None };
            al[place] = status;
            if status & ERROR != 0 {
                code = u16::from_le_bytes([low, high]);
            }
        }
        if !counted {
            return Some(Err(Fault::COUNTER));
        }
        self.al = al;
        if self.slaves().any(|(place, _)| al[place] & !ERROR < SAFE_OP) {
            return Some(Err(Fault::RESTARTED));
        }
        // The newest command of this number.
        let behind = self.cycle.to_le_bytes()[0].wrapping_sub(index);
        let answers = self.cycle.checked_sub(u64::from(behind))?;
        let state = self.data.state(written.data, read.data, self.enable, self.operational())?;
        self.powered |= state.powered;
        Some(Ok(State {
            answers: Some(answers),
            powered: state.powered || (self.enable && !self.powered),
            fault: self.fault(code, state.fault),
            ..state
        }))
    }

    /// What it complains of: while it is stopped only what does not clear.
    fn fault(&self, code: u16, of_node: Fault) -> Fault {
        if !self.enable && self.since < CLEARING {
            return Fault::NONE;
        }
        let failed = self.slaves().any(|(place, _)| self.al[place] & ERROR != 0);
        if failed { Fault::of_al(code) } else { of_node }
    }
}
