//! A slave from INIT to SAFE-OP: of a drive what it can do, its maps, its watchdog, its clock; of a terminal the maps that it has.

use super::analog::{Analog, Mapped, Terminals};
use super::axis::{Axis, INPUTS_AT, ProcessData};
use super::cia402::{TORQUE_MODE, TORQUE_MODE_BIT, object};
use super::datagram::command;
use super::dictionary::{ASSIGNED, INPUTS, OUTPUTS, mapped};
use super::mailbox::{Abort, Object};
use super::registers::{
    COUNTS, DIVIDER, FEATURES, FMMU, HAS_CLOCK, INIT, PRE_OP, RECEIVE_TIME, RECEIVE_TIME_LOCAL, SAFE_OP,
    SYNC_ACTIVATION, SYNC_MANAGER, SYNC_START, SYNC0_CYCLE, SYSTEM_TIME, SYSTEM_TIME_OFFSET, TRIGGERS,
    WATCHDOG_DIVIDER, WATCHDOG_TIME,
};
use super::servo::{Layout, Servo, TerminalInputs};
use super::sii::{HAS_COE, word};
use super::station::{Segment, Station, broadcast};
use super::{Units, nearest};
use alloc::boxed::Box;
use alloc::format;
use alloc::string::String;
use alloc::vec;
use alloc::vec::Vec;

/// Most entries of a map.
const MOST_ENTRIES: u8 = 64;
/// Share by which the stated torque may be off the drive's.
const SAME: f64 = 0.01;

impl Station<'_> {
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
                f64::from(nearest(units.rated_torque * 1000.0)) / 1000.0
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
        for (place, size) in sizes.iter_mut().enumerate() {
            let Some(sensor) = units.own(place) else { continue };
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

    /// Brings a slave from anywhere to PRE-OP, with its mailboxes: start and control of its outputs' and inputs' sync managers.
    fn begin(&mut self) -> Result<[(u16, u8); 2], String> {
        self.enter(INIT, "INIT")?;
        // Of an earlier master nothing is left, no message either.
        let [fmmus, managers] = self.read(COUNTS)?;
        self.write(FMMU, &vec![0; 16 * usize::from(fmmus)])?;
        self.write(SYNC_MANAGER, &vec![0; 8 * usize::from(managers)])?;
        let protocols = self.rom(word::PROTOCOLS)?[0];
        if protocols & HAS_COE == 0 {
            return Err(format!("expected a mailbox with CoE, got protocols 0x{protocols:04x}; use another slave"));
        }
        self.mailbox = [self.rom(word::MAILBOX)?, self.rom(word::MAILBOX + 2)?];
        let managers = self.managers()?;
        let &[(_, _, out), (_, _, into), (outputs, _, writes), (inputs, _, reads), ..] = managers.as_slice() else {
            return Err(format!("expected 4 sync managers, got {}; use another slave", managers.len()));
        };
        for (number, [start, size], control) in [(0, self.mailbox[0], out), (1, self.mailbox[1], into)] {
            self.manager(number, start, size, control)?;
        }
        self.enter(PRE_OP, "PRE-OP")?;
        Ok([(outputs, writes), (inputs, reads)])
    }

    /// Gives its process data to their sync managers, and to logical addresses where there is one.
    fn process_data(&mut self, managers: [(u16, u8); 2], sizes: [u16; 2], at: [Option<u32>; 2]) -> Result<(), String> {
        for (place, number, triggers, kind) in [(0, 2, TRIGGERS, 2), (1, 3, 0, 1)] {
            let ((start, control), size) = (managers[place], sizes[place]);
            if size == 0 {
                continue;
            }
            // Outputs that nobody writes have no watchdog.
            self.manager(number, start, size, control & !TRIGGERS | if at[place].is_some() { triggers } else { 0 })?;
            if let Some(logical) = at[place] {
                self.fmmu(number - 2, logical, start, size, kind)?;
            }
        }
        Ok(())
    }

    /// Brings a drive to SAFE-OP, with its process data at logical addresses from `base`; `reference` is the station of the reference clock.
    /// Returns the drive, and the station of its reference clock.
    fn start_drive(
        &mut self,
        units: &Units,
        watchdog_s: f64,
        period_s: Option<f64>,
        base: u32,
        reference: Option<u16>,
    ) -> Result<(Servo, Option<u16>), String> {
        let managers = self.begin()?;
        self.check(units)?;
        let servo = Servo::new(*units, self.layout(units)?);
        self.download(object::MODE, &[TORQUE_MODE])?;
        self.watchdog(watchdog_s)?;
        self.process_data(managers, servo.sizes(), [Some(base), Some(base + INPUTS_AT)])?;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a period of milliseconds")]
        let period_ns = period_s.map(|period_s| (1e9 * period_s) as u32).filter(|period| *period > 0);
        let clock = self.clock(reference, period_ns)?;
        self.enter(SAFE_OP, "SAFE-OP")?;
        Ok((servo, clock.then_some(reference.unwrap_or(self.address))))
    }

    /// The map of a terminal's outputs or inputs, as it has it.
    fn mapped(&mut self, place: usize) -> Result<Mapped, String> {
        let assigned = ASSIGNED[place];
        let (mut map, mut bits) = (Mapped::default(), 0);
        for part in 1..=self.count(assigned)? {
            let part = self.number(Object::new(assigned, part))?.and_then(|part| u16::try_from(part).ok()).unwrap_or(0);
            for entry in 1..=self.count(part)? {
                let [size, sub, low, high] = self.number(Object::new(part, entry))?.unwrap_or(0).to_le_bytes();
                map.objects.push((Object::new(u16::from_le_bytes([low, high]), sub), bits, size.into()));
                bits += usize::from(size);
            }
        }
        map.bytes = u16::try_from(bits.div_ceil(8)).unwrap_or(u16::MAX);
        Ok(map)
    }

    /// Number of entries of an object.
    fn count(&mut self, index: u16) -> Result<u8, String> {
        let count = self.number(Object::new(index, 0))?.unwrap_or(0);
        u8::try_from(count).ok().filter(|count| *count <= MOST_ENTRIES).ok_or_else(|| {
            format!("0x{index:04X}: expected at most {MOST_ENTRIES} entries, got {count}; use another terminal")
        })
    }

    /// Brings a terminal to SAFE-OP, with outputs and inputs at logical addresses where there is one: their maps.
    fn start_terminal(&mut self, watchdog_s: f64, at: [Option<u32>; 2]) -> Result<[Mapped; 2], String> {
        let managers = self.begin()?;
        let maps = [self.mapped(0)?, self.mapped(1)?];
        if at[0].is_some() {
            self.watchdog(watchdog_s)?;
        }
        self.process_data(managers, [maps[0].bytes, maps[1].bytes], at)?;
        self.enter(SAFE_OP, "SAFE-OP")?;
        Ok(maps)
    }
}

