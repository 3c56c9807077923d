//! A period of an axis: what the live loop does in a cycle, without a clock, a record or an operating system.

use crate::loader::{Loader, Setting};
use forcefeel_model::Logic;
use forcefeel_model::axis::{Axis as ModelAxis, AxisInput};
use forcefeel_model::control::Control;
use forcefeel_model::logic::Named;
use forcefeel_model::machine::Shared;
use forcefeel_model::modifiers::{FeelModifiers, ModifierRates};
use forcefeel_model::supervisor::{Functions, Limits, RequestedMode, Supervisor, SupervisorOutput, SupervisorState};
use forcefeel_model::transducers::SENSORS;

/// A number of a board.
pub trait Number: Logic<Mask = bool, Count = u32, Set = Functions> + Into<f64> {}

impl<S: Logic<Mask = bool, Count = u32, Set = Functions> + Into<f64>> Number for S {}

/// What is given to an axis in a period.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct Input<S> {
    /// Load cell (N), position of the drive's end (m), displacement of the column's base (m), force at the grip (N).
    pub sensors: [S; SENSORS],
    /// Where the commanded neutral is to go, in rad.
    pub trim: S,
    /// Where the factor on the feel's spring is to go.
    pub stiffness_factor: S,
    /// How far the stick shaker is to be on, 0 to 1.
    pub shaker: S,
    /// How far the feel has been changed.
    pub blend: S,
    /// Force at the grip in N that a host adds beside the hand's.
    pub added_force: S,
    /// Spring in N m/rad about the angle zero that it adds to the feel's.
    pub added_stiffness: S,
    /// Damping in N m s/rad likewise.
    pub added_damping: S,
    /// The setting that is left, or stays.
    pub from: u32,
    /// The setting that is gone to.
    pub to: u32,
    /// Off, passive, active.
    pub request: u32,
    /// Samples in a row without a sample.
    pub missed: u32,
    /// Periods by which the sample is later than the controller's delay has it.
    pub delay: u32,
    /// Periods in a row that were late.
    pub late: u32,
    /// Bits: emergency stop, fault of the drive, acknowledged, host, the drive acts.
    pub flags: u32,
    /// With a host, periods since it gave trim, factor, shaker and what is added.
    pub host_age: u32,
}

/// The bits of [`Input::flags`].
pub const EMERGENCY_STOP: u32 = 1;
/// See [`EMERGENCY_STOP`].
pub const DRIVE_FAULT: u32 = 2;
/// See [`EMERGENCY_STOP`].
pub const ACKNOWLEDGED: u32 = 4;
/// See [`EMERGENCY_STOP`].
pub const HOST: u32 = 8;
/// See [`EMERGENCY_STOP`].
pub const DRIVE_ACTS: u32 = 16;

/// What an axis answers.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct Output<S> {
    /// To the drive, in V or A.
    pub command: S,
    /// That the feel receives, in N m.
    pub torque: S,
    /// Of the feel after the period, rad and rad/s.
    pub feel: [S; 2],
    /// Whether the drive has power.
    pub enable: u32,
    /// Off, initializing, passive, active, fading, tripped.
    pub state: u32,
    /// Safety functions that act, a bit each.
    pub acting: u32,
    /// Those that acted since they were acknowledged.
    pub tripped: u32,
    /// Share of the host's values in the next input, 0 to 1; the default ones have the rest.
    pub host_share: S,
}

/// Law, feel and supervisor of one axis, for one setting of the feel or many.
#[derive(Debug, Clone)]
pub struct Axis<S: Number> {
    shared: Shared,
    control: Control<S>,
    settings: (u32, u32),
    pace: ModifierRates<S>,
    supervised: ModelAxis<S>,
}

impl<S: Number> Axis<S> {
    /// An axis that is off; nothing if it has no settings, or no limits that a supervisor could hold it to.
    pub fn new(loader: &Loader, settings: &[Setting], like: S) -> Option<Self> {
        let first = settings.first()?;
        let limits = Limits::new(&first.parameters(0.0), first.drive(), loader.period_s).ok()?;
        let shared = loader.shared(settings);
        let control = first.control(&shared, like);
        let at_rest = loader.at_rest.map(|row| row.map(|value| like.constant(value)));
        Some(Self {
            shared,
            control,
            settings: (0, 0),
            pace: first.pace(like.constant(loader.period_s)),
            supervised: ModelAxis::new(&control, at_rest, Supervisor::new(limits, like)),
        })
    }

    /// A period; nothing, and nothing is changed, if there are no such settings.
    pub fn step(&mut self, settings: &[Setting], given: &Input<S>) -> Option<Output<S>> {
        self.select(settings, given)?;
        let &Input { sensors, trim, stiffness_factor, shaker, blend, missed, delay, late, flags, .. } = given;
        let input = AxisInput {
            sensors,
            wanted: FeelModifiers { trim_rad: trim, stiffness_factor, shaker },
            blend,
            added: [given.added_force, given.added_stiffness, given.added_damping],
            requested: S::code(match given.request {
                1 => RequestedMode::Passive,
                2 => RequestedMode::Active,
                _ => RequestedMode::Off,
            }),
            host: flags & HOST != 0,
            host_age: given.host_age,
            missed,
            delay,
            late,
            emergency_stop: flags & EMERGENCY_STOP != 0,
            drive_fault: flags & DRIVE_FAULT != 0,
            drive_acts: flags & DRIVE_ACTS != 0,
            acknowledge: flags & ACKNOWLEDGED != 0,
        };
        let (command, allowed) = self.supervised.step((&self.shared, &self.control), &self.pace, &input)?;
        Some(self.output(command, &allowed))
    }

    fn output(&self, command: S, allowed: &SupervisorOutput<S>) -> Output<S> {
        let (per_delta, followed) = (self.control.per_delta(), self.supervised.followed());
        let state = S::which(allowed.state);
        Output {
            command,
            torque: followed.answer().torque,
            feel: followed.feeling().motion.at.map(|number| number * per_delta),
            enable: u32::from(allowed.enable),
            state: (0..).zip(SupervisorState::ALL).find(|&(_, known)| *known == state).map_or(0, |(place, _)| place),
            acting: allowed.acting.bits(),
            tripped: allowed.tripped.bits(),
            host_share: allowed.host_share,
        }
    }

    /// The feels between which it is.
    fn select(&mut self, settings: &[Setting], given: &Input<S>) -> Option<()> {
        let (from, to) = (settings.get(given.from as usize)?, settings.get(given.to as usize)?);
        let like = given.trim;
        if self.settings.0 != given.from {
            self.control = from.control(&self.shared, like);
            self.pace = from.pace(self.pace.period);
        }
        if self.settings != (given.from, given.to) {
            self.control.fade_to(&to.parameters(like), Some(&to.law(like)));
            self.settings = (given.from, given.to);
        }
        Some(())
    }
}
