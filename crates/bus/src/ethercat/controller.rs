//! A slave controller: its memory, sync managers, FMMUs, clock and EEPROM as a master's datagrams find them (ETG.1000.4).

use super::datagram::{Datagram, command};
use super::registers::{AL_CODE, AL_CONTROL, AL_STATUS, DIVIDER, WATCHDOG_DIVIDER, WATCHDOG_STATUS, WATCHDOG_TIME};
use super::registers::{
    ALIAS, DL_STATUS, EEPROM_ADDRESS, EEPROM_CONTROL, EEPROM_DATA, ERROR, FEATURES, FMMU, HAS_CLOCK, INIT, MAILBOX,
    MASTER_WRITES, RECEIVE_TIME, RECEIVE_TIME_LOCAL, STATION, SYNC_MANAGER, SYSTEM_TIME, SYSTEM_TIME_OFFSET,
};
use super::sii::word;
use alloc::vec;
use alloc::vec::Vec;

/// Where registers end and process memory begins, and its end.
const PROCESS: u16 = 0x1000;
const MEMORY: usize = 0x2000;
/// FMMUs and sync managers that it has.
const FMMUS: u8 = 4;
const MANAGERS: u8 = 4;
/// Bit of a sync manager's status: the mailbox is full.
const FULL: u8 = 0x08;
/// Registers that a master cannot write.
const READ_ONLY: [core::ops::Range<u16>; 6] =
    [0x0000..STATION, ALIAS..0x0100, DL_STATUS..AL_CONTROL, AL_STATUS..0x0140, WATCHDOG_STATUS..0x0444, 0x0900..0x0920];

/// A sync manager as its registers have it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Manager {
    pub start: u16,
    pub size: u16,
    pub control: u8,
    pub active: bool,
}

impl Manager {
    fn mailbox(self) -> bool {
        self.active && self.control & 3 == MAILBOX && self.start >= PROCESS
    }

    fn written(self) -> bool {
        self.control & 0x0c == MASTER_WRITES
    }

    fn end(self) -> usize {
        usize::from(self.start) + usize::from(self.size)
    }
}

/// What a datagram has done that the drive has to act on.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Events {
    pub al_control: bool,
    pub mailbox: bool,
    pub outputs: bool,
}

/// A controller.
#[derive(Debug, Clone)]
pub(crate) struct Controller {
    memory: Vec<u8>,
    rom: Vec<u8>,
}

impl Controller {
    /// That of a slave after its start; `last` of a line has nothing at its second port.
    pub fn new(rom: Vec<u8>, last: bool) -> Self {
        let mut made = Self { memory: vec![0; MEMORY], rom };
        made.set(0x0000, &[0x11, 0, 0, 0, FMMUS, MANAGERS, 4, 0x0f]);
        made.set(FEATURES, &HAS_CLOCK.to_le_bytes());
        let alias = made.rom_bytes(word::ALIAS, 2);
        made.set(ALIAS, &alias);
        // Interface to the drive up, a link at the first port, and at the second; the other ports are closed.
        let ports: u16 = if last { 0x5611 } else { 0x5a31 };
        made.set(DL_STATUS, &ports.to_le_bytes());
        made.set(AL_STATUS, &[INIT]);
        made.set(WATCHDOG_DIVIDER, &DIVIDER.to_le_bytes());
        made.set(WATCHDOG_TIME, &1000_u16.to_le_bytes());
        made.set(WATCHDOG_STATUS, &[1]);
        made
    }

    /// State that is asked for.
    pub fn al_control(&self) -> u8 {
        self.memory[usize::from(AL_CONTROL)]
    }

    /// States a state; with a code it is an error.
    pub fn set_state(&mut self, state: u8, code: u16) {
        self.set(AL_STATUS, &[if code == 0 { state } else { state | ERROR }]);
        self.set(AL_CODE, &code.to_le_bytes());
    }

    /// Time without outputs after which the drive acts by itself, in s; nothing where it is off.
    pub fn watchdog_s(&self) -> Option<f64> {
        let (divider, time) = (self.word(WATCHDOG_DIVIDER), self.word(WATCHDOG_TIME));
        let ticks = (u32::from(divider) + 2) * u32::from(time);
        (time > 0).then(|| f64::from(ticks) * 40e-9)
    }

    pub fn manager(&self, number: u16) -> Manager {
        let at = SYNC_MANAGER + 8 * number;
        let &[a, b, c, d, control, _, active, _] = self.get(at);
        let (start, size) = (u16::from_le_bytes([a, b]), u16::from_le_bytes([c, d]));
        Manager { start, size, control, active: active & 1 == 1 }
    }

