//! A drive in motion.
//!
//! A step carries `plant`: three numbers of the drive, `x_b`, `w`.

use crate::Scalar;
use crate::column::ColumnMotion;
use crate::compensator::Compensator;
use crate::effects::Effects;
use crate::run::{RunSnapshot, RunState, RunStepStart, Slow, StepFraction};
use crate::transducers::Transducers;
use core::fmt::Debug;

/// The rest of a loader, which a drive moves: column, sensors, law and feel.
#[derive(Debug, Clone, Copy)]
pub struct Neighbors<'a, S: Scalar> {
    /// The column.
    pub column: &'a ColumnMotion<S>,
    /// The sensors.
    pub transducers: &'a Transducers<S>,
    /// The law's gains.
    pub law: &'a Compensator<S>,
    /// Acceleration of the feel per torque.
    pub feel_per_torque: S,
    /// Length of a step in s.
    pub step: S,
    /// One over it.
    pub per_step: S,
}

/// A drive in motion: the equations of its three numbers, and of the link's force.
pub trait Motion<S: Scalar>: Copy + Debug {
    /// Coefficients of the link's side, which differ while the base sticks.
    type Side: Copy + Debug;
    /// The drive in balance.
    type Balance: Copy + Debug;
    /// Memory from step to step, beside the three numbers.
    type Memory: Copy + Debug;

    /// The side where some bases are stuck.
    fn side(&self, effects: &Effects, stuck: S::Mask) -> Self::Side;
    /// The side where every base moves.
    fn moving(&self) -> Self::Side;
    /// The balance; `touches`: where the link may push or pull at all.
    fn balance(&self, effects: &Effects, side: &Self::Side, touches: S::Mask, plant: &[S; 5]) -> Self::Balance;
    /// Acceleration of the base by the link.
    fn pull(&self, base_per_force: S, balance: &Self::Balance) -> S;
    /// Rates of the three numbers under the command `e`; notes in `now` what depends on the command.
    fn rates(
        &self,
        effects: &Effects,
        memory: &Self::Memory,
        plant: (&[S; 5], StepFraction),
        e: S,
        now: &mut RunSnapshot<S, Self::Balance>,
    ) -> [S; 3];
    /// The three numbers, `w`, `u` and the memory at rest.
    fn at_rest(&self, effects: &Effects, position: S, effort: S) -> ([S; 3], [S; 2], Self::Memory);

    /// At the start of a step: the drive's own dry friction, first of the last step, then of this one; and what follows a course of
    /// its own through the step.
    #[inline(always)]
    fn settle(
        &self,
        _: &Neighbors<'_, S>,
        _: &Effects,
        _: &mut RunState<S, Self::Memory>,
        _: &mut RunSnapshot<S, Self::Balance>,
        _: &mut Slow<S>,
    ) {
    }
    /// Adds the drive's own dry friction to the rates.
    #[inline(always)]
    fn resist(_: &Effects, _: &Self::Memory, _: &mut Slow<S>) {}
    /// At the end of a step: what changes slowly.
    #[inline(always)]
    fn end_step(&self, _: &Effects, _: &mut RunState<S, Self::Memory>, _: &RunStepStart<S, Self::Balance, Self::Side>) {
    }

    /// The memory as numbers.
    fn remembered(memory: &Self::Memory) -> [S; REMEMBERED];
    /// Sets the memory from numbers.
    fn remember(memory: &mut Self::Memory, numbers: [S; REMEMBERED]);
}

/// Numbers of a drive's memory that a linear loop depends on.
pub const REMEMBERED: usize = 2;
