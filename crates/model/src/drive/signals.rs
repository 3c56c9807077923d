//! Signals of a drive: in a run, and on a bench.

use super::motion::Motion;
use crate::Scalar;
use crate::channels::COUNT;
use crate::parameters::Parameters;
use crate::run::{RunSnapshot, SIGNALS};

/// Signals of a drive at one instant.
#[derive(Debug, Clone, Copy)]
pub struct DriveSignals<S> {
    /// Displacement of its end in m.
    pub position: S,
    /// Force on the load cell in N.
    pub force: S,
    /// Its own quantities.
    pub signals: [S; SIGNALS],
}

/// Names and values of a drive's signals.
pub trait Signals<S: Scalar>: Motion<S> {
    /// Name and SI unit of the drive's position, then of its own quantities.
    const NAMES: &'static [(&'static str, &'static str)];
    /// The own quantities whose peaks a run reports.
    const PEAKS: [usize; 3];
    /// Name and SI unit of each channel of a bench.
    const CHANNELS: &'static [(&'static str, &'static str)];

    /// Number of the memory on which the signals depend: the lag of a pressure, the warmth of a winding.
    fn carried(memory: &Self::Memory) -> S;
    /// Signals of a balance; `carried`: number of the memory.
    fn signals(&self, plant: &[S; 5], balance: &Self::Balance, carried: S) -> DriveSignals<S>;
    /// Signals half-way between the starts of two steps.
    fn signals_between(
        &self,
        plant: &[S; 5],
        balance: &Self::Balance,
        between: [&RunSnapshot<S, Self::Balance>; 2],
        digital: bool,
    ) -> DriveSignals<S>;
    /// Channels of a bench, in the order of [`CHANNELS`](Self::CHANNELS).
    fn channels(now: &RunSnapshot<S, Self::Balance>, parameters: &Parameters<S>) -> [S; COUNT];
}
