//! The kinds of drive.

use super::{Drive, electric, hydraulic};
use crate::Scalar;

/// A kind of drive, whatever the numbers are made of.
pub trait Kind: Copy {
    /// The drive.
    type Of<S: Scalar>: Drive<S>;
}

/// Valve and piston.
#[derive(Debug, Clone, Copy)]
pub struct OfHydraulic;

impl Kind for OfHydraulic {
    type Of<S: Scalar> = hydraulic::Hydraulic<S>;
}

/// Motor and transmission.
#[derive(Debug, Clone, Copy)]
pub struct OfElectric;

impl Kind for OfElectric {
    type Of<S: Scalar> = electric::Electric<S>;
}
