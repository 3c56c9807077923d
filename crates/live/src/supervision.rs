//! The supervisor between law and output: what is seen of a cycle, as the supervisor is told; what it allows, as the loop takes it.

use crate::setup::Setup;
use forcefeel_model::control::ControlOutput;
use forcefeel_model::logic::Named;
use forcefeel_model::supervised_law::LimitedCommand;
use forcefeel_model::supervisor::{
    Function, Limits, RequestedMode, Supervisor, SupervisorInput, SupervisorOutput, SupervisorState,
};
use forcefeel_model::transducers::SENSORS;

/// States, in the order of a row's numbers.
pub const STATES: &[SupervisorState] = SupervisorState::ALL;

/// Name and sentence of each safety function, by the bit that it has in a row.
pub fn trips() -> Vec<(&'static str, &'static str)> {
    Function::ALL.iter().map(|function| (function.name(), function.sentence())).collect()
}

/// What the person wants of the supervisor, up to the next cycle.
#[derive(Debug, Clone, Copy)]
pub struct Asked {
    /// Off, passive, active.
    pub request: RequestedMode,
    /// What is latched is to be cleared.
    pub acknowledge: bool,
    /// Stop, now.
    pub stop: bool,
    /// Another axis stopped, and this one is to stop with it.
    pub other_axis: bool,
}

/// What is seen of a cycle.
#[derive(Debug, Clone, Copy)]
pub struct CycleStatus {
    /// Load cell (N), drive (m), base of the column (m); those of before where none came.
    pub sensors: [f64; SENSORS],
    /// Where they are of this cycle, the periods between it and the sample before it.
    pub periods: Option<f64>,
    /// Cycles by which they are late.
    pub delay: u32,
    /// Torque of electronic links on the feel, in N m.
    pub link_torque: f64,
    /// Acceleration that the feel would give with no hand on it, in rad/s².
    pub feel_acceleration: f64,
    /// Rate of the programmed control, as an angle of the column, in rad/s.
    pub feel_rate: f64,
    /// Whether the emergency stop is pressed.
    pub emergency_stop: bool,
    /// Whether the drive complains.
    pub drive_fault: bool,
    /// Whether it carries out its commands.
    pub drive_acts: bool,
    /// Beats that were missed before.
    pub missed: u64,
    /// Samples since the host's last packet; nothing where there is no host.
    pub host_age: Option<u32>,
    /// What is asked for.
    pub asked: Asked,
}

/// What is allowed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Verdict {
    /// A place in [`STATES`].
    pub state: u8,
    /// The command that may go out.
    pub command: f64,
    /// Whether the drive is to be powered.
    pub enable: bool,
    /// Whether the law is followed; else the feel begins anew where the column stands.
    pub follows: bool,
    /// Functions that acted since they were acknowledged, a bit each.
    pub trips: u32,
    /// Functions that act now.
    pub acting: u32,
    /// Force of the hand in N, estimated; not a number where nobody looks on.
    pub hand_force: f64,
}

impl Verdict {
    /// Where nobody looks on.
    pub const NONE: Self =
        Self { state: ACTIVE, command: 0.0, enable: true, follows: true, trips: 0, acting: 0, hand_force: f64::NAN };

    /// What passes of the law's command.
    pub fn passed(&self) -> LimitedCommand<f64> {
        LimitedCommand { command: self.command, enable: self.enable, follows: self.follows }
    }
}

/// The supervisor of a loop, or nobody.
#[derive(Debug, Clone)]
pub struct Supervision {
    supervisor: Option<Supervisor<f64>>,
    last: Option<SupervisorOutput<f64>>,
    input: Option<SupervisorInput<f64>>,
    silent: u32,
    late: u32,
}

impl Supervision {
    /// A loader that is off; without supervision the law drives.
    ///
    /// # Errors
    /// If the loader has no limits that it could be held to.
    pub fn new(setup: &Setup) -> Result<Self, &'static str> {
        let limits = || Limits::new(&setup.parameters(), setup.drive(), setup.period_s());
        let supervisor = if setup.supervised {
            Some(Supervisor::new(limits().map_err(forcefeel_model::supervisor::Refusal::text)?, 0.0))
        } else {
            None
        };
        Ok(Self { supervisor, last: None, input: None, silent: 0, late: 0 })
    }

    /// The feel's neutral in rad where trim has it at `wanted`.
    pub fn neutral(&self, wanted: f64) -> f64 {
        self.last.map_or(wanted, |allowed| allowed.neutral(wanted))
    }

    /// Share of the feel that is there.
    pub fn share(&self) -> f64 {
        match (&self.supervisor, &self.last) {
            (None, _) => 1.0,
            (Some(_), Some(allowed)) if allowed.follows => allowed.share,
            (Some(_), _) => 0.0,
        }
    }

    /// What was allowed last; nothing before the first cycle, or where nobody looks on.
    pub fn last(&self) -> Option<&SupervisorOutput<f64>> {
        self.last.as_ref()
    }

    /// The readings of a cycle that the law is given; those that came, if nobody looks on.
    pub fn admit(&mut self, seen: &CycleStatus) -> Option<[f64; SENSORS]> {
        let Some(supervisor) = &mut self.supervisor else { return seen.periods.map(|_| seen.sensors) };
        // A cycle that had no sample was a period at least.
        let periods = seen.periods.map(|periods| periods.max(f64::from(self.silent.saturating_add(1))));
        self.silent = if periods.is_some() { 0 } else { self.silent.saturating_add(1) };
        self.late = if seen.missed == 0 { 0 } else { self.late.saturating_add(1) };
        let Asked { request, acknowledge, stop, other_axis } = seen.asked;
        let input = SupervisorInput {
            sensed: seen.sensors,
            missed: self.silent,
            periods: periods.unwrap_or(1.0),
            delay: seen.delay,
            late: self.late,
            host: seen.host_age.is_some(),
            host_age: seen.host_age.unwrap_or(0),
            command: 0.0,
            feel_acceleration: seen.feel_acceleration,
            feel_rate: seen.feel_rate,
            link_torque: seen.link_torque,
            emergency_stop: seen.emergency_stop || stop,
            other_axis,
            drive_fault: seen.drive_fault,
            drive_acts: seen.drive_acts,
            requested: request,
            acknowledge,
        };
        self.input = Some(input);
        supervisor.admit(&input)
    }

    /// What is allowed in the cycle whose readings were admitted, where the law asks for this.
    pub fn look(&mut self, answer: &ControlOutput<f64>) -> Verdict {
        let command = answer.command;
        let (Some(supervisor), Some(input)) = (&mut self.supervisor, self.input) else {
            return Verdict { command, ..Verdict::NONE };
        };
        let allowed = supervisor.step(&SupervisorInput { command, ..input });
        self.last = Some(allowed);
        let place = STATES.iter().position(|state| *state == allowed.state).and_then(|place| u8::try_from(place).ok());
        Verdict {
            state: place.unwrap_or(0),
            command: allowed.command,
            enable: allowed.enable,
            follows: allowed.follows,
            trips: allowed.tripped.bits(),
            acting: allowed.acting.bits(),
            hand_force: allowed.grip.hand_force,
        }
    }
}

/// Place of [`SupervisorState::Active`].
const ACTIVE: u8 = 3;
