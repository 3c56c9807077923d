//! A drive from INIT to SAFE-OP: what it can do, its maps, its watchdog, its clock.

use super::Units;
use super::axis::{Axis, Layout};
use super::cia402::{TORQUE_MODE, TORQUE_MODE_BIT, object};
use super::datagram::command;
use super::dictionary::{ASSIGNED, INPUTS, OUTPUTS, mapped};
use super::mailbox::{Abort, Object};
use super::registers::{
    COUNTS, DIVIDER, FEATURES, FMMU, HAS_CLOCK, INIT, PRE_OP, RECEIVE_TIME, RECEIVE_TIME_LOCAL, SAFE_OP,
    SYNC_ACTIVATION, SYNC_MANAGER, SYNC_START, SYNC0_CYCLE, SYSTEM_TIME, SYSTEM_TIME_OFFSET, TRIGGERS,
    WATCHDOG_DIVIDER, WATCHDOG_TIME,
};
use super::sii::{HAS_COE, word};
use super::station::{Station, broadcast};
use alloc::format;
use alloc::string::String;
use alloc::vec;
use alloc::vec::Vec;

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
