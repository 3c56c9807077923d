//! A period of an axis: what the live loop does in a cycle, without a clock, a record or an operating system.

use crate::loader::{Loader, Setting};
use forcefeel_model::Scalar;
use forcefeel_model::control::{Control, Sample};
use forcefeel_model::machine::{Inputs, Shared};
use forcefeel_model::modifiers::{FeelModifiers, ModifierRamp, ModifierRates};
use forcefeel_model::supervised_law::{LimitedCommand, SupervisedLaw};
use forcefeel_model::supervisor::{
    Limits, RequestedMode, Supervisor, SupervisorInput, SupervisorOutput, SupervisorState,
};
use forcefeel_model::transducers::SENSORS;

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
    /// Bits: emergency stop, fault of the drive, acknowledged.
    pub flags: u32,
}

/// The bits of [`Input::flags`].
pub const EMERGENCY_STOP: u32 = 1;
/// See [`EMERGENCY_STOP`].
pub const DRIVE_FAULT: u32 = 2;
/// See [`EMERGENCY_STOP`].
pub const ACKNOWLEDGED: u32 = 4;

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
}

/// Law, feel and supervisor of one axis.
#[derive(Debug, Clone)]
pub struct Axis<S: Scalar> {
    shared: Shared,
    control: Control<S>,
    settings: (u32, u32),
    led: ModifierRamp<S>,
    pace: ModifierRates<S>,
    followed: SupervisedLaw<S>,
    sensors: [S; SENSORS],
    supervisor: Supervisor<S>,
    /// Samples in a row that had not come by the period before.
    missed: u32,
    /// What it allowed last.
    last: Option<SupervisorOutput<S>>,
}

impl<S: Scalar> Axis<S> {
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
            led: ModifierRamp::at(like.zero()),
            pace: first.pace(like.constant(loader.period_s)),
            followed: SupervisedLaw::new(&control, at_rest),
            sensors: [like.zero(); SENSORS],
            supervisor: Supervisor::new(limits, like),
            missed: 0,
            last: None,
        })
    }

    /// A period; nothing, and nothing is changed, if there are no such settings.
    pub fn step(&mut self, settings: &[Setting], given: &Input<S>) -> Option<Output<S>>
    where
        S: Into<f64>,
    {
        let like = given.trim;
        self.select(settings, given)?;
        let inputs = self.inputs(given);
        if given.missed == 0 {
            self.sensors = given.sensors;
        }
        let mut input = SupervisorInput {
            sensed: self.sensors,
            missed: given.missed,
            periods: count(self.missed, like) + like.constant(1.0),
            delay: given.delay,
            late: given.late,
            host_age: None,
            // The law's, as it comes to it.
            command: like.zero(),
            feel_acceleration: self.control.free_acceleration(&self.shared, self.followed.feeling(), &inputs),
            feel_rate: self.followed.feeling().motion.at[1] * self.control.per_delta(),
            link_torque: like.zero(),
            emergency_stop: given.flags & EMERGENCY_STOP != 0,
            other_axis: false,
            drive_fault: given.flags & DRIVE_FAULT != 0,
            requested: match given.request {
                1 => RequestedMode::Passive,
                2 => RequestedMode::Active,
                _ => RequestedMode::Off,
            },
            acknowledge: given.flags & ACKNOWLEDGED != 0,
        };
        self.missed = given.missed;
        let sample = self.supervisor.admit(&input).map(|sensors| Sample { sensors, pilot_force: like.zero() });
        let (supervisor, last) = (&mut self.supervisor, &mut self.last);
        let law = (&self.shared, &self.control);
        let command = self.followed.step(law, &inputs, sample.as_ref(), |answer| {
            input.command = answer.command;
            let allowed = supervisor.step(&input);
            *last = Some(allowed);
            LimitedCommand::from(&allowed)
        });
        // The supervisor is asked in each period.
        let allowed = self.last?;
        Some(self.output(command, &allowed))
    }

    fn output(&self, command: S, allowed: &SupervisorOutput<S>) -> Output<S> {
        let per_delta = self.control.per_delta();
        Output {
            command,
            torque: self.followed.answer().torque,
            feel: self.followed.feeling().motion.at.map(|number| number * per_delta),
            enable: u32::from(allowed.enable),
            state: match allowed.state {
                SupervisorState::Off => 0,
                SupervisorState::Initializing => 1,
                SupervisorState::Passive => 2,
                SupervisorState::Active => 3,
                SupervisorState::Fading => 4,
                SupervisorState::Tripped => 5,
            },
            acting: allowed.acting.bits(),
            tripped: allowed.tripped.bits(),
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

    /// What the feel is told from outside.
    fn inputs(&mut self, given: &Input<S>) -> Inputs
    where
        S: Into<f64>,
    {
        let Input { trim, stiffness_factor, shaker, blend, .. } = *given;
        let modifiers = self.led.step(&FeelModifiers { trim_rad: trim, stiffness_factor, shaker }, &self.pace);
        let swing = self.led.swing(modifiers.shaker, &self.pace);
        let trim = self.last.map_or(modifiers.trim_rad, |allowed| allowed.neutral(modifiers.trim_rad));
        let [trim, stiffness_factor, shaker, fade] =
            [trim, modifiers.stiffness_factor, swing, blend].map(|number| [number.into(); 2]);
        let [added_force, added_stiffness, added_damping] =
            [given.added_force, given.added_stiffness, given.added_damping].map(|number| [number.into(); 2]);
        Inputs { trim, stiffness_factor, shaker, fade, added_force, added_stiffness, added_damping, ..Inputs::NONE }
    }
}

/// A number of samples. It is zero but where some did not come, and a board need not convert that.
#[inline(always)]
fn count<S: Scalar>(samples: u32, like: S) -> S {
    if samples == 0 { like.zero() } else { like.constant(f64::from(samples)) }
}
