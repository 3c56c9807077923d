//! What a run gives over time: one table, of whose places everything else is told.

use forcefeel_model::Scalar;
use forcefeel_model::drive::Signals;
use forcefeel_model::drive::electric::Electric;
use forcefeel_model::drive::hydraulic::Hydraulic;
use forcefeel_model::parameters::DriveKind;
use forcefeel_model::run::RunSnapshot;

/// An output of a run; `as usize` it is its place in [`outputs`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Output {
    /// Angle of the column.
    ColumnAngle,
    /// Its rate.
    ColumnVelocity,
    /// Programmed displacement.
    FeelPosition,
    /// Its rate.
    FeelVelocity,
    /// Displacement of the drive's end.
    DrivePosition,
    /// Force of the load cell.
    LoadCellForce,
    /// The drive's own quantities: load pressure, flow and current of a hydraulic one; current, voltage, speed of an electric one.
    FirstSignal,
    /// See there.
    SecondSignal,
    /// See there.
    ThirdSignal,
    /// The pilot's force.
    PilotForce,
    /// Temperature of an electric drive's winding.
    FourthSignal,
}

const ALL: [Output; 11] = [
    Output::ColumnAngle,
    Output::ColumnVelocity,
    Output::FeelPosition,
    Output::FeelVelocity,
    Output::DrivePosition,
    Output::LoadCellForce,
    Output::FirstSignal,
    Output::SecondSignal,
    Output::ThirdSignal,
    Output::PilotForce,
    Output::FourthSignal,
];

type Name = (&'static str, &'static str);

/// Name of each output of a loader with a hydraulic drive and its SI unit; `feel_position` is in the unit of the law's displacement.
pub const OUTPUTS: &[Name; 10] = &named(<Hydraulic<f64> as Signals<f64>>::NAMES);

/// The same with an electric drive.
pub const ELECTRIC_OUTPUTS: &[Name; 11] = &named(<Electric<f64> as Signals<f64>>::NAMES);

/// The outputs of a kind of loader.
pub const fn outputs(kind: DriveKind) -> &'static [Name] {
    match kind {
        DriveKind::Hydraulic => OUTPUTS,
        DriveKind::Electric => ELECTRIC_OUTPUTS,
    }
}

/// What all have, with what is seen of a drive between.
const fn named<const N: usize>(drive: &[Name]) -> [Name; N] {
    let mut outputs = [("column_angle", "rad"); N];
    outputs[Output::ColumnVelocity as usize] = ("column_velocity", "rad/s");
    outputs[Output::FeelPosition as usize] = ("feel_position", "");
    outputs[Output::FeelVelocity as usize] = ("feel_velocity", "");
    outputs[Output::DrivePosition as usize] = drive[0];
    outputs[Output::LoadCellForce as usize] = ("load_cell_force", "N");
    outputs[Output::FirstSignal as usize] = drive[1];
    outputs[Output::SecondSignal as usize] = drive[2];
    outputs[Output::ThirdSignal as usize] = drive[3];
    outputs[Output::PilotForce as usize] = ("pilot_force", "N");
    if N > Output::FourthSignal as usize {
        outputs[Output::FourthSignal as usize] = drive[4];
    }
    outputs
}

impl Output {
    /// The output at a place of [`outputs`].
    ///
    /// # Panics
    /// If there is no such place.
    #[inline(always)]
    pub const fn at(place: usize) -> Self {
        ALL[place]
    }

    /// What it is at one instant; `per_base`: column angle per displacement of the base.
    #[inline(always)]
    pub fn of<S: Scalar, B>(self, now: &RunSnapshot<S, B>, per_base: S) -> S {
        match self {
            Self::ColumnAngle => now.base * per_base,
            Self::ColumnVelocity => now.base_rate * per_base,
            Self::FeelPosition => now.delta,
            Self::FeelVelocity => now.delta_rate,
            Self::DrivePosition => now.position,
            Self::LoadCellForce => now.force,
            Self::FirstSignal => now.signals[0],
            Self::SecondSignal => now.signals[1],
            Self::ThirdSignal => now.signals[2],
            Self::PilotForce => now.pilot_force,
            Self::FourthSignal => now.signals[3],
        }
    }
}