/// Brings a drive, and the terminal with its force sensors if it has one, to SAFE-OP, with process data at logical addresses from `base`;
/// `reference` is the station of the reference clock.
///
/// # Errors
/// What was expected of them.
pub fn start_drive(
    segment: &mut dyn Segment,
    [drive, input]: [u16; 2],
    units: &Units,
    watchdog_s: f64,
    period_s: Option<f64>,
    base: u32,
    reference: Option<u16>,
) -> Result<Axis, String> {
    let mut station = Station::new(segment, drive);
    let mut stations = [Some(station.address), None];
    let (mut servo, clock) = station.start_drive(units, watchdog_s, period_s, base, reference)?;
    if let Some(node) = units.input_node {
        let named = |why| format!("input_node {node}: {why}");
        if input == drive {
            return Err(named(
                "expected another slave than the drive; leave it out if the drive has the sensors".into(),
            ));
        }
        let mut station = Station::new(segment, input);
        stations[1] = Some(station.address);
        let behind = base + INPUTS_AT + u32::from(servo.own_inputs());
        let [_, map] = station.start_terminal(watchdog_s, [None, Some(behind)]).map_err(named)?;
        servo = servo.with(Some(TerminalInputs::new(units, &map).map_err(named)?));
    }
    Ok(Axis::new(stations, base, Box::new(servo), clock))
}

/// Brings the terminals of a valve at two positions, which may be one, to SAFE-OP, with process data at logical addresses from `base`.
///
/// # Errors
/// What was expected of them.
pub fn start_terminals(
    segment: &mut dyn Segment,
    positions: [u16; 2],
    analog: &Analog,
    watchdog_s: f64,
    base: u32,
) -> Result<Axis, String> {
    let [output, input] = positions;
    let both = output == input;
    let mut station = Station::new(segment, output);
    let mut stations = [Some(station.address), None];
    let [outputs, mut inputs] = station.start_terminal(watchdog_s, [Some(base), both.then_some(base + INPUTS_AT)])?;
    if !both {
        let mut station = Station::new(segment, input);
        stations[1] = Some(station.address);
        let started = station.start_terminal(watchdog_s, [None, Some(base + INPUTS_AT)]);
        [_, inputs] = started.map_err(|why| format!("input_node {}: {why}", analog.input_node))?;
    }
    Ok(Axis::new(stations, base, Box::new(Terminals::new(analog, [&outputs, &inputs])?), None))
}
