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

/// An expression for the kind of drive that a loader has: `with_drive!(kind, K => expression)`, in which `K` is its [`Kind`]. The one place
/// that lists the drives.
#[macro_export]
macro_rules! with_drive {
    ($kind:expr, $Drive:ident => $work:expr) => {
        match $kind {
            $crate::parameters::DriveKind::Hydraulic => {
                type $Drive = $crate::drive::OfHydraulic;
                $work
            }
            $crate::parameters::DriveKind::Electric => {
                type $Drive = $crate::drive::OfElectric;
                $work
            }
        }
    };
}
