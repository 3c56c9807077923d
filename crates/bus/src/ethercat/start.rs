//! The master before the cycle: who is there, and a drive from INIT to SAFE-OP, with its maps, its watchdog and its clock.

use super::Units;
use super::axis::{Axis, Layout};
use super::cia402::{TORQUE_MODE, TORQUE_MODE_BIT, object};
use super::datagram::{Packet, at, command, datagrams};
use super::dictionary::{ASSIGNED, INPUTS, OUTPUTS, mapped};
use super::mailbox::{Abort, Object, Request, answered};
use super::registers::{
    AL_CONTROL, AL_STATUS, ALIAS, COUNTS, DIVIDER, EEPROM_ACCESS, EEPROM_CONTROL, EEPROM_DATA, ERROR, FEATURES, FMMU,
    HAS_CLOCK, INIT, PRE_OP, RECEIVE_TIME, RECEIVE_TIME_LOCAL, SAFE_OP, STATION, SYNC_ACTIVATION, SYNC_MANAGER,
    SYNC_START, SYNC0_CYCLE, SYSTEM_TIME, SYSTEM_TIME_OFFSET, TRIGGERS, WATCHDOG_DIVIDER, WATCHDOG_TIME,
};
use super::sii::{END, HAS_COE, SYNC_MANAGERS, word};
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
/// Most slaves of a line, and most words of an EEPROM that are looked at.
const MOST_SLAVES: u16 = 127;
const MOST_WORDS: u16 = 0x4000;
/// Share by which the stated torque may be off the drive's.
const SAME: f64 = 0.01;

