//! A slave by its station address, for what is waited for: registers, EEPROM, states, objects.

use super::datagram::{Packet, at, command, datagrams};
use super::mailbox::{Abort, Object, Request, answered};
use super::registers::{
    AL_CONTROL, AL_STATUS, ALIAS, EEPROM_ACCESS, EEPROM_CONTROL, EEPROM_DATA, ERROR, FMMU, INIT, STATION, SYNC_MANAGER,
};
use super::sii::{END, SYNC_MANAGERS, word};
use crate::drive::Identity;
use crate::fault::Fault;
use alloc::format;
use alloc::string::String;
use alloc::vec;
use alloc::vec::Vec;

/// The wire with its slaves, for what is waited for.
pub trait Segment {
    /// Sends a frame and waits for it, in place: whether it came back.
    fn exchange(&mut self, packet: &mut Packet) -> bool;
    /// Rests for a millisecond.
    fn rest(&mut self);
}

/// Station address of the first slave, less its position.
const FIRST_STATION: u16 = 0x1000;
/// How often a frame is sent, and a state or an answer is waited for, in ms.
const TRIES: usize = 3;
const PATIENCE: usize = 3000;
/// How often all slaves are asked before there are none: an interface that has just come up carries nothing for up to a second.
const WAKES: usize = 16;
/// Most slaves of a line, and most words of an EEPROM that are looked at.
const MOST_SLAVES: u16 = 127;
const MOST_WORDS: u16 = 0x4000;
/// Bytes of all FMMUs that a slave may have.
const FMMU_BYTES: usize = 256;

/// Aliases of all slaves by position, each of which has a station address now.
///
/// # Errors
/// If there is none.
pub fn scan(segment: &mut dyn Segment) -> Result<Vec<u16>, String> {
    let count = (0..WAKES).map(|_| broadcast(segment, command::BRD, 0, &[0; 2])).find(|&count| count > 0).unwrap_or(0);
    if count == 0 {
        return Err("expected slaves, got no answer; check that the interface is up, cable and power".into());
    }
    // Its EEPROM is the master's.
    broadcast(segment, command::BWR, EEPROM_ACCESS, &[2]);
    broadcast(segment, command::BWR, EEPROM_ACCESS, &[0]);
    // No slave keeps an address that another is about to get.
    broadcast(segment, command::BWR, STATION, &[0; 2]);
    // Nor takes part in another's process data: what it had mapped before is gone.
    broadcast(segment, command::BWR, FMMU, &[0; FMMU_BYTES]);
    let positions = 1..=count.min(MOST_SLAVES);
    let aliases = positions.map(|position| {
        let mut packet = Packet::of(
            command::APWR,
            0,
            at(1_u16.wrapping_sub(position), STATION),
            &(FIRST_STATION + position).to_le_bytes(),
        );
        segment.exchange(&mut packet);
        Station::new(segment, position).word(ALIAS)
    });
    aliases.collect()
}

pub(super) fn broadcast(segment: &mut dyn Segment, command: u8, register: u16, data: &[u8]) -> u16 {
    let counted = (0..TRIES).map(|_| {
        let mut packet = Packet::of(command, 0, at(0, register), data);
        if segment.exchange(&mut packet) { datagrams(&mut packet.bytes).next().map_or(0, |it| it.counter()) } else { 0 }
    });
    counted.max().unwrap_or(0)
}

/// Tells all slaves to be still: INIT.
pub fn stop_all(segment: &mut dyn Segment) {
    broadcast(segment, command::BWR, AL_CONTROL, &[INIT | ERROR, 0]);
}

/// A slave by its station address.
pub struct Station<'a> {
    pub(super) segment: &'a mut dyn Segment,
    pub(super) address: u16,
    /// Start and size of the mailboxes, out and in.
    pub(super) mailbox: [[u16; 2]; 2],
    counter: u8,
}

impl<'a> Station<'a> {
    /// The slave at a position, counted from one, after a [`scan`].
    pub fn new(segment: &'a mut dyn Segment, position: u16) -> Self {
        Self { segment, address: FIRST_STATION + position, mailbox: [[0; 2]; 2], counter: 0 }
    }

    /// What a datagram brings, and its working counter; nothing if it is lost.
    fn datagram(&mut self, command: u8, register: u16, data: &[u8]) -> Option<(Vec<u8>, u16)> {
        let mut packet = Packet::of(command, 0, at(self.address, register), data);
        let came = self.segment.exchange(&mut packet);
        let datagram = datagrams(&mut packet.bytes).next().filter(|_| came)?;
        Some((datagram.data.to_vec(), datagram.counter()))
    }

    fn access(&mut self, command: u8, register: u16, data: &[u8]) -> Result<Vec<u8>, String> {
        for _ in 0..TRIES {
            if let Some((came, 1)) = self.datagram(command, register, data) {
                return Ok(came);
            }
        }
        Err(format!("no answer of register 0x{register:04x}; check cable and power"))
    }

    pub(super) fn read<const N: usize>(&mut self, register: u16) -> Result<[u8; N], String> {
        let bytes = self.access(command::FPRD, register, &[0; N])?;
        bytes.try_into().map_err(|_| format!("register 0x{register:04x}: expected {N} bytes"))
    }

    pub(super) fn word(&mut self, register: u16) -> Result<u16, String> {
        self.read(register).map(u16::from_le_bytes)
    }

    pub(super) fn write(&mut self, register: u16, data: &[u8]) -> Result<(), String> {
        self.access(command::FPWR, register, data).map(|_| ())
    }

