//! The part of a drive that is quicker than a step.
//!
//! `w`, `u` velocity of the base and rate of the feel, with the impulse that the quick part takes of them given back

use super::motion::{Motion, Neighbors};
use crate::Scalar;
use crate::effects::Effects;
use crate::run::{RunSnapshot, RunState};

/// The part of a drive that is quicker than a step, such as its oil. A drive without one leaves everything as it is here.
pub trait QuickPart<S: Scalar>: Motion<S> {
    /// Velocity of the base.
    #[inline(always)]
    fn base_velocity(&self, w: S, _: &Self::Balance) -> S {
        w
    }
    /// `w` of a velocity.
    #[inline(always)]
    fn base_momentum(&self, velocity: S, _: &Self::Balance) -> S {
        velocity
    }
    /// Rate of the feel.
    #[inline(always)]
    fn feel_velocity(&self, u: S, _: &Self::Balance) -> S {
        u
    }
    /// `u` of a rate.
    #[inline(always)]
    fn feel_momentum(&self, rate: S, _: &Self::Balance) -> S {
        rate
    }
    /// The feel's acceleration per torque changes from `from` to `to`; change of `u` at which its rate stays.
    #[inline(always)]
    fn feel_changed(&mut self, from: S, _: S, _: &Self::Balance) -> S {
        from.zero()
    }
    /// Force that moves a feel which takes the load cell's `force` directly.
    #[inline(always)]
    fn feel_force(&self, force: S, _: &RunSnapshot<S, Self::Balance>) -> S {
        force
    }
    /// At the start of a step: how far the part came behind its balance in the last one.
    #[inline(always)]
    fn catch_up(
        &self,
        _: &Neighbors<'_, S>,
        _: &Effects,
        _: &Self::Side,
        _: &mut RunState<S, Self::Memory>,
        _: &mut RunSnapshot<S, Self::Balance>,
    ) {
    }
}
