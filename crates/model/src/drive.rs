//! A drive: what moves the end of the linkage, and what a loader in time asks of it.
//!
//! | drive | file |
//! |---|---|
//! | servo valve and piston | [`hydraulic`] |
//! | motor, current loop and transmission | [`electric`] |
//!
//! | question | trait |
//! |---|---|
//! | what holds it at rest | [`Statics`] |
//! | its equations in motion | [`Motion`] |
//! | what of it is quicker than a step | [`QuickPart`] |
//! | what a touch inside a step does | [`Contact`] |
//! | what is seen of it | [`Signals`] |
//!
//! A drive carries three numbers through a step, its share of `plant`; the other two are the column's: displacement of the base, and
//! its velocity with what the drive's own quick part takes of it given back (`w`). What a drive does to the link follows from these
//! numbers without a time derivative: its *balance*. *Effort* is what it does so with in equilibrium: load pressure of oil, force of a motor.
//!
//! Which drive a machine has is part of its type, chosen once for many runs: a step does not ask.

mod contact;
pub mod electric;
pub mod hydraulic;
mod kind;
mod motion;
mod quick_part;
mod signals;
mod statics;

pub use crate::run::SIGNALS;
pub use contact::Contact;
pub use kind::{Kind, OfElectric, OfHydraulic};
pub use motion::{Motion, Neighbors, REMEMBERED};
pub use quick_part::QuickPart;
pub use signals::{DriveSignals, Signals};
pub use statics::{Link, Statics};

use crate::Scalar;
use crate::controller::Converters;
use crate::parameters::Parameters;
use crate::run::Shared;

/// What a drive, the column and the feel are to one another.
#[derive(Debug, Clone, Copy)]
pub struct Coupling<S: Scalar> {
    /// Acceleration of the base per newton of the link's force.
    pub base_per_force: S,
    /// Acceleration of the feel per newton that it receives at once, without a lag or a sample between.
    pub feel_per_force: S,
    /// Whether it receives the load cell so.
    pub direct: S::Mask,
}

/// A drive of a loader.
pub trait Drive<S: Scalar>: Statics<S> + Motion<S> + QuickPart<S> + Contact<S> + Signals<S> {
    /// The drive of a loader.
    fn new(parameters: &Parameters<S>, shared: &Shared, coupling: &Coupling<S>) -> Self;
    /// Converters between the drive and a digital controller.
    fn converters(parameters: &Parameters<S>) -> Converters<S>;
}
