//! Input of the supervisor at a sample.

use crate::Logic;
use crate::named::Named;
use crate::transducers::SENSORS;

/// Input of the supervisor at a sample.
#[derive(Debug, Clone, Copy)]
pub struct SupervisorInput<S: Logic> {
    /// Load cell (N), position of the drive's end (m), displacement of the column's base (m), as the law gets them.
    pub sensed: [S; SENSORS],
    /// Samples in a row, this one included, for which the drive or a sensor gave nothing; `sensed` is then not looked at.
    pub missed: S::Count,
    /// Periods between this sample and the one before it that came, as far as time went on for the machine; at least one.
    pub periods: S,
    /// Cycles by which the sample is late: zero where it answers the command of the cycle before.
    pub delay: S::Count,
    /// Cycles in a row, this one included, that the loop was late.
    pub late: S::Count,
    /// Whether there is a host.
    pub host: S::Mask,
    /// Samples since its last packet.
    pub host_age: S::Count,
    /// The law's command, in V or A.
    pub command: S,
    /// Acceleration that the feel would give the programmed control now if no hand were on it, in rad/s²: see
    /// [`Control::free_acceleration`](crate::control::Control::free_acceleration).
    pub feel_acceleration: S,
    /// Rate of the programmed control, as an angle of the column, in rad/s.
    pub feel_rate: S,
    /// Torque in N m of electronic links on the feel: with it another pilot moves the column.
    pub link_torque: S,
    /// The emergency stop is pressed.
    pub emergency_stop: S::Mask,
    /// Another axis stopped, and this one is to stop with it.
    pub other_axis: S::Mask,
    /// The drive reports a fault.
    pub drive_fault: S::Mask,
    /// The drive carries out its commands; holds, too, of one that does not tell.
    pub drive_acts: S::Mask,
    /// The requested mode.
    pub requested: S::Code<RequestedMode>,
    /// The message of a trip is acknowledged.
    pub acknowledge: S::Mask,
}

/// Mode that the user requests.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RequestedMode {
    /// No power.
    Off,
    /// Power without feel.
    Passive,
    /// Feel.
    Active,
}

impl Named for RequestedMode {
    const ALL: &'static [Self] = &[Self::Off, Self::Passive, Self::Active];

    fn name(self) -> &'static str {
        match self {
            Self::Off => "off",
            Self::Passive => "passive",
            Self::Active => "active",
        }
    }
}
