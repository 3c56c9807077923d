//! A drive at rest.

use crate::Scalar;
use crate::effects::Effects;
use core::fmt::Debug;

/// Link between a drive and the column.
#[derive(Debug, Clone, Copy)]
pub struct Link<S> {
    /// `alpha`: travel of the drive per travel of the base.
    pub ratio: S,
    /// Half of the free play in m.
    pub half_play: S,
    /// `1 / k` in m/N.
    pub per_stiffness: S,
}

/// A drive at rest: effort, force and stretch of the link, and the command that holds them.
pub trait Statics<S: Scalar>: Copy + Debug {
    /// Whether the command holds the effort, so that a limit of the one is a limit of the other.
    const COMMAND_HOLDS: bool;

    /// Link to the column.
    fn link(&self) -> Link<S>;
    /// Force on the load cell per effort.
    fn force_per_effort(&self) -> S;
    /// Effort of a force.
    fn effort(&self, force: S) -> S;
    /// Effort that stretches the link by this length.
    fn effort_of_stretch(&self, stretch: S) -> S;
    /// Length by which the link is stretched, its play included.
    fn stretch_at_rest(&self, effort: S) -> S;
    /// Demand of the command `e` beyond what holds the position and the effort `at`: zero in equilibrium.
    fn residual(&self, effects: &Effects, e: S, at: (S, S)) -> S;
}