/// Aliases of all slaves by position, each of which has a station address now.
///
/// # Errors
/// If there is none.
pub fn scan(segment: &mut dyn Segment) -> Result<Vec<u16>, String> {
    let count = broadcast(segment, command::BRD, 0, &[0; 2]);
    if count == 0 {
        return Err("expected slaves, got no answer; check that the interface is up, cable and power".into());
    }
    // Its EEPROM is the master's.
    broadcast(segment, command::BWR, EEPROM_ACCESS, &[2]);
    broadcast(segment, command::BWR, EEPROM_ACCESS, &[0]);
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

fn broadcast(segment: &mut dyn Segment, command: u8, register: u16, data: &[u8]) -> u16 {
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
    segment: &'a mut dyn Segment,
    address: u16,
    /// Start and size of the mailboxes, out and in.
    mailbox: [[u16; 2]; 2],
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

    fn read<const N: usize>(&mut self, register: u16) -> Result<[u8; N], String> {
        let bytes = self.access(command::FPRD, register, &[0; N])?;
        bytes.try_into().map_err(|_| format!("register 0x{register:04x}: expected {N} bytes"))
    }

    fn word(&mut self, register: u16) -> Result<u16, String> {
        self.read(register).map(u16::from_le_bytes)
    }

    fn write(&mut self, register: u16, data: &[u8]) -> Result<(), String> {
        self.access(command::FPWR, register, data).map(|_| ())
    }

    /// Two words of the EEPROM.
    fn rom(&mut self, word: u16) -> Result<[u16; 2], String> {
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
    fn managers(&mut self) -> Result<Vec<(u16, u16, u8)>, String> {
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
    fn enter(&mut self, state: u8, name: &str) -> Result<(), String> {
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

    fn upload(&mut self, object: Object) -> Result<Result<Vec<u8>, Abort>, String> {
        self.request(object, &Request::Upload(object))
    }

    fn download(&mut self, object: Object, value: &[u8]) -> Result<(), String> {
        let outcome = self.request(object, &Request::Download(object, value.to_vec()))?;
        outcome
            .map(|_| ())
            .map_err(|Abort(code)| format!("{object}: the drive refuses {value:02x?} with abort code 0x{code:08x}"))
    }

    /// An unsigned number of at most 32 bits; nothing where the drive lacks the object.
    fn number(&mut self, object: Object) -> Result<Option<u32>, String> {
        let value = self.upload(object)?;
        Ok(value.ok().map(|value| value.iter().rev().fold(0, |number, &byte| number << 8 | u32::from(byte))))
    }

    /// Writes a map and gives it to its sync manager; objects that need not be there are left out where they cannot be mapped.
    fn map(&mut self, place: usize, objects: &[(Object, u32, bool)]) -> Result<Vec<Object>, String> {
        let (map, assigned) = ([OUTPUTS, INPUTS][place], ASSIGNED[place]);
        self.download(Object::new(assigned, 0), &[0])?;
        self.download(Object::new(map, 0), &[0])?;
        let (mut count, mut kept) = (0_u8, vec![]);
        for &(object, bits, needed) in objects {
            let written = self.download(Object::new(map, count + 1), &mapped(object, bits).to_le_bytes());
            if needed {
                written.map_err(|why| format!("{object} cannot be mapped: {why}"))?;
            } else if written.is_err() {
                continue;
            }
            count += 1;
            kept.push(object);
        }
        self.download(Object::new(map, 0), &[count])?;
        self.download(Object::new(assigned, 1), &map.to_le_bytes())?;
        self.download(Object::new(assigned, 0), &[1])?;
        Ok(kept)
    }

    /// Refuses a drive without the mode, or with another rated torque.
    fn check(&mut self, units: &Units) -> Result<(), String> {
        let modes = self.number(object::SUPPORTED_MODES)?.unwrap_or(0);
        if modes & TORQUE_MODE_BIT == 0 {
            return Err(format!(
                "expected a drive with cyclic synchronous torque, bit 9 of 0x6502, got 0x{modes:08x}; use another drive"
            ));
        }
        // In mN m; a drive that states none has zero, or lacks it.
        let rated = self.number(object::RATED_TORQUE)?.map_or(0.0, |rated| f64::from(rated) / 1000.0);
        let off = if rated < units.rated_torque { units.rated_torque - rated } else { rated - units.rated_torque };
        if rated > 0.0 && off > SAME * rated {
            return Err(format!(
                "rated_torque: expected the drive's own, 0x6076, {rated} N m, got {} N m; change [bus]",
                units.rated_torque
            ));
        }
        Ok(())
    }

    /// Maps the process data.
    fn layout(&mut self, units: &Units) -> Result<Layout, String> {
        let outputs = [(object::CONTROL, 16, true), (object::TARGET_TORQUE, 16, true), (object::MODE, 8, true)];
        self.map(0, &outputs)?;
        let mut inputs = vec![
            (object::STATUS, 16, true),
            (object::POSITION, 32, true),
            (object::VELOCITY, 32, true),
            (object::TORQUE, 16, true),
            (object::MODE_DISPLAY, 8, true),
        ];
        let mut sizes = [0; 3];
        for (size, sensor) in sizes.iter_mut().zip(units.sensors) {
            let Some(sensor) = sensor else { continue };
            let value = self.upload(sensor)?.map_err(|Abort(code)| {
                format!("{sensor}: expected a sensor's object, got abort code 0x{code:08x}; change [bus]")
            })?;
            *size = value.len().min(4);
            inputs.push((sensor, u32::try_from(8 * *size).unwrap_or(0), true));
        }
        inputs.push((object::ERROR_CODE, 16, false));
        let kept = self.map(1, &inputs)?;
        Ok(Layout { sensors: sizes, error_code: kept.contains(&object::ERROR_CODE) })
    }

    /// Sets the watchdog of the outputs' sync manager, in s, and reads it back.
    fn watchdog(&mut self, watchdog_s: f64) -> Result<(), String> {
        let ticks = u16::try_from(super::nearest(1e4 * watchdog_s).max(1)).unwrap_or(u16::MAX);
        self.write(WATCHDOG_DIVIDER, &DIVIDER.to_le_bytes())?;
        self.write(WATCHDOG_TIME, &ticks.to_le_bytes())?;
        let kept = [self.word(WATCHDOG_DIVIDER)?, self.word(WATCHDOG_TIME)?];
        if kept != [DIVIDER, ticks] {
            return Err(format!("watchdog: expected {DIVIDER} and {ticks} in its registers, got {kept:?}"));
        }
        Ok(())
    }

    fn manager(&mut self, number: u16, start: u16, size: u16, control: u8) -> Result<(), String> {
        let ([a, b], [c, d]) = (start.to_le_bytes(), size.to_le_bytes());
        self.write(SYNC_MANAGER + 8 * number, &[a, b, c, d, control, 0, 1, 0])
    }

    /// Has logical bytes be those of a sync manager: `kind` 1 is read, 2 is written.
    fn fmmu(&mut self, number: u16, logical: u32, start: u16, size: u16, kind: u8) -> Result<(), String> {
        let mut map = [0; 16];
        map[..4].copy_from_slice(&logical.to_le_bytes());
        map[4..6].copy_from_slice(&size.to_le_bytes());
        map[7] = 7;
        map[8..10].copy_from_slice(&start.to_le_bytes());
        (map[11], map[12]) = (kind, 1);
        self.write(FMMU + 16 * number, &map)
    }

    /// Sets the slave's clock by that of a reference, and its interrupt to a period in ns; whether it has a clock.
    ///
    /// Both latch the time at which a frame passes; the frame's time from slave to slave, below a microsecond, is left out.
    fn clock(&mut self, reference: Option<u16>, period_ns: Option<u32>) -> Result<bool, String> {
        if self.word(FEATURES)? & HAS_CLOCK == 0 {
            return Ok(false);
        }
        broadcast(self.segment, command::BWR, RECEIVE_TIME, &[0; 4]);
        let its = self.read(RECEIVE_TIME_LOCAL).map(u64::from_le_bytes)?;
        let offset = match reference.filter(|reference| *reference != self.address) {
            None => 0,
            Some(reference) => {
                let own = core::mem::replace(&mut self.address, reference);
                let latched = self.read(RECEIVE_TIME_LOCAL).map(u64::from_le_bytes);
                self.address = own;
                latched?.wrapping_sub(its)
            }
        };
        self.write(SYSTEM_TIME_OFFSET, &offset.to_le_bytes())?;
        self.write(SYNC_ACTIVATION, &[0])?;
        if let Some(period_ns) = period_ns {
            let now = self.read(SYSTEM_TIME).map(u64::from_le_bytes)?;
            let period = u64::from(period_ns);
            let begins = (now / period).wrapping_add(100).wrapping_mul(period);
            self.write(SYNC0_CYCLE, &period_ns.to_le_bytes())?;
            self.write(SYNC_START, &begins.to_le_bytes())?;
            self.write(SYNC_ACTIVATION, &[3])?;
        }
        Ok(true)
    }

    /// Brings a drive to SAFE-OP, with its process data at logical addresses from `base`; `reference` is the station whose clock counts.
    ///
    /// # Errors
    /// What was expected of it.
    pub fn start(
        mut self,
        units: &Units,
        watchdog_s: f64,
        period_s: Option<f64>,
        base: u32,
        reference: Option<u16>,
    ) -> Result<Axis, String> {
        self.enter(INIT, "INIT")?;
        // Of an earlier master nothing is left, no message either.
        let [fmmus, managers] = self.read(COUNTS)?;
        self.write(FMMU, &vec![0; 16 * usize::from(fmmus)])?;
        self.write(SYNC_MANAGER, &vec![0; 8 * usize::from(managers)])?;
        let protocols = self.rom(word::PROTOCOLS)?[0];
        if protocols & HAS_COE == 0 {
            return Err(format!("expected a mailbox with CoE, got protocols 0x{protocols:04x}; use another drive"));
        }
        self.mailbox = [self.rom(word::MAILBOX)?, self.rom(word::MAILBOX + 2)?];
        let managers = self.managers()?;
        let &[(_, _, out), (_, _, into), (outputs, _, writes), (inputs, _, reads), ..] = managers.as_slice() else {
            return Err(format!("expected 4 sync managers, got {}; use another drive", managers.len()));
        };
        for (number, [start, size], control) in [(0, self.mailbox[0], out), (1, self.mailbox[1], into)] {
            self.manager(number, start, size, control)?;
        }
        self.enter(PRE_OP, "PRE-OP")?;
        self.check(units)?;
        let layout = self.layout(units)?;
        self.download(object::MODE, &[TORQUE_MODE])?;
        self.watchdog(watchdog_s)?;
        let [written, read] = layout.sizes();
        self.manager(2, outputs, written, writes | TRIGGERS)?;
        self.manager(3, inputs, read, reads)?;
        self.fmmu(0, base, outputs, written, 2)?;
        self.fmmu(1, base + u32::from(written), inputs, read, 1)?;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a period of milliseconds")]
        let period_ns = period_s.map(|period_s| (1e9 * period_s) as u32).filter(|period| *period > 0);
        let clock = self.clock(reference, period_ns)?;
        self.enter(SAFE_OP, "SAFE-OP")?;
        Ok(Axis::new(self.address, base, *units, layout, clock.then_some(reference.unwrap_or(self.address))))
    }
}