    /// Its bytes of the process memory.
    pub fn at(&mut self, manager: Manager) -> &mut [u8] {
        let from = usize::from(manager.start.max(PROCESS));
        self.memory.get_mut(from..manager.end()).unwrap_or_default()
    }

    /// Takes the message of the mailbox that the master writes.
    pub fn take_message(&mut self) -> Vec<u8> {
        let manager = self.manager(0);
        self.fill(0, false);
        self.at(manager).to_vec()
    }

    /// Puts a message into the mailbox that it reads.
    pub fn put_message(&mut self, message: &[u8]) {
        let manager = self.manager(1);
        let to = self.at(manager);
        let size = message.len().min(to.len());
        to[..size].copy_from_slice(&message[..size]);
        self.fill(1, true);
    }

    /// Size of a message.
    pub fn message_size(&self) -> usize {
        usize::from(self.manager(1).size)
    }

    fn fill(&mut self, number: u16, full: bool) {
        let at = usize::from(SYNC_MANAGER + 8 * number + 5);
        self.memory[at] = if full { FULL } else { 0 };
    }

    fn full(&self, number: u16) -> bool {
        self.memory[usize::from(SYNC_MANAGER + 8 * number + 5)] & FULL != 0
    }

    /// Lets a datagram through at a local time in ns.
    pub fn pass(&mut self, datagram: &mut Datagram<'_>, time_ns: u64) -> Events {
        use command::{APRD, APRW, APWR, ARMW, BRD, BRW, BWR, FPRD, FPRW, FPWR, FRMW, LRD, LRW, LWR};
        let offset = u64::from_le_bytes(*self.get(SYSTEM_TIME_OFFSET));
        self.set(SYSTEM_TIME, &time_ns.wrapping_add(offset).to_le_bytes());
        let slave = datagram.slave();
        if matches!(datagram.command, APRD | APWR | APRW | BRD | BWR | BRW | ARMW) {
            datagram.address[..2].copy_from_slice(&slave.wrapping_add(1).to_le_bytes());
        }
        let first = slave == 0;
        let own = slave == self.word(STATION);
        let [read, write] = match datagram.command {
            APRD => [first, false],
            APWR => [false, first],
            APRW => [first, first],
            FPRD => [own, false],
            FPWR => [false, own],
            FPRW => [own, own],
            BRD => [true, false],
            BWR => [false, true],
            BRW => [true, true],
            ARMW => [first, !first],
            FRMW => [own, !own],
            LRD | LWR | LRW => return self.logical(datagram),
            _ => [false, false],
        };
        if !(read || write) {
            return Events::default();
        }
        let all = matches!(datagram.command, BRD | BRW);
        let (register, size) = (usize::from(datagram.register()), datagram.data.len());
        if register + size > MEMORY || size == 0 {
            return Events::default();
        }
        let asked = if write { datagram.data.to_vec() } else { vec![] };
        if read && self.may_read(register, size) {
            for (to, &from) in datagram.data.iter_mut().zip(&self.memory[register..register + size]) {
                *to = if all { *to | from } else { from };
            }
            self.has_read(register, size);
            datagram.count(1);
        }
        if write && self.may_write(register, size) {
            datagram.count(if read { 2 } else { 1 });
            return self.write(register, &asked, time_ns);
        }
        Events::default()
    }

    fn write(&mut self, register: usize, data: &[u8], time_ns: u64) -> Events {
        let end = register + data.len();
        for (at, &byte) in (register..).zip(data) {
            let address = u16::try_from(at).unwrap_or(0);
            let status = (SYNC_MANAGER..SYNC_MANAGER + 8 * u16::from(MANAGERS)).contains(&address) && at % 8 == 5;
            if !status && !READ_ONLY.iter().any(|range| range.contains(&address)) {
                self.memory[at] = byte;
            }
        }
        let touches = |address: u16| (register..end).contains(&usize::from(address));
        if touches(RECEIVE_TIME) {
            let latched = time_ns.to_le_bytes();
            self.set(RECEIVE_TIME, &[&latched[..4], &latched[..4]].concat());
            self.set(RECEIVE_TIME_LOCAL, &latched);
        }
        if touches(EEPROM_CONTROL + 1) {
            self.eeprom();
        }
        for number in 0..2 {
            // A mailbox that is switched off is empty.
            if touches(SYNC_MANAGER + 8 * number + 6) && !self.manager(number).active {
                self.fill(number, false);
            }
        }
        let mut events = Events { al_control: touches(AL_CONTROL), ..Events::default() };
        let ends = |manager: Manager| {
            manager.active && manager.written() && manager.size > 0 && (register..end).contains(&(manager.end() - 1))
        };
        if self.manager(0).mailbox() && ends(self.manager(0)) {
            self.fill(0, true);
            events.mailbox = true;
        }
        events.outputs = ends(self.manager(2));
        events
    }

