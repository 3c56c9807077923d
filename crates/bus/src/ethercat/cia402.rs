//! The drive profile CiA 402 (IEC 61800-7-201): objects, control and status word, cyclic synchronous torque.
//!
//! | control | status, of 0x6f | |
//! |---|---|---|
//! | 0x06 | 0x21 | ready to switch on |
//! | 0x07 | 0x23 | switched on |
//! | 0x0f | 0x27 | operation enabled: the torque acts |
//! | 0x80, rising | 0x40, of 0x4f | out of a fault, 0x08 of 0x4f, to switch on disabled |

use super::mailbox::Object;

/// Objects of the profile.
pub mod object {
    #![expect(missing_docs, reason = "names of the standard")]
    use super::Object;
    pub const ERROR_CODE: Object = Object::new(0x603f, 0);
    pub const CONTROL: Object = Object::new(0x6040, 0);
    pub const STATUS: Object = Object::new(0x6041, 0);
    pub const FAULT_REACTION: Object = Object::new(0x605e, 0);
    pub const MODE: Object = Object::new(0x6060, 0);
    pub const MODE_DISPLAY: Object = Object::new(0x6061, 0);
    pub const POSITION: Object = Object::new(0x6064, 0);
    pub const VELOCITY: Object = Object::new(0x606c, 0);
    pub const TARGET_TORQUE: Object = Object::new(0x6071, 0);
    pub const RATED_TORQUE: Object = Object::new(0x6076, 0);
    pub const TORQUE: Object = Object::new(0x6077, 0);
    pub const SUPPORTED_MODES: Object = Object::new(0x6502, 0);
}

/// Cyclic synchronous torque: the mode, and its bit of the supported ones.
pub const TORQUE_MODE: u8 = 10;
/// As in 0x6502.
pub const TORQUE_MODE_BIT: u32 = 1 << 9;
/// Error code of a lost communication.
pub const COMMUNICATION: u16 = 0x7500;
/// Torque that is rated, in the unit of target and actual torque.
pub const RATED: f64 = 1000.0;

const SHUTDOWN: u16 = 0x06;
const SWITCH_ON: u16 = 0x07;
const ENABLE: u16 = 0x0f;
const RESET: u16 = 0x80;

/// Power state of a drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Power {
    /// It cannot be switched on yet.
    NotReady,
    /// It waits for a shutdown.
    Disabled,
    /// Ready to switch on.
    Ready,
    /// Switched on.
    SwitchedOn,
    /// The torque acts.
    Enabled,
    /// It comes to rest.
    QuickStop,
    /// A fault, with the reaction to it under way or over.
    Fault,
}

impl Power {
    /// That of a status word.
    pub fn of(status: u16) -> Self {
        match (status & 0x4f, status & 0x6f) {
            (0x40, _) => Self::Disabled,
            (0x08 | 0x0f, _) => Self::Fault,
            (_, 0x21) => Self::Ready,
            (_, 0x23) => Self::SwitchedOn,
            (_, 0x27) => Self::Enabled,
            (_, 0x07) => Self::QuickStop,
            _ => Self::NotReady,
        }
    }

    /// Status word, with the supply there.
    pub fn status(self) -> u16 {
        0x10 | match self {
            Self::NotReady => 0x00,
            Self::Disabled => 0x40,
            Self::Ready => 0x21,
            Self::SwitchedOn => 0x23,
            Self::Enabled => 0x27,
            Self::QuickStop => 0x07,
            Self::Fault => 0x08,
        }
    }

    /// Control word that leads on from here; a fault is cleared only where the drive is to stop, by an edge that `odd` cycles make.
    pub fn control(self, enable: bool, odd: bool) -> u16 {
        match self {
            Self::Fault if !enable && odd => RESET,
            Self::Fault | Self::QuickStop | Self::NotReady => 0,
            Self::Ready if enable => SWITCH_ON,
            Self::SwitchedOn | Self::Enabled if enable => ENABLE,
            _ => SHUTDOWN,
        }
    }

    /// Where a drive goes at a control word after another.
    pub fn next(self, control: u16, before: u16) -> Self {
        if self == Self::Fault {
            return if control & !before & RESET == 0 { self } else { Self::Disabled };
        }
        let [shutdown, switch_on, enable] = [SHUTDOWN, SWITCH_ON, ENABLE].map(|word| {
            let mask = if word == SHUTDOWN { 0x87 } else { 0x8f };
            control & mask == word
        });
        match self {
            Self::NotReady => Self::Disabled,
            _ if control & 0x82 == 0 => Self::Disabled,
            Self::Enabled if control & 0x86 == 0x02 => Self::QuickStop,
            _ if control & 0x86 == 0x02 && self != Self::QuickStop => Self::Disabled,
            Self::Disabled | Self::SwitchedOn | Self::Enabled if shutdown => Self::Ready,
            Self::Ready if switch_on || enable => Self::SwitchedOn,
            Self::Enabled if switch_on => Self::SwitchedOn,
            Self::SwitchedOn | Self::QuickStop if enable => Self::Enabled,
            same => same,
        }
    }
}