    /// Two words of the EEPROM.
    pub(super) fn rom(&mut self, word: u16) -> Result<[u16; 2], String> {
        let [low, high] = word.to_le_bytes();
        self.write(EEPROM_CONTROL, &[0, 1, low, high, 0, 0])?;
        for _ in 0..PATIENCE {
            if self.word(EEPROM_CONTROL)? & 0x8000 == 0 {
                let [a, b, c, d] = self.read(EEPROM_DATA)?;
                return Ok([u16::from_le_bytes([a, b]), u16::from_le_bytes([c, d])]);
            }
            self.segment.rest();
        }
        Err("the EEPROM stays busy; check the slave".into())
    }

    fn rom_number(&mut self, word: u16) -> Result<u32, String> {
        self.rom(word).map(|[low, high]| u32::from(high) << 16 | u32::from(low))
    }

    /// What it states of itself.
    ///
    /// # Errors
    /// If it does not answer.
    pub fn identity(&mut self, node: u8) -> Result<Identity, String> {
        let [vendor, model, firmware, serial] = [0, 2, 4, 6].map(|more| self.rom_number(word::VENDOR + more));
        Ok(Identity { node, model: model?, firmware: firmware?, registers: vendor?, serial: [0, 0, serial?] })
    }

    /// Start and control of each sync manager by the EEPROM.
    pub(super) fn managers(&mut self) -> Result<Vec<(u16, u16, u8)>, String> {
        let mut at = word::CATEGORIES;
        while at < MOST_WORDS {
            let [kind, size] = self.rom(at)?;
            if kind == SYNC_MANAGERS {
                let rows = (0..size / 4).map(|row| {
                    let [start, length] = self.rom(at + 2 + 4 * row)?;
                    Ok((start, length, self.rom(at + 4 + 4 * row)?[0].to_le_bytes()[0]))
                });
                return rows.collect();
            }
            if kind == END {
                break;
            }
            at = at.saturating_add(size).saturating_add(2);
        }
        Err("expected sync managers in the EEPROM, got none; write it with the maker's tool".into())
    }

    /// Asks for a state, and waits for it.
    pub(super) fn enter(&mut self, state: u8, name: &str) -> Result<(), String> {
        self.write(AL_CONTROL, &[state | if state == INIT { ERROR } else { 0 }, 0])?;
        for _ in 0..PATIENCE {
            let [status, _, _, _, low, high] = self.read(AL_STATUS)?;
            if status == state {
                return Ok(());
            }
            if status & ERROR != 0 && state != INIT {
                let code = u16::from_le_bytes([low, high]);
                return Err(format!("expected {name}, got code 0x{code:04x}: {}", Fault::of_al(code)));
            }
            self.segment.rest();
        }
        Err(format!("expected {name}, got no change of its state; check the slave"))
    }

    /// Sends a request through the mailbox, and waits for its answer.
    fn request(&mut self, object: Object, request: &Request) -> Result<Result<Vec<u8>, Abort>, String> {
        let [[out, out_size], [into, in_size]] = self.mailbox;
        self.counter = self.counter % 7 + 1;
        self.write(out, &request.message(self.counter, usize::from(out_size)))?;
        for _ in 0..PATIENCE {
            let message = self.datagram(command::FPRD, into, &vec![0; usize::from(in_size)]);
            // A message of another matter, such as an emergency, is left.
            if let Some(outcome) = message.filter(|(_, count)| *count == 1).and_then(|(it, _)| answered(&it, object)) {
                return Ok(outcome);
            }
            self.segment.rest();
        }
        Err(format!("{object}: no answer from the mailbox; check the slave"))
    }

    pub(super) fn upload(&mut self, object: Object) -> Result<Result<Vec<u8>, Abort>, String> {
        self.request(object, &Request::Upload(object))
    }

    pub(super) fn download(&mut self, object: Object, value: &[u8]) -> Result<(), String> {
        let outcome = self.request(object, &Request::Download(object, value.to_vec()))?;
        outcome
            .map(|_| ())
            .map_err(|Abort(code)| format!("{object}: the drive refuses {value:02x?} with abort code 0x{code:08x}"))
    }

    /// An unsigned number of at most 32 bits; nothing where the drive lacks the object.
    pub(super) fn number(&mut self, object: Object) -> Result<Option<u32>, String> {
        let value = self.upload(object)?;
        Ok(value.ok().map(|value| value.iter().rev().fold(0, |number, &byte| number << 8 | u32::from(byte))))
    }

    pub(super) fn manager(&mut self, number: u16, start: u16, size: u16, control: u8) -> Result<(), String> {
        let ([a, b], [c, d]) = (start.to_le_bytes(), size.to_le_bytes());
        self.write(SYNC_MANAGER + 8 * number, &[a, b, c, d, control, 0, 1, 0])
    }

    /// Has logical bytes be those of a sync manager: `kind` 1 is read, 2 is written.
    pub(super) fn fmmu(&mut self, number: u16, logical: u32, start: u16, size: u16, kind: u8) -> Result<(), String> {
        let mut map = [0; 16];
        map[..4].copy_from_slice(&logical.to_le_bytes());
        map[4..6].copy_from_slice(&size.to_le_bytes());
        map[7] = 7;
        map[8..10].copy_from_slice(&start.to_le_bytes());
        (map[11], map[12]) = (kind, 1);
        self.write(FMMU + 16 * number, &map)
    }
}
