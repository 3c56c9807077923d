//! What is done to a loader in a step.

use super::{Equilibrium, Machine, State};
use crate::Scalar;

/// Inputs at the start and at the end of one step; between, they change evenly.
#[derive(Debug, Clone, Copy)]
pub struct Inputs {
    /// Pilot force in N.
    pub force: [f64; 2],
    /// Commanded neutral in rad.
    pub trim: [f64; 2],
    /// Factor on the feel's spring.
    pub stiffness_factor: [f64; 2],
    /// The stick shaker's swing, -1 to 1.
    pub shaker: [f64; 2],
    /// Share of the next feel, while the feel is being changed.
    pub fade: [f64; 2],
    /// Test signal at the amplifier's input in V.
    pub test_signal: [f64; 2],
    /// What is added to the law's command in V: a digital controller adds what it finds at a sample, and sends it on with the command.
    pub command_signal: [f64; 2],
}

impl Inputs {
    /// Nothing at all, the spring as it is.
    pub const NONE: Self = Self {
        force: [0.0; 2],
        trim: [0.0; 2],
        stiffness_factor: [1.0; 2],
        shaker: [0.0; 2],
        fade: [0.0; 2],
        test_signal: [0.0; 2],
        command_signal: [0.0; 2],
    };

    /// The inputs as they stand at the end of the step, and stay.
    #[inline(always)]
    pub fn end(&self) -> Self {
        let stay = |[_, end]: [f64; 2]| [end, end];
        Self {
            force: stay(self.force),
            trim: stay(self.trim),
            stiffness_factor: stay(self.stiffness_factor),
            shaker: stay(self.shaker),
            fade: stay(self.fade),
            test_signal: stay(self.test_signal),
            command_signal: stay(self.command_signal),
        }
    }
}

/// When within a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Moment {
    Start,
    Half,
    End,
}

impl Moment {
    #[inline(always)]
    pub(super) fn of(self, [start, end]: [f64; 2]) -> f64 {
        match self {
            Self::Start => start,
            Self::Half => 0.5 * (start + end),
            Self::End => end,
        }
    }
}

impl<S: Scalar> Machine<S> {
    /// The pilot's force in N where the inputs give `force`.
    #[inline(always)]
    pub fn force(&self, force: f64) -> S {
        self.force_scale.times(force)
    }

    #[inline(always)]
    pub(super) fn pilot_force(&self, state: &State<S>, inputs: &Inputs, moment: Moment) -> S {
        self.force(moment.of(inputs.force)) + state.hand
    }

    /// A hand holds the grip with the force of `equilibrium`.
    pub fn hold(state: &mut State<S>, equilibrium: &Equilibrium<S>) {
        state.hand = equilibrium.pilot_force;
    }

    /// The hand lets go.
    pub fn let_go(state: &mut State<S>) {
        state.hand = state.hand.zero();
    }
}
