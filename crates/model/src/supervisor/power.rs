//! Whether the drive acts: from its enable line to its torque or flow it may take time, and it may stop by itself.
//!
//! Until it acts nothing begins: the law would count commands that the drive does not carry out, and a feel that had come meanwhile would be
//! there at once.

use super::debounce::Debounce;
use super::function::Function;
use super::input::SupervisorInput;
use super::limits::Limits;
use crate::Logic;
use crate::logic::{Count, FunctionSet};

/// What is known of a drive's power.
#[derive(Debug, Clone, Copy)]
pub(super) struct Power<S: Logic> {
    /// Whether the drive carries out its commands, by the last sample that came.
    acts: S::Mask,
    /// Whether it has, since it was enabled.
    pub(super) acted: S::Mask,
    waits: Debounce<S>,
}

crate::logic::memory! { Power { flag acts, acted; part waits; } }

impl<S: Logic> Power<S> {
    pub(super) fn new() -> Self {
        Self { acts: S::mask(false), acted: S::mask(false), waits: Debounce::new() }
    }

    /// A sample more of a drive that is enabled or not.
    #[inline(always)]
    pub(super) fn watch(
        &mut self,
        limits: &Limits<S>,
        input: &SupervisorInput<S>,
        enabled: S::Mask,
        functions: &mut S::Set,
    ) {
        let missed = input.missed.some();
        self.acts = (missed & self.acts) | (!missed & input.drive_acts);
        // One that reports a fault has told why it stopped.
        let stopped = enabled & self.acted & !self.acts & !input.drive_fault;
        self.acted = enabled & (self.acted | self.acts);
        let late = self.waits.holds(enabled & !self.acted, limits.power);
        *functions = functions.with(Function::DriveNotReady, late).with(Function::DriveStopped, stopped);
    }
}
