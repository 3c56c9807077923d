//! State between two steps, and quantities at one instant.

use super::slow::Slow;
use crate::Scalar;
use crate::dry_friction::StickState;
use crate::transducers::SensorReading;

/// State between two steps; `M`: the memory of the drive.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "S: serde::Serialize, S::Mask: serde::Serialize, M: serde::Serialize",
        deserialize = "S: serde::Deserialize<'de>, S::Mask: serde::Deserialize<'de>, M: serde::Deserialize<'de>"
    ))
)]
pub struct RunState<S: Scalar, M> {
    pub(crate) slow: Slow<S>,
    pub(crate) column: StickState<S>,
    pub(crate) feel: StickState<S>,
    /// Memory of the drive.
    pub(crate) drive: M,
    pub(crate) seen: SensorReading<S>,
    pub(crate) neutral: S,
    pub(crate) slider: S,
    /// Command that the amplifier holds under a digital controller.
    pub(crate) held: S,
    /// Pilot force at the end of the last step.
    pub(crate) pilot_force: S,
    /// Force of a hand that holds the grip until it lets go, in N.
    pub(crate) hand: S,
    /// Test signal that is added to the command held, in V.
    pub(crate) test_signal: S,
    /// Share of the last step by which a force on the load cell came later than a straight line.
    pub(crate) late: S,
    /// Steps since the start.
    pub(crate) steps: usize,
}

/// Quantities of a drive's own, at most.
pub const SIGNALS: usize = 4;

/// Quantities of a loader at one instant; `B`: the balance of the drive.
#[derive(Debug, Clone, Copy)]
pub struct RunSnapshot<S, B> {
    /// Displacement of the column's base in m.
    pub base: S,
    /// Its velocity in m/s.
    pub base_rate: S,
    /// Programmed displacement, in its unit.
    pub delta: S,
    /// Its rate.
    pub delta_rate: S,
    /// Displacement of the drive's end in m.
    pub position: S,
    /// Force of the load cell in N.
    pub force: S,
    /// The drive's own quantities.
    pub signals: [S; SIGNALS],
    /// Pilot force in N.
    pub pilot_force: S,
    /// Balance of the drive, which moves column and feel; the quantities above may be behind it.
    pub(crate) balance: B,
}

/// Start of a step: what the rest of it needs; `B`, `L`: balance of the drive, and its side of the link.
#[derive(Debug, Clone, Copy)]
pub struct RunStepStart<S, B, L> {
    /// Quantities at the start.
    pub now: RunSnapshot<S, B>,
    pub(crate) slow: Slow<S>,
    pub(crate) rates: Slow<S>,
    pub(crate) side: L,
}
