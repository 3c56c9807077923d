//! Data of a run that machine, control and drive share: settings, inputs of a step, state between two steps, quantities at one instant.
//!
//! Nothing here knows a machine, a law or a drive; what a drive adds of its own is a type parameter.

mod inputs;
mod slow;
mod state;

pub use inputs::{Inputs, StepFraction};
pub use slow::{Slow, cubic};
pub use state::{RunSnapshot, RunState, RunStepStart, SIGNALS};

use crate::cancellation::Cancellation;
use crate::controller::Timing;
use crate::curve::Curve;
use crate::effects::Effects;

/// What all runs of a batch share.
#[derive(Debug, Clone)]
pub struct Shared {
    /// Effects in play.
    pub effects: Effects,
    /// Length of a step in s.
    pub step_s: f64,
    /// When a digital controller acts; an analog law otherwise.
    pub timing: Option<Timing>,
    /// Force over angle of the feel, in place of its straight spring.
    pub curve: Option<Curve>,
    /// What a digital controller adds to its command.
    pub cancellation: Option<Cancellation>,
}

impl Shared {
    /// Length of a controller's period in s; of a step without one.
    #[inline(always)]
    #[expect(clippy::cast_precision_loss, reason = "a number of steps in a period, far below 2^52")]
    pub fn period_s(&self) -> f64 {
        self.step_s * self.timing.map_or(1, |timing| timing.period) as f64
    }
}

/// Angle to either side within which an equilibrium is looked for.
pub const SEARCH_RAD: f64 = 1.5;
