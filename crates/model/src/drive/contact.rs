//! A drive whose link meets the ends of its play, or whose feel meets a stop.

use super::motion::{Motion, Neighbors};
use crate::Scalar;
use crate::effects::Effects;
use crate::run::{RunSnapshot, RunState, RunStepStart, Shared};

/// Contact inside a step. A drive whose force does not jump at a touch needs no more than `command_jump`.
pub trait Contact<S: Scalar>: Motion<S> {
    /// Whether the link is beyond its play.
    #[inline(always)]
    fn touches(&self, plant: &[S; 5]) -> S::Mask {
        !plant[0].less(plant[0])
    }
    /// Change of the third number's rate with the command.
    fn command_jump(&self, effects: &Effects, now: &RunSnapshot<S, Self::Balance>, e_change: S) -> S;
    /// At the end of a step: the link met the end of its play on the way.
    #[inline(always)]
    fn close_play(
        &self,
        _: &Neighbors<'_, S>,
        _: &Shared,
        state: &mut RunState<S, Self::Memory>,
        _: &[S; 5],
        _: &RunStepStart<S, Self::Balance, Self::Side>,
    ) {
        state.late = state.late.zero();
    }
}
