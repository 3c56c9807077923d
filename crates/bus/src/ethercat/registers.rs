//! Registers of a slave controller, states and codes of the application layer (ETG.1000.4, ETG.1000.6).
#![expect(missing_docs, reason = "names of the standard")]

/// Number of FMMUs, and of sync managers.
pub const COUNTS: u16 = 0x0004;
pub const FEATURES: u16 = 0x0008;
pub const STATION: u16 = 0x0010;
pub const ALIAS: u16 = 0x0012;
pub const DL_STATUS: u16 = 0x0110;
pub const AL_CONTROL: u16 = 0x0120;
pub const AL_STATUS: u16 = 0x0130;
pub const AL_CODE: u16 = 0x0134;
pub const WATCHDOG_DIVIDER: u16 = 0x0400;
pub const WATCHDOG_TIME: u16 = 0x0420;
pub const WATCHDOG_STATUS: u16 = 0x0440;
pub const EEPROM_ACCESS: u16 = 0x0500;
pub const EEPROM_CONTROL: u16 = 0x0502;
pub const EEPROM_ADDRESS: u16 = 0x0504;
pub const EEPROM_DATA: u16 = 0x0508;
pub const FMMU: u16 = 0x0600;
pub const SYNC_MANAGER: u16 = 0x0800;
pub const RECEIVE_TIME: u16 = 0x0900;
pub const SYSTEM_TIME: u16 = 0x0910;
pub const RECEIVE_TIME_LOCAL: u16 = 0x0918;
pub const SYSTEM_TIME_OFFSET: u16 = 0x0920;
pub const SYNC_ACTIVATION: u16 = 0x0981;
pub const SYNC_START: u16 = 0x0990;
pub const SYNC0_CYCLE: u16 = 0x09a0;

/// Bit of the features: distributed clocks.
pub const HAS_CLOCK: u16 = 1 << 2;

pub const INIT: u8 = 1;
pub const PRE_OP: u8 = 2;
pub const SAFE_OP: u8 = 4;
pub const OP: u8 = 8;
/// In the status an error, in the control its acknowledgment.
pub const ERROR: u8 = 0x10;

/// Code of the application layer: the process data's watchdog.
pub const WATCHDOG_CODE: u16 = 0x001b;

/// Divider of 25 MHz with which the watchdog counts 100 us.
pub const DIVIDER: u16 = 2498;

/// Control of a sync manager: a mailbox, the master writes, interrupt at the drive, and the watchdog.
pub const MAILBOX: u8 = 0x02;
pub const MASTER_WRITES: u8 = 0x04;
pub const TRIGGERS: u8 = 0x40;