    /// Whether a range keeps to the mailboxes: from where there is a message, to where there is none.
    fn may_read(&self, register: usize, size: usize) -> bool {
        self.keeps_to(register, size, |number, manager| !manager.written() && self.full(number))
    }

    fn may_write(&self, register: usize, size: usize) -> bool {
        self.keeps_to(register, size, |number, manager| manager.written() && !self.full(number))
    }

    fn keeps_to(&self, register: usize, size: usize, allowed: impl Fn(u16, Manager) -> bool) -> bool {
        (0..2).all(|number| {
            let manager = self.manager(number);
            let apart = register + size <= usize::from(manager.start) || manager.end() <= register;
            !manager.mailbox() || apart || allowed(number, manager)
        })
    }

    fn has_read(&mut self, register: usize, size: usize) {
        let manager = self.manager(1);
        if manager.mailbox() && (register..register + size).contains(&(manager.end().wrapping_sub(1))) {
            self.fill(1, false);
        }
    }

    /// Logical addresses by the FMMUs, of whole bytes.
    fn logical(&mut self, datagram: &mut Datagram<'_>) -> Events {
        let (start, size) = (u64::from(datagram.logical()), datagram.data.len() as u64);
        let reads = datagram.command != command::LWR;
        let writes = datagram.command != command::LRD;
        let asked = datagram.data.to_vec();
        let (mut events, mut counted) = (Events::default(), [false; 2]);
        for number in 0..u16::from(FMMUS) {
            let map: [u8; 16] = *self.get(FMMU + 16 * number);
            let base = u64::from(u32::from_le_bytes([map[0], map[1], map[2], map[3]]));
            let length = u64::from(u16::from_le_bytes([map[4], map[5]]));
            let physical = u64::from(u16::from_le_bytes([map[8], map[9]]));
            let (from, to) = (base.max(start), (base + length).min(start + size));
            if map[12] & 1 == 0 || from >= to || physical + length > MEMORY as u64 {
                continue;
            }
            let place = |at: u64| usize::try_from(at).unwrap_or(0);
            let (inside, memory, bytes) = (place(from - start), place(physical + from - base), place(to - from));
            if reads && map[11] & 1 != 0 && self.may_read(memory, bytes) {
                datagram.data[inside..inside + bytes].copy_from_slice(&self.memory[memory..memory + bytes]);
                self.has_read(memory, bytes);
                counted[0] = true;
            }
            if writes && map[11] & 2 != 0 && self.may_write(memory, bytes) {
                let done = self.write(memory, &asked[inside..inside + bytes], 0);
                events.outputs |= done.outputs;
                counted[1] = true;
            }
        }
        let write = if reads { 2 } else { 1 };
        datagram.count(u16::from(counted[0]) + if counted[1] { write } else { 0 });
        events
    }

    /// Carries out a command of the EEPROM's interface: to read; no other is there.
    fn eeprom(&mut self) {
        let asked = self.word(EEPROM_CONTROL) >> 8 & 7;
        if asked == 1 {
            let address = self.word(EEPROM_ADDRESS);
            let bytes = self.rom_bytes(address, 4);
            self.set(EEPROM_DATA, &bytes);
        }
        // Done; a command that is not there is an error.
        self.set(EEPROM_CONTROL, &[0, if asked > 1 { 0x20 } else { 0 }]);
    }

    fn rom_bytes(&self, word: u16, count: usize) -> Vec<u8> {
        let from = 2 * usize::from(word);
        (from..from + count).map(|at| self.rom.get(at).copied().unwrap_or(0xff)).collect()
    }

    fn get<const N: usize>(&self, register: u16) -> &[u8; N] {
        const { assert!(N <= 16) };
        self.memory[usize::from(register)..].first_chunk().expect("registers lie below the end of the memory")
    }

    fn word(&self, register: u16) -> u16 {
        u16::from_le_bytes(*self.get(register))
    }

    fn set(&mut self, register: u16, bytes: &[u8]) {
        let at = usize::from(register);
        self.memory[at..at + bytes.len()].copy_from_slice(bytes);
    }
}
